"""`python -m experiments.face` does what `imitate face` does."""

from experiments.__main__ import script

script(__package__)
