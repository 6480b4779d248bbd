"""Options of `imitate benchmark`."""

from typing import Annotated

from experiments.shared.options import BABBLING_MINUTES, BodyOptions, Demonstration, Minutes, options, some


@options
class Config(BodyOptions):
    """Options of `imitate benchmark`."""

    demonstrations: tuple[Demonstration, ...] = ("icub-wave", "romeo-bow", "human-raise", "g1-squat")
    """What to imitate: built-in names or files."""
    babbling_minutes: Minutes = BABBLING_MINUTES
    """Body-minutes of babbling."""
    floor: float = 10.0
    """Also babble this many times as long, for the floor of the learning curve; 0 leaves it out."""
    attempts: Annotated[int, some] = 5
    """Attempts of the discretised Bayesian model."""
    peers: bool = False
    """Also the maze's peers (pgmpy, pymdp) where they are installed."""
