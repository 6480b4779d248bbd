"""One movement, tried again and again by all copies of a body: what whoever learns by reward is told, does and gets."""

from collections.abc import Callable

import numpy as np

from babbling.axes import FloatArray
from imitation.acting.movement import approach
from models.risk import WatchedBody

AHEAD = 3
"""Sub-goals that are told, from the next on."""
PER_TICK, SHORT, SUMMED = 0.02, 0.02, 0.2
"""What counts as one: rad of a sub-goal's way in a tick, of what was missed just now, and of what was missed in all."""


class Trials:
    """A trial begins at rest, goes into the movement as the imitator does (`imitation.acting.movement.approach`) and
    ends with it. At tick t the body is told joint angles, and rewarded by minus the mean squared difference of what its
    angle senses then read from sub-goal t + 1, degrees squared (mm of slides).

    Args:
        body: whose copies all try at once.
        angles: (T, J) the movement.
    """

    def __init__(self, body: WatchedBody, angles: FloatArray) -> None:
        self.body, inner = body, body.body
        body.reset()
        way = approach(inner.joint_angles[0], angles, inner.tick_s, *inner.joint_range.T)
        self.begins, self.steps = len(way), len(way) + len(angles) - 1
        beyond = angles[-1] + np.arange(1, AHEAD + 1)[:, None] * (angles[-1] - angles[-2])
        self.goals = np.concatenate([way, angles, beyond])
        self.scale = inner.shown_scale
        self.reset()

    def reset(self) -> None:
        """A new trial."""
        self.tick, self.summed = 0, np.zeros((self.body.copies, self.goals.shape[1]))
        self._feel(self.body.reset())

    def step(self, told: FloatArray) -> FloatArray:
        """Tell (B, J) joint angles; returns (B, J) what was missed of the next sub-goals, degrees (mm)."""
        self.tick += 1
        self._feel(self.body.act(self.body.body.command_angles(told)))
        return np.asarray(-self.short * self.scale)

    def _feel(self, felt: FloatArray) -> None:
        """`angles` and `short` (B, J): posture felt, and what is short of the present sub-goal; `summed` over ticks."""
        self.felt, self.angles = felt, self.body.body.senses.read(felt, "angle")
        self.short = self.goals[self.tick] - self.angles
        self.summed = self.summed + self.short

    @property
    def over(self) -> bool:
        """Whether the movement came to its end."""
        return self.tick == self.steps

    @property
    def ahead(self) -> FloatArray:
        """(AHEAD, J) next sub-goals."""
        return self.goals[self.tick + 1 : self.tick + 1 + AHEAD]

    def observation(self) -> FloatArray:
        """(B, O) everything felt, within its ranges; the next sub-goals from here and from one to the other; what was
        missed now and in all; the tick."""
        low, high = self.body.sense_low, self.body.sense_high
        felt = (2 * self.felt - low - high) / (high - low)
        onward = np.diff(self.ahead, axis=0).reshape(1, -1) / PER_TICK
        own = self.ahead[0] - self.angles, self.short
        rows = [felt, own[0] / PER_TICK, own[1] / SHORT, self.summed / SUMMED]
        shared = np.concatenate([onward, [[2 * self.tick / self.steps - 1]]], 1)
        return np.concatenate([*rows, np.repeat(shared, self.body.copies, axis=0)], 1)


def reward(missed: FloatArray) -> FloatArray:
    """(B,) of (B, J) misses."""
    return np.asarray(-(missed**2).mean(-1))


Policy = Callable[[Trials], FloatArray]
"""(B, J) joint angles to be told now."""


def replaying(trials: Trials) -> FloatArray:
    """Direct replay: the next sub-goal."""
    return np.repeat(trials.ahead[:1], trials.body.copies, axis=0)


def tried(trials: Trials, policy: Policy) -> tuple[FloatArray, FloatArray]:
    """A whole trial: (N, B, J) misses of every step, and (T, B, J) true joint angles at the movement's T sub-goals."""
    trials.reset()
    missed, true = [], [trials.body.body.joint_angles.copy()]
    while not trials.over:
        missed.append(trials.step(policy(trials)))
        true.append(trials.body.body.joint_angles.copy())
    return np.array(missed), np.array(true[trials.begins :])


def off(trials: Trials, policy: Policy) -> float:
    """Root mean square of what true joint angles miss of the movement in a trial, degrees (mm)."""
    _, true = tried(trials, policy)
    wanted = trials.goals[trials.begins : trials.begins + len(true), None]
    return float(np.sqrt(np.mean(((true - wanted) * trials.scale) ** 2)))
