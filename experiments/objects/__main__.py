"""`python -m experiments.objects` does what `imitate objects` does."""

from experiments.__main__ import script

script(__package__)
