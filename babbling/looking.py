"""Oculomotor babbling (chapter, section 3.4): what a saccade does to what is seen.

P(s_{t+1} | s_t, a_t) of a head whose states are the feedback of its motors and the positions of features on its
retinas. One factor for every motor and image coordinate; a thing at (u, v) is moved by a saccade of one motor, and how
far depends on where it was and, for a motor that the other one carries about, on the other's posture:

    context (u, v, posture of the other motor), action = commanded change of posture, rad,
    outcome = displacement on the image that the efference copy did not foresee, pixels.

The efference copy's account is least squares on the pilot's saccades: displacement = action times a quadratic of action
and contexts (nothing moves when nothing is done). The table learns what that misses, and how surely it is known; with
displacements themselves as outcomes a table of this size needs ten times the babbling, since the few visits of a row
lie anywhere in its cell. Saccades of both motors are chained, one motor after the other: P(s'' | s, a_1, a_2) = sum
over s' of P(s'' | s', a_2) P(s' | s, a_1), taken at the mean of s'.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from babbling.axes import Axis, FloatArray, IntArray
from babbling.body import Body
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel
from babbling.loop import explore, flat
from babbling.reading import Transitions

GRID = (9, 7, 5, 13, 41)
"""Grid points of u, v, the other motor's posture, action and outcome."""
PRIOR_STRENGTH = 0.3
"""Pseudo-counts of the linear-Gaussian prior: visits are spread over 16 neighbouring cells and there are many cells."""
MARGIN, QUANTILE = 1.5, 0.998
"""The outcome axis reaches this many times the pilot's quantile, and half a pixel."""
STILL = 0.004
"""rad: a motor told to move less than this was not moved (a quarter of a degree; encoders and servos are not finer)."""
PILOT_TICKS = 40
COPY_TERMS = 15
LEAST_SIGHTINGS = 60


class Retina(NamedTuple):
    """Which sense lines are image coordinates: a baby is born with eyes, not with what they tell."""

    first: int
    """Sense line of the first thing's first coordinate; before it stand the motors' senses."""
    coordinates: int
    """C, coordinates of one thing: u and v in one eye or in both."""
    centre: FloatArray
    """(C,) middle of the image along each coordinate, pixels."""
    half: FloatArray
    """(C,) half of the image along each coordinate, pixels."""

    @classmethod
    def of(cls, body: Body, motors: int = 2, coordinates: int = 4) -> "Retina":
        """The usual layout: posture senses of the motors, then (u, v) in the left and right eye for each thing."""
        low, high = (v[motors : motors + coordinates] for v in (body.sense_low, body.sense_high))
        return cls(motors, coordinates, (low + high) / 2, (high - low) / 2)

    def things(self, senses: FloatArray) -> FloatArray:
        """(..., S) senses to (..., K, C) coordinates from the image's middle, NaN unseen."""
        seen = senses[..., self.first :]
        return seen.reshape(*seen.shape[:-1], -1, self.coordinates) - self.centre


@dataclass(frozen=True)
class Reach:
    """Which saccades are babbled."""

    low: FloatArray
    """(M,) least posture, rad."""
    high: FloatArray
    """(M,) greatest posture, rad."""
    largest: FloatArray
    """(M,) largest change of posture in one saccade, rad."""


class Efference(NamedTuple):
    """posture = offset + slope * command, learned from the pilot; factor order is that of the motors."""

    posture: IntArray
    """(M,) sense line that each motor moves."""
    offset: FloatArray
    """(M,)"""
    slope: FloatArray
    """(M,)"""

    def postures(self, motors: FloatArray) -> FloatArray:
        """(..., M) commands to the postures they ask for."""
        return np.asarray(self.offset + self.slope * motors)

    def motors(self, postures: FloatArray) -> FloatArray:
        """Inverse of `postures`."""
        return np.asarray((postures - self.offset) / self.slope)


