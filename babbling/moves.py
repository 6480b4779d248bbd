"""Wandering: bodies that stand on a grid of places and act by single moves (chapter, section 3.3.1).

What such a body knows of itself: which senses tell its place, which tell touch, and that it has a few single acts. The
forward model is local: where a move ends relative to where it began, the same in every place. Touch says where that
law is overridden from outside, so transitions that begin in touch with anything are left out: counting them (or only
leaving out their "stayed" outcomes) never converges to the law.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babbling.axes import Axis, FloatArray, IntArray
from babbling.body import Body
from babbling.errors import BabblingError
from babbling.exploration import MotorRange, choices
from babbling.forward_model import ForwardModel
from babbling.reading import Transitions

MOVES = ("N", "E", "S", "W", "X")
"""Names of the five relative outcomes, for people."""

DIRECTIONS: IntArray = np.array([[0, 1], [1, 0], [0, -1], [-1, 0], [0, 0]])
"""(5, 2) displacement of each outcome; the touch senses have the order of the first four."""
DIRECTIONS.flags.writeable = False

_OF_STEP = np.full((3, 3), -1)
for _number, (_dx, _dy) in enumerate(DIRECTIONS):
    _OF_STEP[_dx + 1, _dy + 1] = _number


@dataclass(frozen=True)
class Places:
    """The grid of places that two senses can tell apart, numbered row by row."""

    low: tuple[int, int]
    """Least reading of the two place senses."""
    high: tuple[int, int]
    """Greatest reading."""

    @classmethod
    def of(cls, body: Body, senses: Sequence[int] = (0, 1)) -> "Places":
        """The places of a body, from the ranges of its place senses."""
        low, high = body.sense_low[list(senses)].astype(int), body.sense_high[list(senses)].astype(int)
        return cls((int(low[0]), int(low[1])), (int(high[0]), int(high[1])))

    @property
    def width(self) -> int:
        """Places in a row."""
        return self.high[0] - self.low[0] + 1

    @property
    def size(self) -> int:
        """How many places there are."""
        return self.width * (self.high[1] - self.low[1] + 1)

    def number(self, place: ArrayLike) -> IntArray:
        """(...) numbers of (..., 2) places.

        Raises:
            BabblingError: a place outside.
        """
        where = np.asarray(place).astype(np.int64)
        if ((where < self.low) | (where > self.high)).any():
            bad = where[((where < self.low) | (where > self.high)).any(-1)].reshape(-1, 2)[0]
            raise BabblingError(f"place ({bad[0]}, {bad[1]}) lies outside {self.low} to {self.high}")
        number: IntArray = (where[..., 1] - self.low[1]) * self.width + where[..., 0] - self.low[0]
        return number

    def place(self, number: ArrayLike) -> IntArray:
        """(..., 2) inverse of `number`."""
        n = np.asarray(number)
        return np.stack([n % self.width + self.low[0], n // self.width + self.low[1]], axis=-1)


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


def overridden(table: FloatArray, touch: NDArray[np.bool_]) -> FloatArray:
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


class RelativeMoves:
    """Reads (place, place after, touch before) as relative moves; see the module.

    Args:
        factors: 1, or the number of copies when each copy is to learn for itself (copy b is factor b).
    """

    def __init__(self, *, place: Sequence[int] = (0, 1), touch: Sequence[int] = (2, 3, 4, 5), factors: int = 1) -> None:
        self.place, self.touch, self.factors = list(place), list(touch), factors

    def transitions(self, before: FloatArray, motors: FloatArray, after: FloatArray) -> Transitions:
        """(N, S), (N, 1), (N, S) in; NaN marks transitions that began in touch."""
        free = before[:, self.touch].max(-1) == 0
        move = relative_move(before[:, self.place], after[:, self.place])
        outcome = np.where(free, move, np.nan).reshape(-1, self.factors)
        return Transitions((), motors[:, 0].reshape(-1, self.factors), outcome)


class Wanderer:
    """Wanders at random through a grid world and counts where its moves end.

    Args:
        body: who wanders (only its ranges are read).
        actions: names of the actions, for people.
        alone: whether every copy learns for itself (a forward model with one factor per copy).
    """

    def __init__(self, body: Body, actions: Sequence[str] = MOVES, *, alone: bool = False) -> None:
        if len(body.motor_low) != 1 or int(body.motor_high[0] - body.motor_low[0]) + 1 != len(actions):
            raise BabblingError(f"a wanderer needs one motor with {len(actions)} choices ({', '.join(actions)})")
        self.actions = tuple(actions)
        self.fingerprint = body.fingerprint
        self.reading = RelativeMoves(factors=body.copies if alone else 1)

    def forward_model(self) -> ForwardModel:
        """Nothing learned yet: P(outcome | action), no context, no prior."""
        factors = self.reading.factors
        return ForwardModel(
            [],
            Axis.categorical("action", self.actions, factors),
            Axis.categorical("outcome", MOVES, factors),
            factors=[str(i) for i in range(factors)],
            provenance={"body": self.fingerprint},
        )

    def stream(self, body: Body, rng: np.random.Generator) -> Iterator[FloatArray]:
        """Random acts without end."""
        still = np.zeros_like(body.motor_low)
        motors = MotorRange(body.motor_low, body.motor_high, still, still, still)
        return choices(motors, body.copies, body.tick_s, rng)
