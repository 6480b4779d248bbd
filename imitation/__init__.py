"""Inference with what was learned: Eq. (1), Eq. (2), priors, demonstrations and the imitator's loop."""
