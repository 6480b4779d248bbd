"""What a head saw while it looked about, and how well it looked."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray


class Glance(NamedTuple):
    """One view of the recording."""

    images: tuple[NDArray[np.uint8], NDArray[np.uint8]]
    found: FloatArray
    """(K, 4) pixels."""
    predicted: FloatArray
    """(K, 4) pixels, where each thing was expected to be."""
    angles: FloatArray
    """(2,) true pan and tilt."""
    event: str
