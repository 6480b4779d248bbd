"""`python -m experiments.benchmark` does what `imitate benchmark` does."""

from experiments.__main__ import script

script(__package__)
