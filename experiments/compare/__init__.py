"""What earlier runs left, side by side."""
