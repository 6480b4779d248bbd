"""A head imitates a head."""
