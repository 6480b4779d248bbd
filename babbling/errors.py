"""What can go wrong with experience and forward models, in words that say what to do."""

from models.errors import Told, unknown

__all__ = ["BabblingError", "unknown"]


class BabblingError(Told):
    """Something about experience or a forward model that the user can mend."""
