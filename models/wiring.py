"""The wiring between a mind and a body: which motor line drives which servo, how, and which sense line reports it.

Law, for servo j driven by motor line p(j):   command_j = centre_j + 2 half_j (s_j g_j m_p(j) + o_j)

with centre and half range of the servo's commands, sign s, gain g and offset o. Straight wiring has s = g = 1, o = 0:
m = 0 is the middle of the range and |m| = 1/2 its ends; what lies beyond is cut by the drive. That margin is what lets
a wiring of half the gain still reach every posture.
"""

from dataclasses import dataclass, replace

import numpy as np

from models.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class Wiring:
    """How (M,) motor lines become servo commands and how sensations are ordered on (S,) sense lines."""

    motor: IntArray
    """(M,) motor line p(j) that drives servo j."""
    gain: FloatArray
    """(M,) signed gain s_j g_j."""
    offset: FloatArray
    """(M,) o_j."""
    sense: IntArray
    """(S,) which of the body's sensations stands on each sense line."""

    @classmethod
    def straight(cls, motors: int, senses: int) -> "Wiring":
        """Motor j drives servo j, sense line i carries sensation i."""
        return cls(np.arange(motors), np.ones(motors), np.zeros(motors), np.arange(senses))

    @classmethod
    def scrambled(cls, motors: int, senses: int, seed: int) -> "Wiring":
        """Motors and senses permuted, signs random, gains log-uniform in 0.5 .. 2, offsets as large as leaves every
        posture within |m| <= 1 (at most a quarter of the range).
        """
        rng = np.random.default_rng([seed, 0x5C4A])
        size = np.exp(rng.uniform(np.log(0.5), np.log(2.0), motors))
        sign = rng.choice([-1.0, 1.0], motors)
        room = np.minimum(size - 0.5, 0.25)
        return cls(rng.permutation(motors), sign * size, rng.uniform(-1, 1, motors) * room, rng.permutation(senses))

    @classmethod
    def of(cls, motors: int, senses: int, seed: int | None, *, senses_too: bool = True) -> "Wiring":
        """Straight without a seed; otherwise scrambled, the motors alone or the senses too."""
        if seed is None:
            return cls.straight(motors, senses)
        made = cls.scrambled(motors, senses, seed)
        return made if senses_too else replace(made, sense=np.arange(senses))

    def fractions(self, motors: FloatArray) -> FloatArray:
        """(..., M) motor lines to (..., M) servo commands as fractions of the range: -1 and 1 are its ends (cut)."""
        return np.clip(2 * (self.gain * motors[..., self.motor] + self.offset), -1, 1)

    def lines(self, fractions: FloatArray) -> FloatArray:
        """Inverse of `fractions`, for those who know the wiring (the baseline that replays angles, and tests)."""
        motors = np.empty_like(fractions)
        motors[..., self.motor] = (fractions / 2 - self.offset) / self.gain
        return motors
