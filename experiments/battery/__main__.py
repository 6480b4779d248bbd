"""`python -m experiments.battery` does what `imitate battery` does."""

from experiments.__main__ import script

script(__package__)
