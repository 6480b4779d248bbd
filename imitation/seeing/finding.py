"""What is worth telling of an image: one place for each colour of a palette, or all that might be one."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray
from imitation.seeing.features import COLOURS, LEAST_AREA, Feature, find_features

EVEN_SHARE = 0.25
"""A second thing of the same colour, larger than this share of the first, makes its place doubtful: none is told."""


def candidates(features: Sequence[Feature], labels: Sequence[str], most: int = 2) -> FloatArray:
    """(K, most, 3) u, v and area of things of each colour, larger ones first; NaN where there are fewer.

    Of a thing cut by the border only the area is told: its centroid is that of the part that shows.
    """
    found = np.full((len(labels), most, 3), np.nan)
    for row, label in zip(found, labels, strict=True):
        mine = [feature for feature in features if feature.label == label]
        for place, one in zip(row, mine, strict=False):
            place[:] = (one.u, one.v, one.area) if one.whole else (np.nan, np.nan, one.area)
    return found


def alone(found: FloatArray) -> FloatArray:
    """(..., 3) the one thing among (..., most, 3) `candidates`; NaN where there is none, several, or one cut off."""
    first, second = found[..., 0, :], found[..., 1, :]
    doubtful = np.isnan(first[..., 0]) | (second[..., 2] >= EVEN_SHARE * first[..., 2])
    return np.where(doubtful[..., None], np.nan, first)


class Finder:
    """Images to places of the colours in `labels`; see `alone`. Specks under `least_area` square pixels are nothing:
    where toys are known to be larger, the rim of one thing in front of another is not taken for a third. With the
    `areas` as well, what is partly hidden can be told.
    """

    def __init__(
        self, labels: Sequence[str] = tuple(COLOURS), least_area: float = LEAST_AREA, *, areas: bool = False
    ) -> None:
        self.labels, self.least_area, self.areas = tuple(labels), least_area, areas

    def __call__(self, image: NDArray[np.uint8]) -> FloatArray:
        """(H, W, 3) bytes to (K, 2) pixels, or to (K, 3) pixels, pixels, square pixels."""
        found = alone(candidates(find_features(image, self.least_area), self.labels))
        return found if self.areas else found[:, :2]
