"""`python -m experiments.saccades` does what `imitate saccades` does."""

from experiments.__main__ import script

script(__package__)
