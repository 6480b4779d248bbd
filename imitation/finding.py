"""What is worth telling of an image: one place for each colour of a palette."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray
from imitation.seeing import COLOURS, Feature, find_features

EVEN_SHARE = 0.25
"""A second thing of the same colour, larger than this share of the first, makes its place doubtful: none is told."""


def places(features: Sequence[Feature], labels: Sequence[str]) -> FloatArray:
    """(K, 2) centroid of the one thing of each colour; NaN where there is none, several, or one cut by the border."""
    found = np.full((len(labels), 2), np.nan)
    for row, label in enumerate(labels):
        mine = [feature for feature in features if feature.label == label]
        if mine and mine[0].whole and all(other.area < EVEN_SHARE * mine[0].area for other in mine[1:]):
            found[row] = mine[0].u, mine[0].v
    return found


class Finder:
    """Images to places of the colours in `labels`; see `places`."""

    def __init__(self, labels: Sequence[str] = tuple(COLOURS)) -> None:
        self.labels = tuple(labels)

    def __call__(self, image: NDArray[np.uint8]) -> FloatArray:
        """(H, W, 3) bytes to (K, 2) pixels."""
        return places(find_features(image), self.labels)
