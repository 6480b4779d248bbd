"""`python -m experiments.maze` does what `imitate maze` does."""

from experiments.__main__ import script

script(__package__)
