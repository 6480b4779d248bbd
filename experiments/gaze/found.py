"""What following gaze came to."""

from typing import Any, NamedTuple

from babbling.axes import FloatArray
from experiments.gaze.infer import Judged
from experiments.gaze.scene import Episode


class Found(NamedTuple):
    """Everything a run found; for figures and the recording."""

    clear: Judged
    alone: Judged
    preferred: Judged
    calibration: FloatArray
    covered: dict[str, Any]
    episode: Episode
