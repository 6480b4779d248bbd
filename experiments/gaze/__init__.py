"""Following gaze."""
