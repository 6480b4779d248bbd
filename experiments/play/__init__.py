"""A child at a table plays with things, and learns what becomes of them."""
