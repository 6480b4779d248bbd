"""The map of a grid: bodies that stand on places and act by single moves (chapter, section 3.3.1).

Senses: x, y, and touch on the sides N, E, S, W. The forward model is local: where a move ends relative to where it
began, the same in every place. Touch says where that law is overridden from outside, so transitions that begin in touch
with anything are left out: counting them (or only leaving out their "stayed" outcomes) never converges to the law.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.body import Body
from babbling.errors import BabblingError

MOVES = ("N", "E", "S", "W", "X")
"""Names of the five relative outcomes, for people."""

DIRECTIONS: IntArray = np.array([[0, 1], [1, 0], [0, -1], [-1, 0], [0, 0]])
"""(5, 2) displacement of each outcome; the touch senses have the order of the first four."""
DIRECTIONS.flags.writeable = False

_OF_STEP = np.full((3, 3), -1)
_OF_STEP[tuple(DIRECTIONS.T + 1)] = range(len(MOVES))


@dataclass(frozen=True)
class Places:
    """A `babbling.states.StateMap`: the places that the first two senses can tell apart, numbered row by row."""

    low: tuple[int, int]
    """Least x and y."""
    high: tuple[int, int]
    """Greatest."""
    contexts: ClassVar[Mapping[str, tuple[str, ...]]] = MappingProxyType({})
    outcomes: ClassVar[tuple[str, ...]] = MOVES

    @classmethod
    def of(cls, body: Body) -> "Places":
        """The places of a body, from the ranges of its first two senses."""
        (x, y), (right, top) = body.sense_low[:2].astype(int).tolist(), body.sense_high[:2].astype(int).tolist()
        return cls((x, y), (right, top))

    @property
    def width(self) -> int:
        """Places in a row."""
        return self.high[0] - self.low[0] + 1

    @property
    def size(self) -> int:
        """How many places there are."""
        return self.width * (self.high[1] - self.low[1] + 1)

    def number(self, senses: ArrayLike) -> IntArray:
        """(...) numbers of the places that (..., 2 or more) senses begin with.

        Raises:
            BabblingError: a place outside.
        """
        where = np.asarray(senses)[..., :2].astype(np.int64)
        outside = ((where < self.low) | (where > self.high)).any(-1)
        if outside.any():
            x, y = where[outside][0]
            raise BabblingError(f"place ({x}, {y}) lies outside {self.low} to {self.high}")
        number: IntArray = (where[..., 1] - self.low[1]) * self.width + where[..., 0] - self.low[0]
        return number

    def place(self, number: ArrayLike) -> IntArray:
        """(..., 2) inverse of `number`."""
        n = np.asarray(number)
        return np.stack([n % self.width + self.low[0], n // self.width + self.low[1]], axis=-1)

    def name(self, number: int) -> str:
        """(x, y)."""
        x, y = self.place(number)
        return f"({x}, {y})"

    def context(self, senses: FloatArray) -> tuple[IntArray, ...]:
        """None: a move is the same in every place."""
        return ()

    def outcome(self, here: ArrayLike, there: ArrayLike) -> IntArray:
        """(...) `relative_move` from one place to the other, by their numbers."""
        return relative_move(self.place(here), self.place(there))

    def lawful(self, senses: FloatArray) -> BoolArray:
        """(...) nothing is touched."""
        free: BoolArray = senses[..., 2:6].max(-1) == 0
        return free


def relative_move(before: ArrayLike, after: ArrayLike) -> IntArray:
    """(...) outcome N, E, S, W, X = 0 .. 4 that leads from one (..., 2) place to the other.

    Raises:
        BabblingError: a jump, which is no single move.
    """
    step = np.asarray(after).astype(np.int64) - np.asarray(before).astype(np.int64)
    near = np.clip(step, -1, 1) + 1
    move = np.where((np.abs(step) > 1).any(-1), -1, _OF_STEP[near[..., 0], near[..., 1]])
    if (move < 0).any():
        bad = step[move < 0].reshape(-1, 2)[0]
        raise BabblingError(f"a displacement of ({bad[0]}, {bad[1]}) is no single move; there are {', '.join(MOVES)}")
    return move


def overridden(table: FloatArray, touch: BoolArray) -> FloatArray:
    """The forward model where walls are felt: what would lead into touch stays instead.

    Args:
        table: (A, 5) P(outcome | action) away from walls.
        touch: (..., 4) whether the N, E, S, W side is blocked.

    Returns:
        (..., A, 5), rows sum as before.
    """
    blocked = np.asarray(touch, bool)[..., None, :]
    moves = np.where(blocked, 0.0, table[..., :4])
    stays = table[..., 4] + np.where(blocked, table[..., :4], 0.0).sum(-1)
    return np.concatenate([moves, np.broadcast_to(stays, moves.shape[:-1])[..., None]], axis=-1)
