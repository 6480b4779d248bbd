"""From pixels to features: where coloured things are on an image, and how large.

Colour without brightness: of a pixel (r, g, b) only its *opponent* part counts, the two coordinates of its projection
along the grey axis (1, 1, 1). Light and shade scale it, grey adds nothing to it, so a pixel that a thing covers by the
fraction a shows a times the thing's opponent colour on any grey ground: that makes centroids finer than a pixel.
Positions: u = column to the right, v = row downwards, whole numbers at pixel centres.
"""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from babbling.axes import BoolArray, FloatArray
from imitation.errors import ImitationError

Colour = tuple[float, float, float]

LEAST_COLOUR = 40.0  # opponent length in levels (of 255): eight standard deviations of 2 % pixel noise
LEAST_SATURATION = 0.4  # opponent length over brightness: no whitish, greyish or brownish thing is colourful
HUE_TOLERANCE_DEG = 18.0  # 2 % pixel noise turns the hue of a colourful pixel by some 3 degrees, a dim one by 8
LEAST_GROUND = 30.0  # levels; a darker ground tells nothing about coverage
RIM_STRENGTH = 0.6  # of a neighbour's colour; a weaker speck beside it is its rim
LEAST_AREA = 0.7  # pixels; smaller specks are noise
SMALLEST_IMAGE = 3  # pixels along a side

COLOURS: Mapping[str, Colour] = MappingProxyType(
    {
        "red": (1.0, 0.05, 0.05),
        "orange": (1.0, 0.45, 0.0),
        "yellow": (1.0, 0.85, 0.0),
        "lime": (0.55, 1.0, 0.0),
        "green": (0.0, 0.9, 0.1),
        "cyan": (0.0, 0.9, 0.9),
        "blue": (0.08, 0.25, 1.0),
        "violet": (0.5, 0.0, 1.0),
        "magenta": (1.0, 0.05, 0.9),
    }
)
"""Colour categories a retina can be born with: hues at least 25 degrees apart on the opponent circle."""

OPPONENT = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]).T / np.sqrt([2.0, 6.0])
"""(3, 2) red, green, blue to colour without brightness; orthonormal columns."""
MARGIN = 3  # pixels of ground around a thing

_LABELS = tuple(COLOURS)
_HUES = np.array(list(COLOURS.values())) @ OPPONENT
_HUES /= np.linalg.norm(_HUES, axis=1)[:, None]
"""Unit opponent vectors (colours, 2)."""
_GREY = np.full(3, 1.0 / 3.0)
_AROUND = np.ones((3, 3), bool)


class Feature(NamedTuple):
    """One coloured thing on one image."""

    label: str
    """Name of its colour."""
    u: float
    """Column of its centroid, pixels."""
    v: float
    """Row of its centroid, pixels."""
    area: float
    """Pixels it covers, fractions of pixels included."""
    whole: bool
    """False when it touches the image's border: then its centroid is that of the part that shows."""


def find_features(image: npt.NDArray[np.uint8], least_area: float = LEAST_AREA) -> tuple[Feature, ...]:
    """Coloured things on an image, by label in the order of `COLOURS`, larger ones first; what is absent is not listed.

    A pixel belongs to the nearest hue of those when it is colourful enough; connected pixels make a thing. Its
    centroid weighs each pixel by its coverage, taken as its opponent length over the largest in its 3 x 3
    neighbourhood: inside a thing that is near 1 whatever the shading, on its rim it is the covered fraction.

    Raises:
        ImitationError: not a colour image.
    """
    if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8:
        raise ImitationError(f"an image is (height, width, 3) of uint8; this has shape {image.shape} of {image.dtype}")
    if min(image.shape[:2]) < SMALLEST_IMAGE:
        raise ImitationError(
            f"an image of {image.shape[1]} x {image.shape[0]} pixels shows nothing; 3 x 3 is the least"
        )
    red, green, blue = (image[:, :, channel].astype(np.int16) for channel in range(3))
    spread = np.maximum(np.maximum(red, green), blue) - np.minimum(np.minimum(red, green), blue)
    rows, columns = np.nonzero(spread > LEAST_COLOUR)  # at least sqrt(3/2) times the opponent length
    if not rows.size:
        return ()
    colour = image[rows, columns] @ OPPONENT
    length = np.hypot(colour[:, 0], colour[:, 1])
    cosine = colour @ _HUES.T / length[:, None]  # (pixels, colours)
    nearest = cosine.argmax(axis=1)
    fits = cosine.max(axis=1) >= np.cos(np.deg2rad(HUE_TOLERANCE_DEG))
    fits &= (length > LEAST_COLOUR) & (length > LEAST_SATURATION / 3.0 * image[rows, columns].sum(axis=1))
    owner = np.full(image.shape[:2], -1)
    owner[rows[fits], columns[fits]] = nearest[fits]

    found = []
    for index in np.unique(nearest[fits]):
        mine = []
        for mask, top, left, whole in _things(owner == index):
            window = (slice(top, top + mask.shape[0]), slice(left, left + mask.shape[1]))
            place = _measure(image[window], _HUES[index], mask, (owner[window] >= 0) & ~mask)
            if place is not None and place[2] >= least_area:
                u, v, area = place
                mine.append(Feature(_LABELS[index], u + left, v + top, area, whole))
        found += sorted(mine, key=lambda feature: -feature.area)
    return tuple(found)


