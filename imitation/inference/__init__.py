"""Eq. (1) and Eq. (2), priors over actions and goals, selection."""
