"""Options of `imitate benchmark`."""

from experiments.shared.options import BABBLING_MINUTES, BodyOptions, check_demonstration, options


@options
class Config(BodyOptions):
    """Options of `imitate benchmark`."""

    demonstrations: tuple[str, ...] = ("icub-wave", "romeo-bow", "human-raise", "g1-squat")
    """What to imitate: built-in names or files."""
    babbling_minutes: float = BABBLING_MINUTES
    """Body-minutes of babbling."""
    floor: float = 10.0
    """Also babble this many times as long, for the floor of the learning curve; 0 leaves it out."""
    attempts: int = 5
    """Attempts of the discretised Bayesian model."""
    peers: bool = False
    """Also the maze's peers (pgmpy, pymdp) where they are installed."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        self.check_some("attempts")
        for name in self.demonstrations:
            check_demonstration(name)
