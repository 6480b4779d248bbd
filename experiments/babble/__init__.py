"""A robot babbles into a file."""
