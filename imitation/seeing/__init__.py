"""From pixels to features, and from features to poses."""
