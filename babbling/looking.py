"""Oculomotor babbling (chapter, section 3.4): what a saccade does to what is seen.

P(s_{t+1} | s_t, a_t) of a head whose states are the feedback of its motors and the positions of features on its
retinas. One factor for every motor and image coordinate; a thing at (u, v) is moved by a saccade of one motor, and how
far depends on where it was and, for a motor that others carry about, on the others' postures:

    context (u, v, postures of the other motors), action = commanded change of posture, rad,
    outcome = displacement on the image that the efference copy did not foresee, pixels.

The efference copy's account is least squares on the pilot's saccades: displacement = action times a quadratic of action
and contexts (nothing moves when nothing is done). The table learns what that misses, and how surely it is known; with
displacements themselves as outcomes a table of this size needs ten times the babbling, since the few visits of a row
lie anywhere in its cell. Saccades of several motors are chained, one after the other: P(s'' | s, a_1, a_2) = sum
over s' of P(s'' | s', a_2) P(s' | s, a_1), taken at the mean of s'.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import count
from typing import Annotated

import numpy as np
from scipy.optimize import linear_sum_assignment

from babbling.axes import Axis, FloatArray, IntArray, same_axes
from babbling.body import Body
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel
from babbling.kinds import Numbers, kind
from babbling.loop import Transitions, explore, flat
from babbling.pilot import symmetric, wire
from babbling.regression import LinearFit, regress
from babbling.retina import Retina
from babbling.schema import BodySchema

GRID = (9, 7, 5, 13, 41)
"""Grid points of u, v, each other motor's posture, action and outcome."""
PRIOR_STRENGTH = 0.3
"""Pseudo-counts of the linear-Gaussian prior: visits are spread over 16 neighbouring cells and there are many cells."""
MARGIN, QUANTILE = 1.5, 0.998
"""The outcome axis reaches this many times the pilot's quantile, and half a pixel."""
STILL = 0.004
"""rad: a motor told to move less than this was not moved (a quarter of a degree; encoders and servos are not finer)."""
SMALL = 0.1
"""Share of the motors' range, about its middle, in which the wiring is found: small saccades arrive in their tick."""
PILOT_TICKS = 40
LEAST_SIGHTINGS = 60


@dataclass(frozen=True)
class Reach:
    """Which saccades are babbled."""

    low: Annotated[FloatArray, Numbers("motor", "rad")]
    """(M,) least posture, rad."""
    high: Annotated[FloatArray, Numbers("motor", "rad")]
    """(M,) greatest posture, rad."""
    largest: Annotated[FloatArray, Numbers("motor", "rad", low=0)]
    """(M,) largest change of posture in one saccade, rad."""


def copy_terms(action: FloatArray, *context: FloatArray) -> FloatArray:
    """(..., T) terms of the efference copy: action times 1, each of (action, contexts), and each product of two."""
    inputs = [action, *context]
    terms = [np.ones_like(action), *inputs]
    terms += [inputs[i] * inputs[j] for i in range(len(inputs)) for j in range(i, len(inputs))]
    return np.asarray(action[..., None] * np.stack(terms, axis=-1))


