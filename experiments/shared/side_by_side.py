"""Imitator and teacher beside each other in a recording, of the same size."""

from collections.abc import Sequence

import numpy as np
import rerun as rr

from babbling.axes import FloatArray
from experiments.shared.palette import DEMONSTRATED
from experiments.shared.recording import log_body, log_stick_figure
from models.shapes import Part
from models.teachers.performance import Performance

BESIDE = 0.55
"""m between imitator and teacher."""
TEACHER_HEIGHT = 0.5
"""m; teachers are drawn at the imitator's size."""


def log_imitator(stream: rr.RecordingStream, parts: Sequence[Part], tick_s: float) -> None:
    """The imitator, and names under both."""
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    log_body(stream, "world/imitator", parts, tick_s)
    for label, place in (("imitator", (0, 0, 0.02)), ("teacher", (0, BESIDE, 0.02))):
        sign = rr.Points3D([place], radii=[0.004], labels=[label], colors=[(220, 220, 220)], show_labels=True)
        stream.log(f"world/labels/{label}", sign, static=True)


def log_teacher(stream: rr.RecordingStream, performance: Performance, frames: int, tick_s: float) -> None:
    """A teacher as a stick figure at the imitator's ticks, kept beside it however far it walks."""
    points = performance.points
    at = np.minimum(np.arange(frames) * tick_s, performance.time[-1])
    columns = points.reshape(len(points), -1).T
    even: FloatArray = np.stack([np.interp(at, performance.time, column) for column in columns], 1)
    even = even.reshape(frames, -1, 3)
    even = even * (TEACHER_HEIGHT / np.quantile(np.ptp(even, axis=1).max(1), 0.9))
    even[..., :2] -= even[..., :2].mean(1, keepdims=True)
    even[..., 2] -= even[..., 2].min()
    even[..., 1] += BESIDE
    log_stick_figure(stream, "world/teacher", even, performance.bones, tick_s, DEMONSTRATED)
