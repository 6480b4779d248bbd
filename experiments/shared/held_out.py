"""Babbling that is held out: how well the forward model foretells it while more and more is learned."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from babbling import kalman
from babbling.axes import FloatArray
from babbling.belief import StateEstimate
from babbling.body import Body
from babbling.explanations import Explanations
from babbling.loop import explore
from babbling.pilot import Pilot
from experiments.shared.judging import LearningCurve
from models.body import SimulatedBody
from models.units import SHOWN

STREAM, TICKS = 7919, 500
PILOT = (0.1, 0.2, 0.4, 0.7)
"""Shares of what the pilot counted at which there are points."""
FURTHER = 1.15
"""Within a bout there is a point as soon as this many times as much was lived as at the last."""


class HeldOut:
    """Points of a `LearningCurve`, degrees of posture, or millimetres of a body that only slides (root mean square over
    factors and transitions).

    Its floor is what the simulator itself would miss, told the state as it truly is: what is believed of the next
    posture also depends on what its senses will add of their own, noise and the pulses they count in.

    Args:
        body: another set of copies of whoever babbles.
        found: what the pilot found.
        seed: randomness.
        points: what was noted before.
    """

    def __init__(self, body: SimulatedBody, found: Pilot, seed: int, points: Iterable[Iterable[float]] = ()) -> None:
        units = dict(zip(body.joints, body.shown_units, strict=True))
        moved = [units.get(body.sense_labels[line], "deg") for line in found.schema.posture]
        self.unit = "deg" if "deg" in moved else moved[0]  # slides are judged where there is nothing else
        self.counted, self.scale = np.array(moved) == self.unit, dict(SHOWN.values())[self.unit]
        self.tick_s, self.piloted, truth = body.tick_s, found.minutes, list[FloatArray]()

        def watched() -> Iterator[FloatArray]:
            for command in found.stream(body, np.random.default_rng([seed + STREAM, 3, 0])):
                truth.append(body.truth)
                yield command

        motors, senses = explore(body, watched(), TICKS)
        self.columns, self.outcome = found.experienced(motors, senses)
        added = senses[1:] - [*truth[1:], body.truth]
        self.floor = self._error(unforeseen(found, added))
        self.points = [tuple(map(float, point)) for point in points]

    def _error(self, missed: FloatArray) -> float:
        return float(self.scale * np.sqrt(np.mean(missed[..., self.counted] ** 2)))

    def note(self, minutes: float, model: Explanations, within: bool = False) -> None:
        """Add a point for the forward model as it is now; `within` a bout only where there is something new."""
        last = self.points[-1][0] if self.points else 0.0
        if minutes <= last or (within and minutes < FURTHER * last):
            return
        told = model.foretold_by(self.columns)
        average = (told * model.weights).sum(-1)
        self.points.append((minutes, *(self._error(said - self.outcome) for said in (average, told[..., 0]))))

    def note_pilot(self, motors: FloatArray, senses: FloatArray, found: Pilot) -> None:
        """Points within what the pilot counted, (T, B, M) and (T + 1, B, S): for a forward model that learned from so
        much of it, on the axes that all of it found."""
        columns, outcome = found.experienced(motors, senses)
        model, ends = found.forward_model(), [0, *(round(share * len(outcome)) for share in PILOT)]
        for start, end in pairwise(ends):
            model.observe(columns[start:end], outcome[start:end], foretell=False)
            if end > found.frame.reach.shape[1] + 1:  # else the richest line has more weights than were lived
                self.note(found.minutes - (len(outcome) - end) * self.tick_s / 60, model)

    def curve(self) -> LearningCurve:
        """So far."""
        minutes, table, line = np.array(self.points).T
        return LearningCurve(minutes, table, line, self.unit, self.floor, self.piloted)


def unforeseen(found: Pilot, added: FloatArray) -> FloatArray:
    """(T, B, F) how far the believed posture at each tick is shifted by what its senses (T, B, S) added at that very
    tick: the filter's gain times that, which nothing before could tell."""
    estimate = StateEstimate(found.schema, found.dynamics)
    posture, rate = added[..., found.schema.posture], added[..., found.schema.rate]
    belief, gains = estimate.start(0 * posture[0], 0 * rate[0]), list[FloatArray]()
    for _ in added:  # covariances, and so gains, do not depend on what is felt
        belief, gain = kalman.update(estimate.system, kalman.predict(estimate.system, belief), 0 * belief.mean[..., :2])
        gains.append(gain[..., 0, :])
    shift = np.stack(gains)[:, None]
    return np.asarray(shift[..., 0] * posture + shift[..., 1] * rate)


@dataclass(frozen=True)
class Watched:
    """A pilot whose learning is looked at block by block, and goes on as if it were not."""

    found: Pilot
    look: Callable[[], None]

    def learn(self, model: Explanations, motors: FloatArray, senses: FloatArray) -> None:
        """See `Pilot.learn`."""
        model.observe(*self.found.experienced(motors, senses), after_block=self.look)

    def forward_model(self) -> Explanations:
        """See `Pilot.forward_model`."""
        return self.found.forward_model()

    def stream(self, body: Body, rng: np.random.Generator) -> Iterator[FloatArray]:
        """See `Pilot.stream`."""
        return self.found.stream(body, rng)
