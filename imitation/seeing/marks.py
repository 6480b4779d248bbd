"""Hands, forehead and things on images: one mark for each, by its colour, and places from two parallel eyes.

Where a mark is, is the middle of all that shows its colour. Two eyes alike and parallel, b apart, see it u - u' apart:

    (ahead, left, up) = b / (u - u') (1, -(u + u') / 2, -v),    u, v in units of the focal length, u - u' > 0

and both see it on one row: where rows differ it is half hidden from one of them, and has no place.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray
from babbling.own_eyes import sights
from imitation.errors import ImitationError
from imitation.seeing.features import find_features

MARKS: Final = (("magenta",), ("blue",), ("green",), ("orange", "yellow"), ("cyan",))
"""Colours of the left hand, the right hand, the forehead, a (a lamp, off and on) and b."""
A: Final = 3
LEAST_AREA: Final = 4.0
"""Square pixels; smaller specks are rims."""
LEAST_APART: Final = 1e-3
"""Least difference between two eyes' views, focal lengths: farther things have no place."""
ROW: Final = 0.006
"""Greatest difference between rows, focal lengths."""
GAP: Final = 4
"""Looks in a row that a mark may be hidden for, and still have been on the straight way between."""


def marks(image: NDArray[np.uint8], *, cut: bool = False) -> FloatArray:
    """(5, 2) u, v in pixels of every mark of `MARKS`; NaN for what is hidden, and, unless `cut`, for what the border of
    the image cuts."""
    places = np.full((len(MARKS), 2), np.nan)
    found = find_features(image, LEAST_AREA)
    for place, labels in zip(places, MARKS, strict=True):
        mine = [one for one in found if one.label in labels]
        if mine and (cut or all(one.whole for one in mine)):
            place[:] = np.average([(one.u, one.v) for one in mine], axis=0, weights=[one.area for one in mine])
    return places


def glows(image: NDArray[np.uint8]) -> bool:
    """Whether the lamp a is on."""
    off, on = (
        sum(one.area for one in find_features(image, LEAST_AREA) if one.label == label) for label in MARKS[A]
    )  # fmt: skip
    return on > off


def centred(pixels: FloatArray, width: int, height: int, focal_px: float) -> FloatArray:
    """(..., 2) pixels to u to the right and v downwards from the image's middle, in units of the focal length."""
    return np.asarray((pixels - ((width - 1) / 2, (height - 1) / 2)) / focal_px)


def located(seen: FloatArray, apart: float) -> FloatArray:
    """(..., 3) m ahead, left and up of the middle between two parallel eyes.

    Args:
        seen: (2, ..., 2) `centred` u, v in the left and the right eye; NaN unseen.
        apart: m between the eyes.

    Raises:
        ImitationError: eyes that are not two.
    """
    if len(seen) != 2:
        raise ImitationError(f"{len(seen)} eye(s) give no depth; two do")
    return np.asarray(apart * sights(seen, ROW, LEAST_APART)[..., 1:] * (1, -1, -1))


def bridged(track: FloatArray, gap: int = GAP) -> FloatArray:
    """(T, K, D) tracks in which what was hidden for at most `gap` looks is on the straight way between two sights, and
    stays before its first and after its last one; what was hidden for longer in between is NaN as it was."""
    filled, looks = track.copy(), np.arange(len(track))
    for k in range(track.shape[1]):
        shown = np.flatnonzero(~np.isnan(track[:, k]).any(-1))
        if len(shown):
            next_ = np.searchsorted(shown, looks)
            ends = (next_ == 0) | (next_ == len(shown))
            between = shown[np.minimum(next_, len(shown) - 1)] - shown[np.maximum(next_ - 1, 0)] - 1
            near = ends | (between <= gap)
            for d in range(track.shape[2]):
                filled[near, k, d] = np.interp(looks[near], shown, track[shown, k, d])
    return filled
