"""What did they mean to do? Stage four."""