@dataclass(frozen=True)
class LookingPilot:
    """What the first saccades found; a `babbling.loop.Babbler`."""

    retina: Retina
    reach: Reach
    schema: BodySchema
    line: Annotated[FloatArray, Numbers("factor term")]
    """(F, T) the efference copy: least squares of the pilot on `copy_terms`, pixels."""
    outcome: Annotated[Axis, Numbers("factor")]
    fingerprint: str
    minutes: Annotated[float, Numbers(unit="min", low=0, high=1e6)]

    def __post_init__(self) -> None:
        first, coordinates, centre, _ = self.retina
        if coordinates not in (2, 4) or len(centre) != coordinates or not (self.schema.posture < first).all():
            raise BabblingError("one or two eyes, and motors that are felt before them, are needed; babble anew")

    @property
    def movers(self) -> IntArray:
        """(2,) motor that carries things along u, and the one that does along v, by the efference copy of one eye."""
        per_rad = self.line[:, 0].reshape(-1, self.retina.coordinates)[:, :2]
        return np.asarray(linear_sum_assignment(-np.abs(per_rad.T))[1])

    def posture(self, senses: FloatArray) -> FloatArray:
        """(..., S) senses to the postures (..., M), motor by motor."""
        return senses[..., self.schema.posture]

    @property
    def motor(self) -> IntArray:
        """(F,) motor of each factor."""
        return np.repeat(np.arange(len(self.reach.low)), self.retina.coordinates)

    @property
    def coordinate(self) -> IntArray:
        """(F,) image coordinate of each factor."""
        return np.tile(np.arange(self.retina.coordinates), len(self.reach.low))

    @property
    def others(self) -> IntArray:
        """(F, M - 1) the other motors of each factor."""
        every = np.arange(len(self.reach.low))
        return np.array([every[every != motor] for motor in self.motor])

    def learn(self, model: ForwardModel, motors: FloatArray, senses: FloatArray) -> None:
        """Count a run."""
        model.observe(*self.transitions(*flat(motors, senses)))

    def transitions(self, before: FloatArray, motors: FloatArray, after: FloatArray) -> Transitions:
        """(N, S), (N, M), (N, S) to N * K rows: one for each kind of thing."""
        was, now = self.retina.things(before), self.retina.things(after)
        posture = self.posture(before)
        change = self.schema.efference(motors) - posture
        context, action = self.situate(was, posture[:, None], change[:, None])
        alone = np.all(np.abs(change[:, self.others]) < STILL, axis=-1)
        moved = now[..., self.coordinate] - was[..., self.coordinate] - self.straight(context, action)
        outcome = np.where(alone[:, None], moved, np.nan)
        *seen, action, outcome = (v.reshape(-1, len(self.motor)) for v in (*context, action, outcome))
        return Transitions(tuple(seen), action, outcome)

    def situate(
        self, things: FloatArray, posture: FloatArray, change: FloatArray
    ) -> tuple[tuple[FloatArray, ...], FloatArray]:
        """Contexts (u, v, other postures), actions, (..., F) each, of things (..., C), postures, changes (..., M)."""
        eye = 2 * (self.coordinate // 2)
        u, v = things[..., eye], things[..., eye + 1]
        carried = (np.broadcast_to(posture[..., other], u.shape) for other in self.others.T)
        return (u, v, *carried), np.broadcast_to(change[..., self.motor], u.shape)

    def terms(self, context: tuple[FloatArray, ...], action: FloatArray) -> FloatArray:
        """(..., T) `copy_terms`, image coordinates in halves of the image."""
        u, v = (value / half for value, half in zip(context, self.retina.half[:2], strict=False))
        return copy_terms(action, u, v, *context[2:])

    def straight(self, context: tuple[FloatArray, ...], action: FloatArray, factors: slice = slice(None)) -> FloatArray:
        """(..., F) displacement that the efference copy foresees; of these factors, if not of all."""
        return np.asarray(np.einsum("...t,...t->...", self.terms(context, action), self.line[factors]))

    def fit(self, seen: Transitions) -> LinearFit:
        """The efference copy that least squares makes of transitions that this one has read."""
        moved = seen.outcome + self.straight(seen.context, seen.action)
        return regress(self.terms(seen.context, seen.action), moved[..., None])

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Of the forward model: u, v and the other motors' postures, action, outcome."""
        eye, half, reach = 2 * (self.coordinate // 2), self.retina.half, self.reach
        u = Axis("u", "px", -half[eye], half[eye], GRID[0])
        v = Axis("v", "px", -half[eye + 1], half[eye + 1], GRID[1])
        margin = 0.02
        postures = (
            Axis(f"other{k or ''}", "rad", reach.low[other] - margin, reach.high[other] + margin, GRID[2])
            for k, other in enumerate(self.others.T)
        )
        largest = 1.02 * reach.largest[self.motor] + margin
        return (u, v, *postures, Axis("action", "rad", -largest, largest, GRID[3]), self.outcome)

    def forward_model(self) -> ForwardModel:
        """An empty forward model on these axes."""
        *contexts, action, outcome = self.axes
        sides = ("left u", "left v", "right u", "right v")
        labels = [f"motor {m} moves {sides[c]}" for m, c in zip(self.motor, self.coordinate, strict=True)]
        return ForwardModel(
            contexts, action, outcome, factors=labels, prior_strength=PRIOR_STRENGTH, fingerprint=self.fingerprint
        )

    def stream(self, body: Body, rng: np.random.Generator) -> Iterator[FloatArray]:
        """Saccades of one motor at a time, from where the last one went."""
        yield from saccades(self.reach, self.schema, body.copies, rng)


def saccades(
    reach: Reach, schema: BodySchema, copies: int, rng: np.random.Generator, *, together: bool = False
) -> Iterator[FloatArray]:
    """Random saccades: (B, M) commands, one motor at a time or all `together`, changes uniform up to the largest."""
    shape = (copies, len(reach.low))
    posture = np.broadcast_to((reach.low + reach.high) / 2, shape).copy()
    while True:
        change = reach.largest * (2 * rng.random(shape) - 1)
        if not together:
            mover = shape[1] - 1 - rng.integers(0, shape[1], copies)
            change[np.arange(shape[1]) != mover[:, None]] = 0.0
        goal = posture + change
        beyond = (goal < reach.low) | (goal > reach.high)
        posture = np.clip(np.where(beyond, posture - change, goal), reach.low, reach.high)
        yield schema.motors(posture)


def wire_eyes(body: Body, seed: int) -> tuple[BodySchema, int]:
    """Small saccades about the middle: which motor moves which posture sense, and how many ticks it took.

    Raises:
        BabblingError: a motor that moves nothing that is felt.
    """
    middle, half = (body.motor_high + body.motor_low) / 2, SMALL * (body.motor_high - body.motor_low) / 2
    rng = np.random.default_rng([seed, 1])
    about = (middle + half * (2 * rng.random((body.copies, len(half))) - 1) for _ in count())
    return wire(body, about, slice(len(middle)))


def pilot_looking(body: Body, reach: Reach, seed: int) -> LookingPilot:
    """The first saccades: which motor moves which posture sense, the efference copy's line, the outcome axis.

    Args:
        body: who looks.
        reach: which postures are to be babbled, by sense line; the pilot's is by motor.
        seed: randomness.

    Raises:
        BabblingError: a motor that moves nothing that is felt, or nothing to look at.
    """
    retina = Retina.of(body)
    schema, ticks = wire_eyes(body, seed)
    reach = Reach(*(bound[schema.posture] for bound in (reach.low, reach.high, reach.largest)))
    stream = saccades(reach, schema, body.copies, np.random.default_rng([seed, 2]))
    before, motors, after = flat(*explore(body, stream, PILOT_TICKS))
    minutes = (ticks + PILOT_TICKS) * body.tick_s * body.copies / 60
    nothing = np.zeros((len(reach.low) * retina.coordinates, 1))
    unknown = symmetric("outcome", "px", nothing.T, 2, more=1.0)
    bare = LookingPilot(retina, reach, schema, nothing, unknown, body.fingerprint, minutes)
    fit = bare.fit(bare.transitions(before, motors, after))
    least = int(fit.samples.argmin())
    if fit.samples[least] < LEAST_SIGHTINGS:
        raise BabblingError(
            f"only {fit.samples[least]} sightings before and after a saccade of motor {bare.motor[least]}: there is "
            "too little to look at; put coloured things in view"
        )
    found = replace(bare, line=fit.coefficients[:, 0])
    missed = found.transitions(before, motors, after).outcome
    return replace(found, outcome=symmetric("outcome", "px", missed, GRID[4], MARGIN, QUANTILE, 0.5))


@kind("eyes", "`imitate saccades` leaves such files")
@dataclass(frozen=True)
class LookingMind:
    """What oculomotor babbling leaves: pilot and forward model."""

    pilot: LookingPilot
    forward_model: Annotated[ForwardModel, Numbers("factor")]
    minutes: Annotated[float, Numbers(unit="min", low=0, high=1e6)]
    """Body time of the babbling, the pilot's not counted in."""

    def __post_init__(self) -> None:
        terms = copy_terms(*np.zeros((2 + len(self.pilot.reach.low), 1))).shape[-1]
        fits = same_axes(self.forward_model.axes, self.pilot.axes)
        if not fits or self.pilot.line.shape[-1] != terms:
            raise BabblingError("the forward model has other axes than its pilot found; babble anew")

    def expect(self, things: FloatArray, posture: FloatArray, change: FloatArray, *, table: bool = True) -> FloatArray:
        """(..., C) where things (..., C) will be after a saccade of all motors from (..., M) by (..., M), pixels.

        Chained: each motor at the new postures of those before it and the present ones of those after it. Without
        `table` the efference copy alone: the least-squares peer.
        """
        pilot = self.pilot
        here, place = np.asarray(things, float), np.asarray(posture, float).copy()
        for motor in range(place.shape[-1]):
            context, action = pilot.situate(here, place, np.asarray(change, float))
            moved = pilot.straight(context, action)
            if table:
                moved = moved + self.forward_model.expected(tuple(np.nan_to_num(c) for c in context), action)
            here = here + np.where(np.abs(change[..., motor, None]) > 0, moved[..., pilot.motor == motor], 0.0)
            place[..., motor] += change[..., motor]
        return here

    def check(self, body: Body) -> None:
        """Refuse to look with somebody else's head.

        Raises:
            BabblingError: another body, or other retinas.
        """
        if self.pilot.fingerprint != body.fingerprint:
            raise BabblingError(
                f"these eyes were learned by another body (fingerprint {self.pilot.fingerprint}, this body has "
                f"{body.fingerprint}); babble anew"
            )
        retina = Retina.of(body)
        if not (np.array_equal(retina.centre, self.pilot.retina.centre)):
            size = (2 * self.pilot.retina.half[:2] + 1).astype(int)
            raise BabblingError(
                f"these eyes were learned with retinas of {size[0]} x {size[1]} pixels, this body has others; "
                "babble anew or give the same size"
            )
