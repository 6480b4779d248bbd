"""`python -m experiments.babble` does what `imitate babble` does."""

from experiments.__main__ import script

script(__package__)
