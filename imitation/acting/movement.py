"""A movement that was seen, in one's own terms: what one's own senses would read at every tick."""

from dataclasses import dataclass

import numpy as np

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
    """(T, S) sense lines as they would read; NaN where a sense cannot be seen on somebody else."""

    def __post_init__(self) -> None:
        if self.senses.ndim != 2 or len(self.senses) < 3:
            raise ImitationError(f"{self.name}: {len(self.senses)} frames; a movement needs at least 3")
        object.__setattr__(self, "senses", fixed(np.array(self.senses, float)))

    def postures(self, schema: BodySchema) -> FloatArray:
        """(T, F) postures to come to.

        Raises:
            ImitationError: a posture that the schema needs was not seen.
        """
        postures = self.senses[:, schema.posture]
        if np.isnan(postures).any():
            factor = int(np.argwhere(np.isnan(postures).any(0))[0, 0])
            raise ImitationError(f"{self.name}: nothing was seen for the posture that motor {factor} moves")
        return postures


def approach(start: FloatArray, goals: FloatArray, tick_s: float) -> FloatArray:
    """(N, ..., F) ways from rest at each `start` (..., F) into the first of `goals` (T, F), arriving at its pace.

    Law: quintics with given position, velocity and acceleration at both ends (the minimum-jerk paths between moving
    states, Flash and Hogan 1985): from rest to a run-up point, and from rest there into the movement. The run-up is
    short, so that a movement which starts fast does not send the body far afield.
    """
    pace = (-3 * goals[0] + 4 * goals[1] - goals[2]) / (2 * tick_s)
    bend = (goals[0] - 2 * goals[1] + goals[2]) / tick_s**2
    still = np.zeros_like(pace)
    foot = np.broadcast_to(goals[0] - pace * RUN_UP_S / 2, start.shape)
    return np.concatenate(
        [
            _quintic(start, foot, still, still, APPROACH_S, tick_s),
            _quintic(foot, goals[0], pace, bend, RUN_UP_S, tick_s),
        ]
    )


def _quintic(
    start: FloatArray, end: FloatArray, pace: FloatArray, bend: FloatArray, seconds: float, tick_s: float
) -> FloatArray:
    count = round(seconds / tick_s)
    span, pace, bend = end - start, pace * seconds, bend * seconds**2
    r = (np.arange(count) / count).reshape(-1, *(1,) * start.ndim)
    way: FloatArray = start + (
        (10 * span - 4 * pace + bend / 2) * r**3
        + (-15 * span + 7 * pace - bend) * r**4
        + (6 * span - 3 * pace + bend / 2) * r**5
    )
    return way
