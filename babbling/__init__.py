"""Experience becomes a forward model; nothing here knows which body it came from."""
