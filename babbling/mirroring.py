"""Babbling in front of a mirror: moving, feeling the posture, and seeing where one's own parts point (chapter, 2.2).

Two kinds of movement take turns. *Leaps* move everything at once to a fresh random posture, so that postures cover
their space. *Acts* move one motor alone between two moments of rest, so that what changed in the mirror can only have
been that motor's doing (the single limb acts of infants); now and then nothing is moved at all, which shows how much
things seem to move when they do not.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.body import Body
from babbling.errors import BabblingError
from babbling.exploration import MotorRange
from babbling.schema import BodySchema

LEAP_S, ACT_S, HOLD_S = 0.85, 0.35, 0.14
"""Time to a fresh posture, of a single act, and of the rest before and after it."""
ACTS = 2
"""Acts after each leap."""
STILL = 1 / 7
"""Share of acts in which nothing is moved."""
SHORTEST_ACT = 0.3
"""An act goes at least this share of its motor's range, where its speed allows."""
HASTE = 0.9
"""Share of a motor's greatest speed that is used."""
ENDS = 0.045
"""Share by which the useful range of the motors is widened at either end: a straight knee is at its stop."""
CYCLE_S = LEAP_S + HOLD_S + ACTS * (ACT_S + HOLD_S)


def angles_between(first: FloatArray, second: FloatArray) -> FloatArray:
    """(...) radians between (..., 3) unit vectors; exact for small ones too."""
    away = np.linalg.norm(first - second, axis=-1)
    angles: FloatArray = 2 * np.arcsin(np.clip(away / 2, 0, 1))
    return angles


class Mirror(Protocol):
    """What a mirror shows."""

    @property
    def parts(self) -> tuple[str, ...]:
        """P names of what can be told apart by looking."""

    def look(self) -> FloatArray:
        """(B, P, 3) unit vectors in the looker's own torso's frame."""


@dataclass(frozen=True)
class MirrorExperience:
    """What was felt and seen, tick by tick.

    postures: (T, B, F) posture senses, by factor. directions: (T, B, P, 3).
    acts: (A, 3) copy, first tick after the rest before, and factor moved, F for nothing; each ends ACT_S later.
    """

    parts: tuple[str, ...]
    tick_s: float
    postures: FloatArray
    directions: FloatArray
    acts: IntArray

    @property
    def minutes(self) -> float:
        """Body time."""
        return float(self.postures.shape[0] * self.postures.shape[1] * self.tick_s / 60)

    def first(self, minutes: float) -> "MirrorExperience":
        """The same babble broken off after so many body-minutes (at least one whole cycle)."""
        shortest = round(CYCLE_S / self.tick_s)
        count = max(round(minutes * 60 / self.tick_s / self.postures.shape[1]), shortest)
        end = self.acts[:, 1] + round((ACT_S + HOLD_S) / self.tick_s) <= count
        return MirrorExperience(self.parts, self.tick_s, self.postures[:count], self.directions[:count], self.acts[end])


def mirror_babble(
    body: Body,
    mirror: Mirror,
    schema: BodySchema,
    motors: MotorRange,
    minutes: float,
    seed: int,
    report: Callable[[float], None] = lambda share: None,
) -> MirrorExperience:
    """Babble in front of a mirror for so many body-minutes over all copies.

    Raises:
        BabblingError: less time than one cycle of leap and acts takes.
    """
    shortest = CYCLE_S * body.copies / 60
    if not minutes >= shortest:
        raise BabblingError(
            f"{minutes:g} minutes in front of the mirror: {body.copies} copies need at least {shortest:.2g} for a leap "
            "and the acts after it"
        )
    ticks = round(minutes * 60 / body.tick_s / body.copies)
    wider = ENDS * (motors.high - motors.low)
    low, high = np.maximum(motors.low - wider, body.motor_low), np.minimum(motors.high + wider, body.motor_high)
    motors = replace(motors, low=low, high=high)
    commands, acts = _plan(motors, body.copies, body.tick_s, ticks, np.random.default_rng([seed, 0x31]))
    postures = np.empty((ticks, body.copies, len(schema.posture)))
    body.reset()
    directions = np.empty((ticks, *mirror.look().shape))
    for tick, command in enumerate(commands):
        postures[tick] = body.act(command)[:, schema.posture]
        directions[tick] = mirror.look()
        report((tick + 1) / ticks)
    return MirrorExperience(tuple(mirror.parts), body.tick_s, postures, directions, acts)


def _plan(
    motors: MotorRange, copies: int, tick_s: float, ticks: int, rng: np.random.Generator
) -> tuple[FloatArray, IntArray]:
    """(T, B, M) commands and (A, 3) acts."""
    leap, act, hold = (round(seconds / tick_s) for seconds in (LEAP_S, ACT_S, HOLD_S))
    count = len(motors.low)
    span = motors.high - motors.low
    reach = 8 / 15 * HASTE * motors.speed  # of a minimum-jerk move of one second
    here = np.broadcast_to(motors.rest, (copies, count)).copy()
    pieces: list[FloatArray] = []
    acts: list[tuple[int, int, int]] = []
    turn, clock = np.empty(0, int), 0
    while clock < ticks:
        goal = motors.low + span * rng.random((copies, count))
        goal = np.clip(goal, here - reach * LEAP_S, here + reach * LEAP_S)
        pieces.append(_moved(here, goal, leap, hold, rng.uniform(0.5, 1, (copies, count))))
        here, clock = goal, clock + leap + hold
        for _ in range(ACTS):
            goal, start = here.copy(), clock
            for copy in range(copies):
                if rng.random() < STILL:
                    acts.append((copy, start, count))
                    continue
                if not len(turn):  # every motor gets its turn before any comes again
                    turn = rng.permutation(count)
                motor, turn = int(turn[0]), turn[1:]
                goal[copy, motor] = _elsewhere(motors, motor, float(here[copy, motor]), reach[motor] * ACT_S, rng)
                acts.append((copy, start, motor))
            pieces.append(_moved(here, goal, act, hold, np.ones((copies, count))))
            here, clock = goal, clock + act + hold
    commands = np.concatenate(pieces)[:ticks]
    commands = commands + motors.jitter * rng.standard_normal(commands.shape) * 0.1
    done = np.array([a for a in acts if a[1] + act + hold <= ticks], np.int64).reshape(-1, 3)
    return commands, done


def _elsewhere(motors: MotorRange, motor: int, here: float, reach: float, rng: np.random.Generator) -> float:
    """A command some way off, up or down, inside the motor's range."""
    low, high = float(motors.low[motor]), float(motors.high[motor])
    least = min(SHORTEST_ACT * (high - low), reach)
    down, up = here - low, high - here
    side = rng.choice([-1, 1]) if min(down, up) > least else (1 if up > down else -1)
    most = min(up if side > 0 else down, reach)
    return float(here + side * rng.uniform(min(least, most), most))


def _moved(start: FloatArray, goal: FloatArray, moving: int, holding: int, share: FloatArray) -> FloatArray:
    """Minimum-jerk way (Flash and Hogan 1985) in `share` of `moving` ticks, then rest."""
    r = np.minimum((np.arange(1, moving + 1)[:, None, None] / moving) / share, 1)
    way = start + (goal - start) * r**3 * (10 - 15 * r + 6 * r * r)
    return np.concatenate([way, np.broadcast_to(goal, (holding, *goal.shape))])
