"""`python -m experiments.notice` does what `imitate notice` does."""

from experiments.__main__ import script

script(__package__)
