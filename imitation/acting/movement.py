"""A movement that was seen, in one's own terms: what one's own senses would read at every tick."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from babbling.axes import FloatArray, fixed
from babbling.schema import BodySchema
from imitation.errors import ImitationError

APPROACH_S, RUN_UP_S = 2.0, 0.4
"""Time taken to come from rest to where a movement begins, and to gather its initial pace."""


@dataclass(frozen=True)
class Movement:
    """Sub-goals s_1 .. s_N of the chapter (section 3.2), one per control tick."""

    name: str
    tick_s: float
    senses: FloatArray
    """(T, S) sense lines as they would read, or (T, B, S) for copies that do different things; NaN where a sense cannot
    be seen on somebody else."""

    def __post_init__(self) -> None:
        if self.senses.ndim not in (2, 3) or len(self.senses) < 3:
            raise ImitationError(f"{self.name}: {len(self.senses)} frames; a movement needs at least 3")
        object.__setattr__(self, "senses", fixed(np.array(self.senses, float)))

    def postures(self, schema: BodySchema) -> FloatArray:
        """(T, F) or (T, B, F) postures to come to.

        Raises:
            ImitationError: a posture that the schema needs was not seen.
        """
        postures = self.senses[..., schema.posture]
        if np.isnan(postures).any():
            factor = int(np.argwhere(np.isnan(postures))[0, -1])
            raise ImitationError(f"{self.name}: nothing was seen for the posture that motor {factor} moves")
        return postures


def together(movements: Sequence[Movement]) -> Movement:
    """Copy b does movement b; who is done waits in the last posture."""
    longest = max(len(movement.senses) for movement in movements)
    waiting = [np.pad(m.senses, ((0, longest - len(m.senses)), (0, 0)), mode="edge") for m in movements]
    return Movement(" and ".join(m.name for m in movements), movements[0].tick_s, np.stack(waiting, axis=1))


def slowed(frames: FloatArray, factor: float) -> FloatArray:
    """Frames (T, ...) of a movement that takes `factor` times as long: the spline through them, at as many a second."""
    if factor == 1:
        return frames
    time = np.arange(int((len(frames) - 1) * factor + 1e-9) + 1) / factor
    return np.asarray(CubicSpline(np.arange(len(frames)), frames, axis=0)(time))


def approach(start: FloatArray, goals: FloatArray, tick_s: float, low: FloatArray, high: FloatArray) -> FloatArray:
    """(N, ..., F) ways from rest at each `start` (..., F) into the first of `goals` (T, ..., F), arriving at its pace.

    Law: quintics with given position, velocity and acceleration at both ends (the minimum-jerk paths between moving
    states, Flash and Hogan 1985): from rest to a run-up point, and from rest there into the movement. The run-up is
    short, so that a movement which starts fast does not send the body far afield, and shorter where the way back ends
    at `low` or `high` (F,): none leaves that range.
    """
    pace = (-3 * goals[0] + 4 * goals[1] - goals[2]) / (2 * tick_s)
    bend = (goals[0] - 2 * goals[1] + goals[2]) / tick_s**2
    still = np.zeros_like(pace)
    room = np.where(pace > 0, goals[0] - low, high - goals[0])
    run_up = np.clip(2 * room / np.maximum(np.abs(pace), 1e-9), tick_s, RUN_UP_S)
    foot = np.broadcast_to(np.clip(goals[0] - pace * run_up / 2, low, high), start.shape)
    there = _quintic(start, foot, still, still, np.full_like(pace, APPROACH_S), APPROACH_S, tick_s)
    along = _quintic(foot, goals[0], pace, bend, run_up, RUN_UP_S, tick_s)
    return np.asarray(np.clip(np.concatenate([there, along]), low, high))


def _quintic(
    start: FloatArray,
    end: FloatArray,
    pace: FloatArray,
    bend: FloatArray,
    seconds: FloatArray,
    whole_s: float,
    tick_s: float,
) -> FloatArray:
    """Its last `seconds` (F,) of `whole_s` are the way; before, it rests at the start."""
    span, pace, bend = end - start, pace * seconds, bend * seconds**2
    count = round(whole_s / tick_s)
    left = (np.arange(count, 0, -1) * tick_s).reshape(-1, *(1,) * start.ndim)
    r = np.maximum(1 - left / seconds, 0)
    way: FloatArray = start + (
        (10 * span - 4 * pace + bend / 2) * r**3
        + (-15 * span + 7 * pace - bend) * r**4
        + (6 * span - 3 * pace + bend / 2) * r**5
    )
    return way
