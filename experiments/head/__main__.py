"""`python -m experiments.head` does what `imitate head` does."""

from experiments.__main__ import script

script(__package__)
