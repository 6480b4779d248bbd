"""What one attempt leaves to the next: how far to aim beside each sub-goal (iterative learning control).

Chapter, section 2.2: infants correct their response and converge on the match without feedback from the experimenter.
Law, per factor with error e_n = goal - believed posture of attempt n, aim u_n, share L and a zero-phase smoothing S:

    u_{n+1} = S(u* + L E[e* | felt])      of the best attempt so far (u*, e*)
    S E[e | felt] = S e max(0, 1 - P / mean((S e)^2))      P the variance of S(believed - true posture)

What is believed is not quite what is; an error that is no larger than that doubt is no error to aim against.
An attempt that was worse than the best one is not built upon: L is halved and the next one starts from the best again.
One that lasted longer is better, however large its error; what an early end left undone teaches nothing (e* = 0 there).
"""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import convolve1d

from babbling.axes import FloatArray

SHARE = 0.6
"""Share of an attempt's error that the next one aims against."""
SMOOTHING = np.array([1, 4, 6, 4, 1]) / 16
"""Zero-phase kernel over ticks: what changes faster than a few ticks is not an error that aiming can mend."""


class Practice(NamedTuple):
    """Aim of the next attempt, and the best one so far."""

    aim: FloatArray
    """(T, B, F) offset of each sub-goal in the next attempt."""
    best_aim: FloatArray
    """(T, B, F)."""
    best_error: FloatArray
    """(T, B, F) what that aim missed by; 0 where it did not come."""
    lasted: int
    """Ticks that it lasted."""
    size: FloatArray
    """(B, F) root mean square of its error; infinite before the first attempt."""
    share: FloatArray
    """(B, F) L."""

    @classmethod
    def empty(cls, ticks: int, copies: int, factors: int) -> "Practice":
        """Before the first attempt: aim at the goals themselves."""
        nothing = np.zeros((ticks, copies, factors))
        return cls(nothing, nothing, nothing, 0, np.full((copies, factors), np.inf), np.full((copies, factors), SHARE))

    def after(self, error: FloatArray, doubt: FloatArray | float = 0.0) -> "Practice":
        """Having missed by (t, B, F) errors, t <= T, with the present aim; the attempt ended after t ticks.

        Args:
            error: goals less believed postures.
            doubt: (F,) P; see `StateEstimate.doubt`.
        """
        lasted = len(error)
        size = np.sqrt(np.mean(error**2, axis=0)) if lasted else np.full_like(self.size, np.inf)
        better = (lasted > self.lasted) | (lasted == self.lasted) & (size < self.size)
        missed = np.pad(error, ((0, len(self.aim) - lasted), (0, 0), (0, 0)))
        best_aim = np.where(better, self.aim, self.best_aim)
        best_error = np.where(better, missed, self.best_error)
        share = np.where(better, self.share, self.share / 2)
        aim, against = (convolve1d(one, SMOOTHING, axis=0, mode="nearest") for one in (best_aim, best_error))
        longest = max(lasted, self.lasted)
        square = np.sum(against**2, axis=0) / max(longest, 1)  # where it did not come, nothing was missed
        sure = np.maximum(0, 1 - doubt / np.maximum(square, 1e-300))
        size = np.where(better, size, self.size)
        return Practice(aim + share * sure * against, best_aim, best_error, longest, size, share)
