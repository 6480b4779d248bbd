"""The pilot: a short first babble that fixes, for good, everything the tables need before counting can start.

Rest, move slowly over everything, babble a little. Found in that order: the noise of the senses, the body schema, the
useful range of each motor, how the body coasts, the axes, and a linear-Gaussian account of posture and rate for the
state estimate. A mind starts from two ranges (motors, senses) and a tick; it asks nothing else of its body.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import repeat
from typing import Annotated

import numpy as np

from babbling.axes import Axis, FloatArray
from babbling.belief import StateEstimate
from babbling.body import Body
from babbling.dynamics import LinearDynamics, fit_dynamics
from babbling.errors import BabblingError
from babbling.explanations import Explanations
from babbling.exploration import MotorRange, in_turn, smooth
from babbling.features import HINGES, SLOW, WIDTHS, ZONES, Features
from babbling.frame import MARGIN, QUANTILE, Frame, shares
from babbling.kinds import Numbers
from babbling.loop import explore
from babbling.schema import BodySchema, Told, Unfelt, find_schema, one_by_one, together

JITTER, JITTER_SHARE = 0.0105, 1 / 80
"""Command noise while babbling, so that actions vary at every speed: rad, about 0.6 degrees, but no more than this
share of a posture's range (a finger's 4 cm)."""
SETTLE_S, REST_S, WIRING_S, PILOT_S = 1.0, 1.0, 8.0, 7.5
PER_MOTOR_S, AT_ONCE_S = 2.0, 50.0
"""Body time of wiring, for each motor and in all, from which all may move at once; below it they move in turn."""
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
    ends: Annotated[FloatArray, Numbers("motor end:2", "rad")]
    """(F, 2) postures that the least and the greatest command ask for: what pushes back may take more than its own."""
    dynamics: LinearDynamics
    frame: Frame
    minutes: Annotated[float, Numbers(unit="min", low=0, high=1e6)]
    """Body time the pilot took."""
    fingerprint: str
    """Of its body."""

    @property
    def counted_minutes(self) -> float:
        """Body time of it that `begin`'s forward model learned from."""
        return self.minutes * PILOT_S / (SETTLE_S + REST_S + WIRING_S + PILOT_S)

    def experienced(self, motors: FloatArray, senses: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(N, F, COLUMNS + 2 F) features and (N, F) outcomes of a run from rest, in the order in which they happened.

        Law, per factor with posture q, rate v, commanded posture c: outcome w = q' - q - k v, the displacement beyond
        coasting, where k is how far a body moving at unit rate drifts in one tick when it is told to stay (a servo
        brakes: k is well below the tick). Postures and rates are the believed ones, as they are when one acts: noise
        that is felt stands in q, c - q and w alike and would pass for a law of the body.
        """
        return _experienced(self.frame.features, self.dynamics, *self.believed(motors, senses))

    def believed(self, motors: FloatArray, senses: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(T + 1, B, F, 3) believed posture, rate and bias of a run from rest, and its (T, B, F) commanded postures."""
        return _believed(self.schema, self.dynamics, motors, senses)

    def learn(self, model: Explanations, motors: FloatArray, senses: FloatArray) -> None:
        """Foretell and count a run."""
        model.observe(*self.experienced(motors, senses))

    def forward_model(self) -> Explanations:
        """Empty, one factor per motor."""
        return Explanations.empty(self.frame, self.fingerprint)

    def stream(self, body: Body, rng: np.random.Generator) -> Iterator[FloatArray]:
        """Smooth movements over the useful range."""
        return smooth(self.motors, body.copies, body.tick_s, rng)


def pilot_minutes(copies: int) -> float:
    """Body time that the pilot of so many copies takes."""
    return (SETTLE_S + REST_S + WIRING_S + PILOT_S) * copies / 60


def pilot(body: Body, seed: int) -> Pilot:
    """Find out what there is to move and to feel.

    Raises:
        BabblingError: a motor that moves nothing that is felt.
    """
    return begin(body, seed)[0]


def begin(
    body: Body, seed: int, heed: Callable[[FloatArray, FloatArray], object] = lambda motors, senses: None
) -> tuple[Pilot, Explanations]:
    """`pilot`, and a forward model that has already learned from what the pilot lived through; `heed` is told it, as
    (T, B, M) commands and (T + 1, B, S) sensations.

    Raises:
        BabblingError: a motor that moves nothing that is felt.
    """
    tick = body.tick_s
    middle, half = (body.motor_low + body.motor_high) / 2, (body.motor_high - body.motor_low) / 2
    everything = MotorRange(body.motor_low, body.motor_high, middle, half / 2, 0 * half)
    schema, wired = _wired(body, everything, seed)
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
    heed(motors, senses)
    dynamics = fit_dynamics(schema, motors, senses)
    run = _believed(schema, dynamics, motors, senses)
    scale = np.abs(schema.slope)[:, None]
    # lines bend where one has been on both sides
    inner = np.quantile(senses[..., schema.posture], np.linspace(0.05, 0.95, HINGES), axis=(0, 1))
    speed = span.speed[:, None] * scale
    jitter, all_direct = span.jitter[:, None] * scale, np.eye(1, len(WIDTHS))
    features = Features(
        inner.T,
        np.array(SLOW) * speed,
        np.array(WIDTHS) * jitter,
        np.array(ZONES) * jitter,
        np.repeat(all_direct, len(low), axis=0),
    )
    seen = _experienced(features, dynamics, *run)
    features = replace(features, share=shares(*seen))
    seen = _experienced(features, dynamics, *run)
    minutes = (wired * tick + PILOT_S) * body.copies / 60
    frame = Frame.found(features, *seen)
    found = Pilot(schema, span, low, high, ends.T, dynamics, frame, minutes, body.fingerprint)
    model = found.forward_model()
    model.observe(*seen, foretell=False)  # the frame has seen it already
    return found, model


def _wired(body: Body, everything: MotorRange, seed: int) -> tuple[BodySchema, int]:
    """What moves what, and the ticks it took: all motors at once, where time and luck are enough to tell them apart;
    otherwise one at a time."""
    count, copies, tick, spent = len(everything.low), body.copies, body.tick_s, 0
    if WIRING_S * copies >= max(PER_MOTOR_S * count, AT_ONCE_S):
        try:
            return wire(body, smooth(everything, copies, tick, np.random.default_rng([seed, 1])))
        except Unfelt:
            spent = round((SETTLE_S + REST_S + WIRING_S) / tick)
    slot = min((WIRING_S - SETTLE_S) / count, PER_MOTOR_S / 2)  # all get their turn, however many they are
    turns = in_turn(everything, copies, tick, np.random.default_rng([seed, 1]), slot, SETTLE_S)
    schema, wired = wire(body, turns, told=one_by_one)
    return schema, spent + wired


def _believed(
    schema: BodySchema, dynamics: LinearDynamics, motors: FloatArray, senses: FloatArray
) -> tuple[FloatArray, FloatArray]:
    estimate, told = StateEstimate(schema, dynamics), schema.efference(motors)
    posture, rate = senses[..., schema.posture], senses[..., schema.rate]
    belief = estimate.start(posture[0], rate[0])
    means = [belief.mean]
    for command, q, v in zip(told, posture[1:], rate[1:], strict=True):
        belief = estimate.correct(estimate.predict(belief, command), q, v)
        means.append(belief.mean)
    return np.stack(means), told


def _experienced(
    features: Features, dynamics: LinearDynamics, believed: FloatArray, told: FloatArray
) -> tuple[FloatArray, FloatArray]:
    q, v = believed[..., 0], believed[:-1, ..., 1]
    columns = features.of(q[:-1], v, told)
    outcome = q[1:] - q[:-1] - v * dynamics.coasting
    return columns.reshape(-1, *columns.shape[2:]), outcome.reshape(-1, outcome.shape[-1])


def wire(
    body: Body, stream: Iterator[FloatArray], lines: slice = slice(None), told: Told = together
) -> tuple[BodySchema, int]:
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
    return find_schema(motors[settled:], felt, still, low, high, body.tick_s, told), rest + moving


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
        jitter=np.minimum(JITTER, JITTER_SHARE * (high - low)) / per_unit,
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
