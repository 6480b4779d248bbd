"""Options of `imitate correspondence`."""

from typing import Annotated

from experiments.errors import ExperimentError
from experiments.shared.options import (
    DEG,
    DEMONSTRATION,
    Demonstration,
    MirrorOptions,
    N,
    ToRead,
    options,
    some,
    within,
    written,
)
from models.teachers.demonstrations import DEMONSTRATIONS, find


@options
class Config(MirrorOptions):
    """Options of `imitate correspondence`."""

    demonstrations: Annotated[
        tuple[Demonstration, ...], some, written(f"{DEMONSTRATION} ...", "all that `imitate list` names")
    ] = tuple(DEMONSTRATIONS)
    """Teachers to imitate: built-in demonstrations and .amc or .bvh files."""
    shown: Annotated[str, written("NAME")] = "icub-reach"
    """Which of them the recording shows; the first one if it is not among them."""
    seeing_noise_deg: Annotated[float, within(0, 30, "degrees"), DEG] = 3.0
    """Standard deviation of every seen direction in the noisy half of the study, degrees."""
    mirror_minutes: Annotated[float, within(0, 600, above=True), written("MINUTES")] = 12.0
    """Body-minutes in front of the mirror, for the longest point of the curve."""
    acts: Annotated[int, within(1, 100_000), N] = 200
    """Single acts for organ identification."""
    learners: Annotated[int, within(2, 100), N] = 5
    """Who look into the mirror, each by itself, for acts that are hard to put to a part."""
    harder_acts: Annotated[int, within(1, 10_000), N] = 40
    """Acts that each of them sees at each grade of each difficulty."""
    tries: Annotated[int, within(1, 1_000), N] = 8
    """Tries at each act."""
    forward_model: Annotated[ToRead | None, written("FILE.nc", "a pilot babble")] = None
    """A forward model that `imitate babble` left, for its body schema."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        if self.shown not in self.demonstrations and find(self.shown) is None:
            raise ExperimentError(f"--shown {self.shown}: this is none of --demonstrations")
