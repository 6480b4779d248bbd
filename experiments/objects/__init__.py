"""Acts on objects: seen once, remembered, done by one's own means."""
