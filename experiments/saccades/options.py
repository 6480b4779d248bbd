"""Options of `imitate saccades`."""

from experiments.shared.options import EyeOptions, Flag, Minutes, Selection, options


@options
class Config(EyeOptions):
    """Options of `imitate saccades`."""

    babbling_minutes: Minutes = 30.0
    """Body-minutes of random saccades, over all heads; the pilot's come on top."""
    selection: Selection = "mean"
    """Selection rule on Eq. (1)'s posterior."""
    study: Flag = False
    """Many trials instead of a few."""
