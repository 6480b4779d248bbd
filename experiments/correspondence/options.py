"""Options of `imitate correspondence`."""

from pathlib import Path

from experiments.shared.options import MirrorOptions, check_demonstration, options
from models.teachers.demonstrations import DEMONSTRATIONS


@options
class Config(MirrorOptions):
    """Options of `imitate correspondence`."""

    demonstrations: tuple[str, ...] = tuple(DEMONSTRATIONS)
    """Teachers to imitate: built-in demonstrations and .amc files."""
    shown: str = "icub-reach"
    """Which of them the recording shows; the first one if it is not among them."""
    seeing_noise_deg: float = 3.0
    """Standard deviation of every seen direction in the noisy half of the study, degrees."""
    mirror_minutes: float = 12.0
    """Body-minutes in front of the mirror, for the longest point of the curve."""
    acts: int = 200
    """Single acts for organ identification."""
    tries: int = 8
    """Tries at each act."""
    forward_model: Path | None = None
    """A forward model that `imitate babble` left, for its body schema; a pilot babble otherwise."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        for name in ("demonstrations", "acts", "tries"):
            self.check_some(name)
        for name in self.demonstrations:
            check_demonstration(name)
