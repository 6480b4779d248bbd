"""HOAP-2 watches a movement and reproduces it."""
