"""Peers in one table."""
