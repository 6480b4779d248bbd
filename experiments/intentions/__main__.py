"""`python -m experiments.intentions` does what `imitate intentions` does."""

from experiments.__main__ import script

script(__package__)
