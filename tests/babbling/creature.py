"""A creature without physics: two arms of two hinges on a waist, for laws of mirrors. It obeys at once."""

import numpy as np

from babbling.exploration import MotorRange
from babbling.schema import BodySchema

FloatArray = np.ndarray
PARTS = ("trunk", "left_upper", "left_fore", "right_upper", "right_fore")
MOVES = np.array([[1, 0, 0, 0, 0], [1, 1, 0, 0, 0], [1, 1, 1, 0, 0], [1, 0, 0, 1, 0], [1, 0, 0, 1, 1]], bool)


def about(axis: int, angle: FloatArray) -> FloatArray:
    """(N, 3, 3) rotations about x, y or z."""
    turn = np.zeros((len(angle), 3, 3))
    one, two = (axis + 1) % 3, (axis + 2) % 3
    turn[:, axis, axis] = 1
    turn[:, one, one] = turn[:, two, two] = np.cos(angle)
    turn[:, two, one], turn[:, one, two] = np.sin(angle), -np.sin(angle)
    return turn


def directions(q: FloatArray) -> FloatArray:
    """(N, P, 3) true directions at (N, 5) angles: waist about y, shoulders about x, elbows about z."""
    waist = about(1, q[:, 0])
    found = [waist[:, :, 2]]
    for upper, fore in ((1, 2), (3, 4)):
        arm = waist @ about(0, q[:, upper])
        found += [arm[:, :, 1], (arm @ about(2, q[:, fore]))[:, :, 1]]
    return np.stack(found, 1)


class Creature:
    """Body and mirror in one. Senses are the angles in the order `wiring`, and how fast they changed."""

    tick_s, fingerprint, parts = 0.02, "creature", PARTS

    def __init__(self, copies: int = 40, noise: float = 0.0, wiring: tuple[int, ...] = (0, 1, 2, 3, 4), seed: int = 0):
        self.copies, self.noise = copies, noise
        self.wiring = np.array(wiring)
        self.motor_low, self.motor_high = -np.ones(5), np.ones(5)
        self.sense_high = np.repeat([1.5, 3.0 / self.tick_s], 5)
        self.sense_low = -self.sense_high
        self.angles, self.before = np.zeros((2, copies, 5))
        self.rng = np.random.default_rng(seed)

    def reset(self) -> FloatArray:
        self.angles, self.before = np.zeros((2, self.copies, 5))
        return self.feel()

    def act(self, motors: FloatArray) -> FloatArray:
        self.before = self.angles.copy()
        self.angles[:, self.wiring] = np.clip(1.5 * motors, -1.5, 1.5)
        return self.feel()

    def feel(self) -> FloatArray:
        rates = (self.angles - self.before) / self.tick_s
        return np.concatenate([self.angles, rates], axis=1)[:, np.concatenate([self.wiring, 5 + self.wiring])]

    def look(self) -> FloatArray:
        seen = directions(self.angles)
        seen = seen + self.noise * self.rng.standard_normal(seen.shape)
        return seen / np.linalg.norm(seen, axis=-1, keepdims=True)


def schema() -> BodySchema:
    """Motor f moves sense f."""
    none = np.zeros(5)
    return BodySchema(np.arange(5), np.arange(5, 10), none, none + 1.5, none, none, np.zeros((5, 10)))


def motors() -> MotorRange:
    """The whole range."""
    return MotorRange(-np.ones(5), np.ones(5), np.zeros(5), np.full(5, 3.0), np.full(5, 0.01))
