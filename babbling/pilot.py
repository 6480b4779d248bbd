"""The pilot: a short first babble that fixes, for good, everything the tables need before counting can start.

Rest, move slowly over everything, babble a little. Found in that order: the noise of the senses, the body schema, the
useful range of each motor, how the body coasts, the axes, and a linear-Gaussian account of posture and rate for the
state estimate. A mind starts from two ranges (motors, senses) and a tick; it asks nothing else of its body.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import repeat
from typing import Annotated

import numpy as np

from babbling.axes import Axis, FloatArray
from babbling.body import Body
from babbling.dynamics import LinearDynamics, fit_dynamics
from babbling.errors import BabblingError
from babbling.exploration import MotorRange, smooth
from babbling.forward_model import ForwardModel
from babbling.kinds import Numbers
from babbling.loop import Transitions, explore, flat
from babbling.schema import BodySchema, find_schema

GRID = (15, 91, 91)
"""Grid points of rate, action and outcome. With coasting taken out, rate matters little and needs few; action and
outcome need as many as each other, so that one step of the one moves about one step of the other."""
MARGIN, QUANTILE = 1.6, 0.9995
"""Axes reach this many times the pilot's quantile: a fast movement must not fall off."""
PRIOR_STRENGTH = 20.0
"""Pseudo-counts of the linear-Gaussian prior."""
JITTER = 0.0105
"""Command noise while babbling, rad: about 0.6 degrees, so that actions vary at every speed."""
SETTLE_S, REST_S, WIRING_S, PILOT_S = 1.0, 1.0, 8.0, 5.0
ENDS = 0.05
"""Share of a posture's range that babbling leaves free at either end."""


@dataclass(frozen=True)
class Pilot:
    """What the pilot found; a `babbling.loop.Babbler`."""

    schema: BodySchema
    motors: MotorRange
    low: Annotated[FloatArray, Numbers("motor", "rad")]
    """(F,) least posture to ask for: that of the least command, where the posture sense does not end before."""
    high: Annotated[FloatArray, Numbers("motor", "rad")]
    """(F,) greatest posture to ask for."""
    dynamics: LinearDynamics
    rate: Annotated[Axis, Numbers("motor")]
    action: Annotated[Axis, Numbers("motor")]
    outcome: Annotated[Axis, Numbers("motor")]
    minutes: Annotated[float, Numbers(unit="min", low=0, high=1e6)]
    """Body time the pilot took."""

    def transitions(self, before: FloatArray, motors: FloatArray, after: FloatArray) -> Transitions:
        """How far beyond coasting did the posture come, given its speed and how far it was told to go; see `beyond`."""
        return beyond(self.schema, self.dynamics, before, motors, after)

    def forward_model(self) -> ForwardModel:
        """An empty forward model on these axes, one factor per motor."""
        labels = tuple(f"motor {f}" for f in range(self.rate.factors))
        return ForwardModel((self.rate,), self.action, self.outcome, factors=labels, prior_strength=PRIOR_STRENGTH)

    def stream(self, body: Body, rng: np.random.Generator) -> Iterator[FloatArray]:
        """Smooth movements over the useful range."""
        return smooth(self.motors, body.copies, body.tick_s, rng)


def pilot(body: Body, seed: int) -> Pilot:
    """Find out what there is to move and to feel.

    Raises:
        BabblingError: a motor that moves nothing that is felt.
    """
    tick = body.tick_s
    middle, half = (body.motor_low + body.motor_high) / 2, (body.motor_high - body.motor_low) / 2
    everything = MotorRange(body.motor_low, body.motor_high, middle, half / 2, 0 * half)
    schema, _ = wire(body, smooth(everything, body.copies, tick, np.random.default_rng([seed, 1])))
    if not len(schema.rate):
        raise BabblingError(
            f"{len(body.motor_low)} motors but only {len(body.sense_low)} senses: each motor needs one that says where "
            "it is and one that says how fast it moves"
        )
    span = motor_range(schema, body)
    ends = np.sort(schema.efference(np.stack([body.motor_low, body.motor_high])), axis=0)
    low = np.maximum(ends[0], body.sense_low[schema.posture])
    high = np.minimum(ends[1], body.sense_high[schema.posture])
    stream = smooth(span, body.copies, tick, np.random.default_rng([seed, 2]))
    motors, senses = explore(body, stream, round(PILOT_S / tick))
    dynamics = fit_dynamics(schema, motors, senses)
    seen = beyond(schema, dynamics, *flat(motors, senses))
    rate = symmetric("rate", "rad/s", seen.context[0], GRID[0])
    action = symmetric("action", "rad", seen.action, GRID[1])
    outcome = symmetric("outcome", "rad", seen.outcome, GRID[2])
    minutes = (SETTLE_S + REST_S + WIRING_S + PILOT_S) * body.copies / 60
    return Pilot(schema, span, low, high, dynamics, rate, action, outcome, minutes)


def beyond(
    schema: BodySchema, dynamics: LinearDynamics, before: FloatArray, motors: FloatArray, after: FloatArray
) -> Transitions:
    """A servo's own view of (N, S) sensations, (N, M) commands and what they led to.

    Law, per factor with posture q, rate v, commanded posture c:
    context v, action a = c - q, outcome w = q' - q - k v: the displacement beyond coasting, where k is how far a body
    moving at unit rate drifts in one tick when it is told to stay (a servo brakes: k is well below the tick).
    """
    q, v = before[:, schema.posture], before[:, schema.rate]
    return Transitions((v,), schema.efference(motors) - q, after[:, schema.posture] - q - v * dynamics.coasting)


def wire(body: Body, stream: Iterator[FloatArray], lines: slice = slice(None)) -> tuple[BodySchema, int]:
    """Rest, then send a stream of commands: what moves what among these senses; and how many ticks it took.

    Raises:
        BabblingError: a motor that moves nothing that is felt.
    """
    rest, moving, settled = (round(s / body.tick_s) for s in (SETTLE_S + REST_S, WIRING_S, SETTLE_S))
    middle = np.tile((body.motor_low + body.motor_high) / 2, (body.copies, 1))
    _, resting = explore(body, repeat(middle), rest)
    motors, senses = explore(body, stream, moving)
    low, high = body.sense_low[lines], body.sense_high[lines]
    felt, still = senses[settled + 1 :, :, lines], resting[settled:, :, lines]
    return find_schema(motors[settled:], felt, still, low, high, body.tick_s), rest + moving


def motor_range(schema: BodySchema, body: Body) -> MotorRange:
    """Commands whose postures lie within the posture senses' ranges, a little away from their ends."""
    low, high = body.sense_low[schema.posture], body.sense_high[schema.posture]
    ends = np.stack([schema.motors(low + ENDS * (high - low)), schema.motors(high - ENDS * (high - low))])
    per_unit = np.abs(schema.slope)
    return MotorRange(
        low=np.maximum(ends.min(0), body.motor_low),
        high=np.minimum(ends.max(0), body.motor_high),
        rest=schema.motors(body.reset()[:, schema.posture].mean(0)),
        speed=body.sense_high[schema.rate] / per_unit,
        jitter=JITTER / per_unit,
    )


def symmetric(
    name: str,
    unit: str,
    values: FloatArray,
    size: int,
    margin: float = MARGIN,
    quantile: float = QUANTILE,
    more: float = 0.0,
) -> Axis:
    """An axis about 0 that reaches `margin` times this quantile of |(N, F) values|, NaN left out, and `more`."""
    reach = margin * np.nanquantile(np.abs(values), quantile, axis=0) + more
    return Axis(name, unit, -reach, reach, size)