class Looking:
    """Reads saccades as transitions; see the module. A `babbling.reading.Reading`."""

    def __init__(self, retina: Retina, efference: Efference, line: FloatArray) -> None:
        self.retina, self.efference, self.line = retina, efference, line
        self.scale = np.concatenate([[1.0], retina.half[:2], [1.0]])
        coordinates = retina.coordinates
        self.motor: IntArray = np.repeat(np.arange(2), coordinates)
        """(F,) motor of each factor."""
        self.coordinate: IntArray = np.tile(np.arange(coordinates), 2)
        """(F,) image coordinate of each factor."""

    def transitions(self, before: FloatArray, motors: FloatArray, after: FloatArray) -> Transitions:
        """(N, S), (N, M), (N, S) to N * K rows: one for each kind of thing."""
        was, now = self.retina.things(before), self.retina.things(after)
        posture = before[:, self.efference.posture]
        change = self.efference.postures(motors) - posture
        context, action = self.situate(was, posture[:, None], change[:, None])
        alone = np.abs(change[:, 1 - self.motor]) < STILL
        moved = now[..., self.coordinate] - was[..., self.coordinate] - self.straight(context, action)
        outcome = np.where(alone[:, None], moved, np.nan)
        factors = len(self.motor)
        return Transitions(
            tuple(c.reshape(-1, factors) for c in context), action.reshape(-1, factors), outcome.reshape(-1, factors)
        )

    def situate(
        self, things: FloatArray, posture: FloatArray, change: FloatArray
    ) -> tuple[tuple[FloatArray, FloatArray, FloatArray], FloatArray]:
        """Contexts (u, v, other posture) and actions, (..., F) each, of things (..., C), postures, changes (..., 2)."""
        eye = 2 * (self.coordinate // 2)
        u, v = things[..., eye], things[..., eye + 1]
        other = np.broadcast_to(posture[..., 1 - self.motor], u.shape)
        return (u, v, other), np.broadcast_to(change[..., self.motor], u.shape)

    def straight(self, context: tuple[FloatArray, ...], action: FloatArray) -> FloatArray:
        """(..., F) displacement that the efference copy foresees."""
        terms = copy_terms(action, *(value / scale for value, scale in zip(context, self.scale[1:], strict=True)))
        return np.asarray(np.einsum("...t,...t->...", terms, self.line))

    def straight_of(self, factor: int, context: tuple[FloatArray, ...], action: FloatArray) -> FloatArray:
        """(...) the same for one factor, from (...) contexts and actions."""
        terms = copy_terms(action, *(value / scale for value, scale in zip(context, self.scale[1:], strict=True)))
        return np.asarray(terms @ self.line[factor])


def copy_terms(action: FloatArray, *context: FloatArray) -> FloatArray:
    """(..., 15) terms of the efference copy: action times 1, each of (action, contexts), and each product of two."""
    inputs = [action, *context]
    terms = [np.ones_like(action), *inputs]
    terms += [inputs[i] * inputs[j] for i in range(len(inputs)) for j in range(i, len(inputs))]
    return np.asarray(action[..., None] * np.stack(terms, axis=-1))


@dataclass(frozen=True)
class LookingPilot:
    """What the first saccades found; a `babbling.loop.Babbler`."""

    retina: Retina
    reach: Reach
    efference: Efference
    line: FloatArray
    """(F, 15) the efference copy: least squares of the pilot on `copy_terms`, pixels."""
    outcome: Axis
    fingerprint: str
    minutes: float

    @property
    def reading(self) -> Looking:
        """How saccades are read."""
        return Looking(self.retina, self.efference, self.line)

    @property
    def factors(self) -> tuple[str, ...]:
        """Labels: motor and image coordinate."""
        names = ("left u", "left v", "right u", "right v")[: self.retina.coordinates]
        return tuple(f"motor {m} moves {name}" for m in range(2) for name in names)

    def forward_model(self) -> ForwardModel:
        """An empty forward model on these axes."""
        reading = self.reading
        eye = 2 * (reading.coordinate // 2)
        half, other = self.retina.half, 1 - reading.motor
        u = Axis("u", "px", -half[eye], half[eye], GRID[0])
        v = Axis("v", "px", -half[eye + 1], half[eye + 1], GRID[1])
        margin = 0.02
        posture = Axis("other", "rad", self.reach.low[other] - margin, self.reach.high[other] + margin, GRID[2])
        largest = 1.02 * self.reach.largest[reading.motor] + margin
        action = Axis("action", "rad", -largest, largest, GRID[3])
        return ForwardModel(
            (u, v, posture),
            action,
            self.outcome,
            factors=self.factors,
            prior_strength=PRIOR_STRENGTH,
            provenance={"body": self.fingerprint},
        )

    def stream(self, body: Body, rng: np.random.Generator) -> Iterator[FloatArray]:
        """Saccades of one motor at a time, from where the last one went."""
        yield from saccades(self.reach, self.efference, body.copies, rng)


def saccades(
    reach: Reach, efference: Efference, copies: int, rng: np.random.Generator, *, together: bool = False
) -> Iterator[FloatArray]:
    """Random saccades: (B, 2) commands, one motor at a time or both `together`, changes uniform up to the largest."""
    posture = np.broadcast_to((reach.low + reach.high) / 2, (copies, 2)).copy()
    while True:
        change = reach.largest * (2 * rng.random((copies, 2)) - 1)
        if not together:
            change[np.arange(copies), rng.integers(0, 2, copies)] = 0.0
        goal = posture + change
        beyond = (goal < reach.low) | (goal > reach.high)
        posture = np.clip(np.where(beyond, posture - change, goal), reach.low, reach.high)
        yield efference.motors(posture)


def pilot_looking(body: Body, reach: Reach, seed: int) -> LookingPilot:
    """The first saccades: which motor moves which posture sense, the efference copy's line, the outcome axis.

    Raises:
        BabblingError: a motor that moves nothing that is felt, or nothing to look at.
    """
    retina = Retina.of(body)
    middle, half = (body.motor_high + body.motor_low) / 2, (body.motor_high - body.motor_low) / 2
    rng = np.random.default_rng([seed, 1])
    tries = [middle + 0.1 * half * (2 * rng.random((body.copies, 2)) - 1) for _ in range(6)]
    motors, senses = explore(body, iter(tries), len(tries))
    efference = _find_efference(motors.reshape(-1, 2), senses[1:].reshape(-1, senses.shape[-1])[:, : retina.first])
    stream = saccades(reach, efference, body.copies, np.random.default_rng([seed, 2]))
    before, motors, after = flat(*explore(body, stream, PILOT_TICKS))
    factors = 2 * retina.coordinates
    bare = Looking(retina, efference, np.zeros((factors, COPY_TERMS)))
    seen = bare.transitions(before, motors, after)
    line, reach_px = np.zeros((factors, COPY_TERMS)), np.zeros(factors)
    for f in range(factors):
        there = np.isfinite(seen.outcome[:, f]) & np.isfinite(seen.context[0][:, f])
        if there.sum() < LEAST_SIGHTINGS:
            raise BabblingError(
                f"only {int(there.sum())} sightings before and after a saccade of motor {bare.motor[f]}: there is too "
                "little to look at; put coloured things in view"
            )
        context = (c[there, f] / scale for c, scale in zip(seen.context, bare.scale[1:], strict=True))
        x, y = copy_terms(seen.action[there, f], *context), seen.outcome[there, f]
        line[f] = np.linalg.lstsq(x, y, rcond=None)[0]
        reach_px[f] = MARGIN * np.quantile(np.abs(y - x @ line[f]), QUANTILE) + 0.5
    outcome = Axis("outcome", "px", -reach_px, reach_px, GRID[4])
    ticks = len(tries) + PILOT_TICKS
    return LookingPilot(
        retina, reach, efference, line, outcome, body.fingerprint, ticks * body.tick_s * body.copies / 60
    )


def _find_efference(motors: FloatArray, felt: FloatArray) -> Efference:
    """Which felt posture follows which motor, and along what line."""
    count = motors.shape[1]
    with np.errstate(invalid="ignore", divide="ignore"):
        together = np.abs(np.corrcoef(motors.T, felt.T)[:count, count:])
    posture = np.nan_to_num(together).argmax(1)
    offset, slope = np.zeros(count), np.zeros(count)
    for m in range(count):
        if not np.nan_to_num(together[m, posture[m]]) > 0.5:
            raise BabblingError(f"motor {m} moves nothing that is felt")
        slope[m], offset[m] = np.polyfit(motors[:, m], felt[:, posture[m]], 1)
    return Efference(posture, offset, slope)
