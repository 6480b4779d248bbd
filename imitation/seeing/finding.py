"""What is worth telling of an image: one place for each colour of a palette."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray
from imitation.seeing.features import COLOURS, LEAST_AREA, Feature, find_features

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
    """Images to places of the colours in `labels`; see `places`. Specks under `least_area` square pixels are nothing:
    where toys are known to be larger, the rim of one thing in front of another is not taken for a third.
    """

    areas = False

    def __init__(self, labels: Sequence[str] = tuple(COLOURS), least_area: float = LEAST_AREA) -> None:
        self.labels, self.least_area = tuple(labels), least_area

    def __call__(self, image: NDArray[np.uint8]) -> FloatArray:
        """(H, W, 3) bytes to (K, 2) pixels."""
        return places(find_features(image, least_area=self.least_area), self.labels)


class Measurer:
    """Images to (K, 3) u, v and area of the colours in `labels`: with the area, what is partly hidden can be told."""

    areas = True

    def __init__(self, labels: Sequence[str]) -> None:
        self.labels = tuple(labels)

    def __call__(self, image: NDArray[np.uint8]) -> FloatArray:
        """(H, W, 3) bytes to (K, 3) pixels, pixels, square pixels."""
        features = find_features(image)
        found = places(features, self.labels)
        area = np.full(len(self.labels), np.nan)
        for row, label in enumerate(self.labels):
            if np.isfinite(found[row, 0]):
                area[row] = next(feature.area for feature in features if feature.label == label)
        return np.concatenate([found, area[:, None]], axis=1)
