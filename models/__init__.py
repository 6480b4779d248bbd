"""Bodies, worlds and teachers: the only place that knows physics."""
