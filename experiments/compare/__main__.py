"""`python -m experiments.compare` does what `imitate compare` does."""

from experiments.__main__ import script

script(__package__)
