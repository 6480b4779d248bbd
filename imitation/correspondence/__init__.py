"""Somebody else's limbs, one's own postures."""
