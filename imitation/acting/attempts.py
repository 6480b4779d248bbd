"""What one attempt leaves to the next: how far to aim beside each sub-goal (iterative learning control).

Chapter, section 2.2: infants correct their response and converge on the match without feedback from the experimenter.
Law, per factor with error e_n = goal - believed posture of attempt n, aim u_n, share L and a zero-phase smoothing S:

    u_{n+1} = S(u* + L e*)      of the best attempt so far (u*, e*)

An attempt that was worse than the best one is not built upon: L is halved and the next one starts from the best again.
"""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import convolve1d

from babbling.axes import FloatArray

SHARE = 0.6
"""Share of an attempt's error that the next one aims against."""
SMOOTHING = np.array([1, 4, 6, 4, 1]) / 16
"""Zero-phase kernel over ticks: what changes faster than a few ticks is not an error that aiming can mend."""


class Memory(NamedTuple):
    """Aim of the next attempt, and the best one so far."""

    aim: FloatArray
    """(T, B, F) offset of each sub-goal in the next attempt."""
    best_aim: FloatArray
    """(T, B, F)."""
    best_error: FloatArray
    """(T, B, F) what that aim missed by."""
    size: FloatArray
    """(B, F) root mean square of it; infinite before the first attempt."""
    share: FloatArray
    """(B, F) L."""

    @classmethod
    def empty(cls, ticks: int, copies: int, factors: int) -> "Memory":
        """Before the first attempt: aim at the goals themselves."""
        nothing = np.zeros((ticks, copies, factors))
        return cls(nothing, nothing, nothing, np.full((copies, factors), np.inf), np.full((copies, factors), SHARE))

    def after(self, error: FloatArray) -> "Memory":
        """Having missed by (T, B, F) errors with the present aim."""
        size = np.sqrt(np.mean(error**2, axis=0))
        better = size < self.size
        best_aim = np.where(better, self.aim, self.best_aim)
        best_error = np.where(better, error, self.best_error)
        share = np.where(better, self.share, self.share / 2)
        aim = convolve1d(best_aim + share * best_error, SMOOTHING, axis=0, mode="nearest")
        return Memory(aim, best_aim, best_error, np.minimum(size, self.size), share)
