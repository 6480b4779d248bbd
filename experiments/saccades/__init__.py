"""A head looks about and learns to look."""
