"""Options of `imitate correspondence`."""

from typing import Annotated

from experiments.errors import ExperimentError
from experiments.shared.options import Demonstration, MirrorOptions, ToRead, options, some, within
from models.teachers.demonstrations import DEMONSTRATIONS, find


@options
class Config(MirrorOptions):
    """Options of `imitate correspondence`."""

    demonstrations: Annotated[tuple[Demonstration, ...], some] = tuple(DEMONSTRATIONS)
    """Teachers to imitate: built-in demonstrations and .amc or .bvh files."""
    shown: str = "icub-reach"
    """Which of them the recording shows; the first one if it is not among them."""
    seeing_noise_deg: Annotated[float, within(0, 30, "degrees")] = 3.0
    """Standard deviation of every seen direction in the noisy half of the study, degrees."""
    mirror_minutes: Annotated[float, within(0, 600, above=True)] = 12.0
    """Body-minutes in front of the mirror, for the longest point of the curve."""
    acts: Annotated[int, within(1, 100_000)] = 200
    """Single acts for organ identification."""
    learners: Annotated[int, within(2, 100)] = 5
    """Who look into the mirror, each by itself, for acts that are hard to put to a part."""
    harder_acts: Annotated[int, within(1, 10_000)] = 40
    """Acts that each of them sees at each grade of each difficulty."""
    tries: Annotated[int, within(1, 1_000)] = 8
    """Tries at each act."""
    forward_model: ToRead | None = None
    """A forward model that `imitate babble` left, for its body schema; a pilot babble otherwise."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        if self.shown not in self.demonstrations and find(self.shown) is None:
            raise ExperimentError(f"--shown {self.shown}: this is none of --demonstrations")
