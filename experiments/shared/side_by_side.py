"""Imitator and teacher beside each other in a recording, of the same size."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import rerun as rr

from babbling.axes import FloatArray
from experiments.shared.palette import DEMONSTRATED, Light
from experiments.shared.recording import log_body, log_stick_figure, ticks
from models.shapes import Part, box
from models.teachers.performance import Performance

BESIDE, TEACHER_HEIGHT = 0.55, 0.5
"""m between imitator and teacher, and of the teacher, where the imitator is a HOAP-2."""
THICK, THIN = 0.012, 0.003
"""m, a stick figure's lines, and where arrows run along them."""
ARROW = 0.1
"""m, length of arrows along limbs."""
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
    soles: float
    """m above the floor, where the imitator's lowest moving part reaches: a teacher's feet are drawn there."""

    @property
    def teacher(self) -> tuple[float, float, float]:
        """m beside the imitator, tall, and above the floor: where `log_teacher` draws one."""
        return self.aside, self.height, self.soles

    @classmethod
    def of(cls, imitator: Sequence[Part], teacher: Sequence[Part] = ()) -> "Stage":
        """Room for these parts and their movements; a teacher without parts is as large as the imitator."""
        moving = [part for part in imitator if part.moves]
        bodies = [box(imitator), box(teacher or imitator)]
        aside = GAP * max(high[1] - low[1] for low, high in bodies)
        low, high = np.minimum(*(low for low, _ in bodies)), np.maximum(*(high for _, high in bodies))
        least, most = box(moving)
        return cls(aside, float(most[2] - least[2]), low, high + np.array([0, aside, 0]), float(least[2]))


def log_imitator(
    stream: rr.RecordingStream, parts: Sequence[Part], tick_s: float, aside: float = BESIDE, *, glass: bool = False
) -> None:
    """The imitator, its edges alone if it is of `glass`, and names under both."""
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    log_body(stream, "world/imitator", parts, tick_s, ghost=glass)
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
    soles: float = 0.0,
    *,
    arrows: bool = False,
) -> None:
    """A teacher as a stick figure at the imitator's ticks, beside it, with `arrows` along its parts if asked for."""
    points = stick_figure(performance, frames, tick_s, aside, height, soles)
    thickness = THIN if arrows else THICK
    log_stick_figure(stream, "world/teacher", points, performance.bones, tick_s, DEMONSTRATED, thickness)
    if arrows and (ways := performance.pointing):
        even = np.stack([_at_ticks(performance, way, frames, tick_s) for way in ways.values()], 1)
        log_arrows(stream, "teacher", points[:, [*performance.begins.values()]], even, tick_s, DEMONSTRATED)


def log_arrows(
    stream: rr.RecordingStream, who: str, begins: FloatArray, ways: FloatArray, tick_s: float, colour: Light
) -> None:
    """Arrows from (T, P, 3) m along (T, P, 3) unit vectors."""
    (count, parts), entity = begins.shape[:2], f"world/directions/{who}"
    stream.log(entity, rr.Arrows3D.from_fields(colors=[colour], radii=[ARROW / 14]), static=True)
    arrows = rr.Arrows3D.columns(vectors=ARROW * ways.reshape(-1, 3), origins=begins.reshape(-1, 3))
    stream.send_columns(entity, ticks(count, tick_s), arrows.partition([parts] * count))


def stick_figure(
    performance: Performance,
    frames: int,
    tick_s: float,
    aside: float = BESIDE,
    height: float = TEACHER_HEIGHT,
    soles: float = 0.0,
) -> FloatArray:
    """(frames, K, 3) m a teacher's points at the imitator's ticks, kept beside it and facing as it does, however far it
    walks and turns."""
    even = _at_ticks(performance, performance.ahead, frames, tick_s)
    even *= height / np.quantile(np.ptp(even, axis=1).max(1), 0.9)
    even[..., :2] -= even[..., :2].mean(1, keepdims=True)
    even[..., 2] += soles - even[..., 2].min()
    even[..., 1] += aside
    return even


def _at_ticks(performance: Performance, values: FloatArray, frames: int, tick_s: float) -> FloatArray:
    """(frames, ...) of a teacher's (T, ...), by straight lines; what it ended with lasts."""
    at = np.minimum(np.arange(frames) * tick_s, performance.time[-1])
    columns = values.reshape(len(values), -1).T
    even = np.stack([np.interp(at, performance.time, column) for column in columns], 1)
    return np.asarray(even.reshape(frames, *values.shape[1:]))
