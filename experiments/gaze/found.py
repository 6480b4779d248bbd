"""What following gaze came to."""

from typing import Any, NamedTuple

from babbling.axes import FloatArray
from experiments.gaze.crowds import Crowds
from experiments.gaze.infer import Judged
from experiments.gaze.scene import Following
from experiments.gaze.trials import Trials, Watcher
from imitation.gaze.reader import Preferences


class Found(NamedTuple):
    """Everything a run found; for figures and the recording."""

    who: Watcher
    trials: Trials
    """Clear ones, whose toys were followed."""
    clear: Judged
    alone: Judged
    preferred: Judged
    likes: Preferences
    calibration: FloatArray
    """(bins, 3) confidence, accuracy, count."""
    calibration_error: float
    covered: dict[str, Any]
    episode: Following
    crowds: Crowds | None
    """With --study."""
