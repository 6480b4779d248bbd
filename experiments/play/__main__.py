"""`python -m experiments.play` does what `imitate play` does."""

from experiments.__main__ import script

script(__package__)
