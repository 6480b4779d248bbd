"""A head movement as it was shown, seen and performed."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from imitation.seeing.pose import Watched

FloatArray = NDArray[np.float64]


class Seen(NamedTuple):
    """One sequence, watched; ticks of 20 ms, angles in rad."""

    path: FloatArray
    """(T, 2) what the teacher meant to do."""
    truth: FloatArray
    """(T, 2) what it did, NaN between frames."""
    numbers: FloatArray
    """(T, M)"""
    hidden: NDArray[np.bool_]
    """(T,)"""
    watched: Watched


class Performed(NamedTuple):
    """One sequence, reproduced; true angles of the imitator, rad."""

    imitated: FloatArray
    """(T, 2)"""
    replayed: FloatArray
    """(T, 2) the raw estimate of each frame sent to the servos."""
