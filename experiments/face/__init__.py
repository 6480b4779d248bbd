"""Imitating faces never seen of oneself."""
