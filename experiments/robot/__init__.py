"""What a robot is, on a card."""
