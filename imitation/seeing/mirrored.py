"""What a mirror teaches of faces: a map from how one's own face looked to how it felt, to be compared with birthright.

Kernel ridge regression from what both eyes show, relative to a face at rest and in distances between the irises, to
relations; its width and its ridge are those of the least error when every look in turn is left out. A map of one's own
face: nothing in it knows of poses, distances or proportions.
"""

from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from babbling.axes import FloatArray
from imitation.errors import ImitationError
from imitation.seeing.face_fit import Seen
from imitation.seeing.face_template import POSE

WIDTHS: Final = (0.25, 0.5, 1.0, 2.0, 4.0)
RIDGES: Final = (1e-4, 1e-3, 1e-2, 1e-1)
FEWEST: Final = 20
"""Looks into the mirror."""


def features(look: FloatArray, neutral: FloatArray) -> FloatArray:
    """(..., D) of (..., 2, NUMBERS) looks and what a face at rest looked like; what is hidden is as at rest."""
    apart = np.nanmean(neutral[:, 0] - neutral[:, 2])
    there = np.isfinite(look)
    tongue = np.asarray(there[..., -1].all(-1))
    change = np.where(there & np.isfinite(neutral), look - neutral, 0.0)
    out = np.where(there[..., 18:], look[..., 18:], 0.0) * tongue[..., None, None]
    return np.asarray(np.concatenate([_flat(change[..., :18]), _flat(out), tongue[..., None] * apart], -1) / apart)


@dataclass(frozen=True, eq=False)
class Mirrored:
    """A map that was learned in front of a mirror."""

    seen: FloatArray
    """(N, D) features, scaled."""
    scale: FloatArray
    """(D,)"""
    weights: FloatArray
    """(N, 8)"""
    middle: FloatArray
    """(8,)"""
    width: float
    covariance: FloatArray
    """(8, 8) of what it misses, each look in turn left out."""

    @classmethod
    def learned(cls, looks: FloatArray, felt: FloatArray, neutral: FloatArray) -> "Mirrored":
        """From (N, 2, NUMBERS) looks at oneself and the (N, 8) relations felt meanwhile.

        Raises:
            ImitationError: too few looks.
        """
        if len(looks) < FEWEST:
            raise ImitationError(f"{len(looks)} looks into the mirror; at least {FEWEST} are needed")
        seen = features(looks, neutral)
        scale = np.maximum(seen.std(0), 1e-3)
        seen, middle = seen / scale, felt.mean(0)
        found = []
        for width, ridge in product(WIDTHS, RIDGES):
            inverse = np.linalg.inv(_kernel(seen, seen, width) + ridge * np.eye(len(seen)))
            weights = inverse @ (felt - middle)
            left_out = weights / np.diag(inverse)[:, None]
            found.append((float((left_out / felt.std(0)).std()), width, weights, left_out))
        _, width, weights, left_out = min(found, key=lambda one: one[0])
        return cls(seen, scale, weights, middle, width, np.cov(left_out.T))

    def see(self, look: FloatArray, neutral: FloatArray) -> Seen:
        """What another does on one (2, NUMBERS) look, as if it were oneself."""
        kernel = _kernel(features(look, neutral)[None] / self.scale, self.seen, self.width)
        relations = (kernel @ self.weights)[0] + self.middle
        tongue = bool(np.isfinite(look[:, -1]).all())
        return Seen(relations, np.asarray(np.linalg.inv(self.covariance), float), tongue, 1.0, np.zeros(POSE + 6))


def _kernel(a: FloatArray, b: FloatArray, width: float) -> FloatArray:
    apart = ((a[:, None] - b[None]) ** 2).mean(-1)
    return np.asarray(np.exp(-apart / (2 * width**2)))


def _flat(values: ArrayLike) -> FloatArray:
    array = np.asarray(values, float)
    return array.reshape(*array.shape[:-2], -1)
