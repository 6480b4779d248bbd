"""`python -m experiments.correspondence` does what `imitate correspondence` does."""

from experiments.__main__ import script

script(__package__)
