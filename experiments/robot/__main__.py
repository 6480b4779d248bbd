"""`python -m experiments.robot` does what `imitate robot` does."""

from experiments.__main__ import script

script(__package__)
