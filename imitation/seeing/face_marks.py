"""A face on an image: where its irises, nose, brows, lips and tongue are, by their colours and their order.

Lips that touch make one patch, so they are parted by rows and columns instead: into quarters about their middle. The
tongue covers the middle of the lower lip, so that is looked at towards its corners.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from babbling.axes import BoolArray, FloatArray
from imitation.seeing.features import COLOURS, OPPONENT

POINTS: Final = (
    "left iris", "right iris", "nose", "left brow", "right brow", "upper left lip", "upper right lip", "lower left lip",
    "lower right lip", "tongue",
)  # fmt: skip
"""Left and right are the face's own: its left is to the right on an image."""
NUMBERS: Final = 2 * len(POINTS) + 1
"""u and v of every point, and the square root of the tongue's area, pixels."""
FULL: Final = 0.9
"""A pixel this much of a patch's full colour is covered wholly."""
LEAST: Final = 0.12
"""Covered less, it is ground; 2 % of pixel noise stays below."""
LEAST_PX: Final = 3
"""Pixels of the smallest patch."""
ROUNDS: Final = 4
COVERED: Final = 0.3
"""Share of its columns from which a part of the lower lip is hidden by the tongue."""
OUTER: Final = 0.55, 1.15
"""Of the distance between the upper quarters' middles: from there on, and to there, the lower lip is looked at."""
IRIS, NOSE, BROW, LIP, TONGUE = range(5)
_HUES = np.array([COLOURS[name] for name in ("blue", "orange", "violet", "magenta", "red")]) @ OPPONENT
_HUES /= np.linalg.norm(_HUES, axis=1)[:, None]


def coverage(image: NDArray[np.uint8]) -> FloatArray:
    """(5, height, width) how much of each pixel shows an iris, the nose, a brow, a lip, the tongue: 0 to 1.

    A pixel belongs to the nearest of the five hues; how much of it is covered is its opponent length over the largest
    beside it: inside a patch all, whatever the light.
    """
    colour = image @ OPPONENT
    along = colour @ _HUES.T
    length = np.linalg.norm(colour, axis=-1)
    nearest = along.argmax(-1)
    colourful = (length > 25.0) & (along.max(-1) > 0.9 * length) & (length > 0.12 * image.sum(-1, dtype=float))
    covers = np.zeros((len(_HUES), *image.shape[:2]))
    for part, cover in enumerate(covers):
        mine = colourful & (nearest == part)
        if mine.any():
            strength = np.where(mine, along[..., part], 0.0)
            core = strength > 0.4 * np.quantile(strength[mine], 0.7)
            share = strength / np.maximum(FULL * ndimage.maximum_filter(strength, 3), 1e-9)
            cover[:] = np.where(_patches(core) & (share > LEAST), np.minimum(share, 1.0), 0.0)
    return covers


def numbers(covers: FloatArray) -> FloatArray:
    """(NUMBERS,) of (5, height, width) coverage; NaN for what is not there."""
    found = np.full(NUMBERS, np.nan)
    points = found[:-1].reshape(-1, 2)
    points[2] = _middle(covers[NOSE])
    for first, part in ((0, IRIS), (3, BROW)):
        points[first + 1], points[first] = _halves(covers[part])
    points[5:9] = _quarters(covers[LIP], covers[TONGUE])
    points[9], found[-1] = _middle(covers[TONGUE]), np.sqrt(covers[TONGUE].sum()) or np.nan
    return found


def _patches(core: BoolArray) -> BoolArray:
    """Patches of some size, with their rims."""
    labelled, count = ndimage.label(core)
    large = np.bincount(labelled.ravel(), minlength=count + 1) >= LEAST_PX
    large[0] = False
    return np.asarray(ndimage.binary_dilation(large[labelled], np.ones((3, 3), bool)))


def _middle(cover: FloatArray) -> FloatArray:
    total = cover.sum()
    if total < LEAST_PX:
        return np.full(2, np.nan)
    rows, columns = np.arange(cover.shape[0]), np.arange(cover.shape[1])
    return np.asarray(np.array([cover.sum(0) @ columns, cover.sum(1) @ rows]) / total)


def _halves(cover: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Left and right on the image, about their common middle."""
    middle = _middle(cover)[0]
    columns = np.arange(cover.shape[1])
    left, right = (_middle(cover * np.clip(side * (middle - columns) + 0.5, 0, 1)) for side in (1, -1))
    return left, right


def _quarters(lips: FloatArray, tongue: FloatArray) -> FloatArray:
    """(4, 2) upper left, upper right, lower left, lower right, of the face's own left and right; of the lower lip only
    the row of its outer parts is told."""
    columns, rows = np.arange(lips.shape[1]), np.arange(lips.shape[0])[:, None]
    middle, row = _middle(lips)
    if np.isnan(middle):
        return np.full((4, 2), np.nan)
    for _ in range(ROUNDS):
        upper, lower = (_middle(lips * np.clip(side * (row - rows) + 0.5, 0, 1)) for side in (1, -1))
        row = (upper[1] + lower[1]) / 2 if np.isfinite(upper[1] + lower[1]) else row
    upper = lips * np.clip(row - rows + 0.5, 0, 1)
    middle = _middle(upper)[0]
    sides = [np.clip(side * (columns - middle) + 0.5, 0, 1) for side in (1, -1)]
    above = [_middle(upper * side) for side in sides]
    away = np.abs(columns - middle) / (above[0][0] - above[1][0])
    outer = (away > OUTER[0]) & (away < OUTER[1])
    below = []
    for side in sides:
        there = side * outer
        covered = (tongue.sum(0) > 0.5)[there > 0.5].mean() > COVERED
        below.append((np.nan, np.nan if covered else _middle(lips * np.clip(rows - row + 0.5, 0, 1) * there)[1]))
    return np.array([*above, *below])
