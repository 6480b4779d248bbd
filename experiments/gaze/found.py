"""What following gaze came to."""

from typing import Any, NamedTuple

from babbling.axes import BoolArray, FloatArray
from experiments.gaze.crowds import Crowds
from experiments.gaze.scene import Following
from experiments.gaze.trials import Trials, Watcher
from imitation.gaze.reader import Preferences


class Found(NamedTuple):
    """Everything a run found; for figures and the recording."""

    who: Watcher
    trials: Trials
    """Clear ones, whose toys were followed."""
    clear: BoolArray
    """(N,) whether the most probable toy was the one looked at."""
    alone: BoolArray
    """The same of close pairs, by gaze alone."""
    preferred: BoolArray
    """By gaze and learned preferences."""
    likes: Preferences
    calibration: FloatArray
    """(bins, 3) confidence, accuracy, count."""
    calibration_error: float
    covered: dict[str, Any]
    episode: Following
    crowds: Crowds | None
    """With --study."""
