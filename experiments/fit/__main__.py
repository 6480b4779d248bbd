"""`python -m experiments.fit` does what `imitate fit` does."""

from experiments.__main__ import script

script(__package__)
