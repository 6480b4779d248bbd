"""Options of `imitate gaze`."""

from typing import Annotated

from experiments.shared.options import DEG, EyeOptions, Flag, M, Minutes, N, ToRead, options, within, written


@options
class Config(EyeOptions):
    """Options of `imitate gaze`."""

    study: Flag = False
    """All trials of the figures: 200 clear, 600 of close pairs, 1000 for calibration, 100 of each covered face, and
    five learners before beads that lie close."""
    learned_eyes: Annotated[ToRead | None, written("FILE.nc", "babbles anew")] = None
    """eyes.nc of an earlier `imitate saccades`."""
    babbling_minutes: Minutes = 15.0
    """Body-minutes of random saccades, if babbling anew."""
    objects: Annotated[str | None, written('"X,Y;X,Y;..."', "drawn by chance")] = None
    """Where the toys lie in the recorded episode: metres ahead and left, 2 to 4 of them."""
    target: Annotated[int, within(0, 4), N] = 0
    """Which of them the teacher looks at in the recorded episode; 0 lets chance decide, 1 is the first."""
    aim_deg: Annotated[float, within(0, 20, "degrees", above=True), DEG] = 3.0
    """How exactly a teacher's head points at what it looks at: standard deviation of each axis, degrees."""
    distance: Annotated[float, within(0.7, 1.2, "m: a table has room for toys"), M] = 0.95
    """Metres between the heads."""
