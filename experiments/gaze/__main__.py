"""`python -m experiments.gaze` does what `imitate gaze` does."""

from experiments.__main__ import script

script(__package__)
