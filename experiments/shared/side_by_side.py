"""Imitator and teacher beside each other in a recording, of the same size."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import rerun as rr

from babbling.axes import FloatArray
from experiments.shared.palette import DEMONSTRATED
from experiments.shared.recording import log_body, log_stick_figure
from models.shapes import Part, box
from models.teachers.performance import Performance

BESIDE, TEACHER_HEIGHT = 0.55, 0.5
"""m between imitator and teacher, and of the teacher, where the imitator is a HOAP-2."""
GAP = 1.1
"""Distance of two bodies, in widths of the wider."""


class Stage(NamedTuple):
    """Where imitator and teacher stand."""

    aside: float
    """m along y from the one to the other."""
    height: float
    """m of a teacher's stick figure: the imitator's."""
    low: FloatArray
    """(3,) m, the least place that any of them reaches."""
    high: FloatArray
    """(3,) m, the greatest."""

    @classmethod
    def of(cls, imitator: Sequence[Part], teacher: Sequence[Part] = ()) -> "Stage":
        """Room for these parts and their movements; a teacher without parts is as large as the imitator."""
        moving = [part for part in imitator if part.moves]
        bodies = [box(imitator), box(teacher or imitator)]
        aside = GAP * max(high[1] - low[1] for low, high in bodies)
        low, high = np.minimum(*(low for low, _ in bodies)), np.maximum(*(high for _, high in bodies))
        return cls(aside, float(np.ptp(box(moving), axis=0)[2]), low, high + np.array([0, aside, 0]))


def log_imitator(stream: rr.RecordingStream, parts: Sequence[Part], tick_s: float, aside: float = BESIDE) -> None:
    """The imitator, and names under both."""
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    log_body(stream, "world/imitator", parts, tick_s)
    low, high = box(parts)
    for label, y in (("imitator", 0.0), ("teacher", aside)):
        place = (*(low + high)[:1] / 2, y + (low + high)[1] / 2, low[2])
        sign = rr.Points3D([place], radii=[0.004], labels=[label], colors=[(220, 220, 220)], show_labels=True)
        stream.log(f"world/labels/{label}", sign, static=True)


def log_teacher(
    stream: rr.RecordingStream,
    performance: Performance,
    frames: int,
    tick_s: float,
    aside: float = BESIDE,
    height: float = TEACHER_HEIGHT,
) -> None:
    """A teacher as a stick figure at the imitator's ticks, beside it."""
    points = stick_figure(performance, frames, tick_s, aside, height)
    log_stick_figure(stream, "world/teacher", points, performance.bones, tick_s, DEMONSTRATED)


def stick_figure(
    performance: Performance, frames: int, tick_s: float, aside: float = BESIDE, height: float = TEACHER_HEIGHT
) -> FloatArray:
    """(frames, K, 3) m a teacher's points at the imitator's ticks, kept beside it and facing as it does, however far it
    walks and turns."""
    points = performance.ahead
    at = np.minimum(np.arange(frames) * tick_s, performance.time[-1])
    columns = points.reshape(len(points), -1).T
    even: FloatArray = np.stack([np.interp(at, performance.time, column) for column in columns], 1)
    even = even.reshape(frames, -1, 3)
    even = even * (height / np.quantile(np.ptp(even, axis=1).max(1), 0.9))
    even[..., :2] -= even[..., :2].mean(1, keepdims=True)
    even[..., 2] -= even[..., 2].min()
    even[..., 1] += aside
    return even