def _things(mask: BoolArray) -> Iterator[tuple[BoolArray, int, int, bool]]:
    """Connected parts of a mask, each as a mask in a window with some ground around it, that window's top and left, and
    whether it keeps off the border of the image."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    height, width = mask.shape
    first_row, first_column = rows[0], columns[0]
    numbered, _ = ndimage.label(mask[first_row : rows[-1] + 1, first_column : columns[-1] + 1], _AROUND)
    for number, (down, across) in enumerate(ndimage.find_objects(numbered), start=1):
        top, bottom = down.start + first_row, down.stop + first_row
        left, right = across.start + first_column, across.stop + first_column
        high, low = max(top - MARGIN, 0), max(left - MARGIN, 0)
        window = np.zeros((min(bottom + MARGIN, height) - high, min(right + MARGIN, width) - low), bool)
        window[top - high : bottom - high, left - low : right - low] = numbered[down, across] == number
        yield window, int(high), int(low), bool(top > 0 and left > 0 and bottom < height and right < width)


def _measure(
    image: npt.NDArray[np.uint8], hue: FloatArray, mask: BoolArray, others: BoolArray
) -> tuple[float, float, float] | None:
    """Centroid u, v in the window and area of the thing `mask`; None for what is no thing after all.

    Coverage a of a pixel from its brightness I and its opponent length s along the hue: the thing alone has I = rho s
    whatever its shading, so I - rho s = (1 - a) I_ground is what the ground behind it adds.
    """
    colour = image @ OPPONENT
    length = colour @ hue
    if others.any():
        beside = others & ndimage.binary_dilation(mask, _AROUND, iterations=2)
        if (length[mask].max() < RIM_STRENGTH * np.linalg.norm(colour[beside], axis=1)).any():
            return None  # a speck on the rim of a stronger thing, where noise turned the hue
    bright = image @ _GREY
    wide = ndimage.binary_dilation(mask, _AROUND)
    core = mask & (length >= 0.8 * length[mask].max())
    contrast = float(np.median(length[core]))
    rim = wide & ~others
    ground = (~ndimage.binary_dilation(wide, _AROUND) & ~others).astype(float)
    near = ndimage.uniform_filter(ground, 2 * MARGIN + 1, mode="constant")
    share = np.where(near > 0.01, near, np.inf)  # no ground near: the inside of a large thing
    grey = ndimage.uniform_filter(bright * ground, 2 * MARGIN + 1, mode="constant") / share
    rho = float(bright[core].sum() / length[core].sum())
    coverage = np.where(
        grey >= LEAST_GROUND,
        1.0 - (bright - rho * length) / np.maximum(grey, LEAST_GROUND),
        np.where(near > 0.01, length / contrast, 1.0),
    )
    weight = np.where(rim, np.clip(coverage, 0.0, 1.0), 0.0)
    area = float(weight.sum())
    v, u = np.nonzero(rim)
    weight = weight[v, u] / area
    return float(weight @ u), float(weight @ v), area
