"""What can go wrong while watching and imitating, in words that say what to do."""

from babbling.errors import BabblingError


class ImitationError(BabblingError):
    """Something about a demonstration, a prior or an imitation that the user can mend."""
