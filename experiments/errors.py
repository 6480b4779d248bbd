"""What can go wrong with an experiment's options, in words that say what to do."""

from babbling.errors import BabblingError


class ExperimentError(BabblingError):
    """Something about an experiment's options that the user can mend."""


class UnfinishedError(ExperimentError):
    """Results are there, but not all of them."""
