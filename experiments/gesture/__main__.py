"""`python -m experiments.gesture` does what `imitate gesture` does."""

from experiments.__main__ import script

script(__package__)
