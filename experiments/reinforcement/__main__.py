"""`python -m experiments.reinforcement` does what `imitate reinforcement` does."""

from experiments.__main__ import script

script(__package__)
