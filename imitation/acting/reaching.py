"""Reaching: postures in which one's own parts are where they should be, by the learned image turned round.

The body image says where a palm or the forehead is in a posture (`babbling.body_image`, places instead of directions).
A reach is the posture nearest to comfort whose image lies on the target: damped Gauss-Newton steps from several of
one's own postures (the one before, rest, the nearest of the library), the best of which is kept.
"""

from typing import Final

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.body_image import Image
from imitation.correspondence.inversion import refined

STARTS: Final = 4
"""Postures of the library to start from, besides the one before and rest."""
STIFF: Final = 3e-5
"""m^2 per rad^2: one leans a radian from rest for 6 mm, not for one."""
MARGIN: Final = 0.02
"""rad kept from the ends of the senses."""


class _Places:
    """Where some parts are, as `refined` asks."""

    def __init__(self, image: Image, parts: IntArray, factors: IntArray, base: FloatArray) -> None:
        self._parts = [image.images[image.parts[part]] for part in parts]
        self._factors, self._base = factors, base
        self.low, self.high = image.low[factors] + MARGIN, image.high[factors] - MARGIN
        self.rest = np.clip(image.rest[factors], self.low, self.high)

    def directions(self, angles: FloatArray, rows: IntArray) -> tuple[FloatArray, FloatArray]:
        postures = self._base[rows]
        postures[:, self._factors] = angles
        shown = [part.slope(postures, self._factors) for part in self._parts]
        return np.stack([place for place, _ in shown], 1), np.stack([slope for _, slope in shown], 1)


def places(image: Image, postures: FloatArray) -> FloatArray:
    """(N, P, 3) m where one's parts are in (N, F) postures."""
    return np.stack([part.expected(postures) for part in image.images.values()], 1)


def reach(image: Image, targets: FloatArray, base: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Postures (N, F) that bring parts to (N, P, 3) targets, and by how much (N,) m the worst part will miss.

    A target of NaN leaves a part alone; the senses that move no other part stay as in `base` (N, F).
    """
    found, miss = base.copy(), np.zeros(len(base))
    wanted = ~np.isnan(targets).any(-1)
    for pattern in np.unique(wanted, axis=0):
        rows = np.flatnonzero((wanted == pattern).all(1))
        if pattern.any():
            found[rows], miss[rows] = _reached(image, np.flatnonzero(pattern), targets[rows], base[rows])
    return found, miss


def _reached(image: Image, parts: IntArray, targets: FloatArray, base: FloatArray) -> tuple[FloatArray, FloatArray]:
    factors, count = np.flatnonzero(image.moves[parts].any(0)), len(base)
    goal = targets[:, parts]
    starts = [base[:, factors], np.tile(image.rest[factors], (count, 1))]
    known = np.tile(base.mean(0), (len(image.library), 1))
    known[:, factors] = image.library[:, factors]
    shown = places(image, known)[:, parts]
    away = ((shown[None] - goal[:, None]) ** 2).sum((-1, -2))
    starts += list(image.library[np.argsort(away, 1)[:, :STARTS]][..., factors].swapaxes(0, 1))
    view = _Places(image, parts, factors, base)
    rows = np.tile(np.arange(count), len(starts))
    begin = np.clip(np.concatenate(starts), view.low, view.high)
    angles, cost = refined(view, goal, np.ones(goal.shape[:2]), begin, rows, STIFF)
    best = cost.reshape(len(starts), count).argmin(0)
    postures = base.copy()
    postures[:, factors] = angles.reshape(len(starts), count, -1)[best, np.arange(count)]
    there = places(image, postures)[:, parts]
    return postures, np.linalg.norm(there - goal, axis=-1).max(1)
