"""Options of `imitate gaze`."""

from typing import Annotated

from experiments.shared.options import EyeOptions, Minutes, ToRead, options, within


@options
class Config(EyeOptions):
    """Options of `imitate gaze`."""

    study: bool = False
    """All trials of the figures: 200 clear, 600 of close pairs, 1000 for calibration, 100 of each covered face, and
    five learners before beads that lie close."""
    learned_eyes: ToRead | None = None
    """eyes.nc of an earlier `imitate saccades`; None babbles anew."""
    babbling_minutes: Minutes = 15.0
    """Body-minutes of random saccades, if babbling anew."""
    objects: str | None = None
    """Where the toys lie in the recorded episode: x,y;x,y;... in metres ahead and left, 2 to 4 of them."""
    target: Annotated[int, within(0, 4)] = 0
    """Which of them the teacher looks at in the recorded episode; 0 lets chance decide, 1 is the first."""
    aim_deg: Annotated[float, within(0, 20, "degrees", above=True)] = 3.0
    """How exactly a teacher's head points at what it looks at: standard deviation of each axis, degrees."""
    distance: Annotated[float, within(0.7, 1.2, "m: a table has room for toys")] = 0.95
    """m between the heads."""
