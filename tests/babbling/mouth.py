"""A face without physics, for laws of babbling in the dark: it obeys at once, lips that touch stop its tongue."""

import numpy as np

from babbling.dark import FaceMind, babble, learn
from babbling.relations import FORWARD, SHUT

FloatArray = np.ndarray
HIGH = np.array([0.49, 0.025, 0.6, 0.43, 0.0075, 0.004, 0.52, 0.35])
"""Greatest of each joint, rad or m; the least is 0, or as much the other way."""
ONE_WAY = np.array([1, 1, 0, 0, 1, 0, 0, 0], bool)
LOW = np.where(ONE_WAY, 0.0, -HIGH)
PARTED, MET = 0.02, 0.0065
"""At which the lips part and the tongue meets them."""
NOISE = np.array([3e-3, 1e-4, 3e-3, 3e-3, 1e-4, 1e-4, 3e-3, 3e-3])
YIELDS = 0.08
"""Of lips that are pushed."""


class Mouth:
    """A body: motors permuted, some backwards, gains of their own; joints follow along a bent line.

    Args:
        copies: how many.
        noise: share of `NOISE` that is felt.
        wiring: seed of which motor is whose; None is straight.
        weak: how much joints lack of what they are told.
        seed: of the noise.
    """

    tick_s = 0.3

    def __init__(self, copies: int = 1, noise: float = 0.0, wiring: int | None = 7, weak: float = 0.0, seed: int = 0):
        self.copies, self.noise, self.weak = copies, noise, weak
        self.fingerprint, plan = f"mouth {wiring}", np.random.default_rng(wiring)
        self.motor, self.gain, self.offset = np.arange(8), np.ones(8), np.zeros(8)
        if wiring is not None:
            self.motor = plan.permutation(8)
            self.gain = plan.choice([-1.0, 1.0], 8) * plan.uniform(1.3, 2.0, 8)
            self.offset = plan.uniform(-0.2, 0.2, 8)
        self.motor_low, self.motor_high = -np.ones(8), np.ones(8)
        self.sense_low, self.sense_high = np.r_[LOW, np.full(8, -5.0), np.zeros(5)], np.r_[HIGH, np.full(13, 5.0)]
        self.rng = np.random.default_rng(seed)

    def lines(self, shares: FloatArray) -> FloatArray:
        """(..., 8) motor lines that send joints to these shares of their way from the middle, -1 to 1."""
        lines = np.empty(np.shape(shares))
        lines[..., self.motor] = (shares - self.offset) / self.gain
        return lines

    @property
    def rest(self) -> FloatArray:
        return self.lines(np.where(ONE_WAY, -1.0, 0.0))

    @property
    def ends(self) -> FloatArray:
        """(2, M) least and greatest command of use."""
        return np.sort(np.stack([self.lines(np.full(8, -1.0)), self.lines(np.ones(8))]), axis=0)

    def reset(self) -> FloatArray:
        return self.act(np.tile(self.rest, (self.copies, 1)))

    def act(self, motors: FloatArray) -> FloatArray:
        x = np.clip(self.gain * motors[:, self.motor] + self.offset, -1, 1)
        joints = (LOW + HIGH) / 2 + (HIGH - LOW) / 2 * (0.7 * x + 0.3 * x**3)
        joints *= 1 - self.weak
        touching = joints[:, 0] < PARTED
        joints[:, 0] = np.maximum(joints[:, 0], PARTED)
        pushes = joints[:, 1] - MET - FORWARD * joints[:, 4]
        pushing = (joints[:, 0] < PARTED + SHUT) & (pushes > 0)
        joints[:, 4] += np.where(pushing, YIELDS * pushes, 0)
        joints[:, 1] = np.where(pushing, MET + FORWARD * joints[:, 4], joints[:, 1])
        touch = np.repeat([0.1 * touching + 0.3 * pushing, 0.5 * pushing], [4, 1], axis=0).T
        felt = joints + self.noise * NOISE * self.rng.standard_normal(joints.shape)
        return np.hstack([felt, np.zeros_like(felt), touch])


def grown(acts: int = 600, seed: int = 0, noise: float = 0.0, wiring: int | None = 7) -> FaceMind:
    """What so many acts leave of one mouth."""
    body = Mouth(1, noise, wiring)
    [mine] = babble(body, acts, body.rest, [np.random.default_rng(seed)])
    return learn(mine, body.fingerprint)
