"""Where things are, by one's own two eyes in a head that moves: learned by watching one's own hands.

Eyes alike and parallel see a thing at (u, v) and (u', v'). It is d = 1 / (u - u') away, in units of their distance, and

    place = R(q) (d, d (u + u') / 2, d v) + t(q) = W' (phi(q) x (1, d, d (u + u') / 2, d v)),

phi the products of harmonics of the n senses q that move the eyes (`babbling.body_image`). In turns and shifts of a
body of hinges every sense enters by its sine and cosine, and turns within turns multiply: so the law is linear in W and
exact. Such eyes see a thing on one row; where rows differ it is half hidden from one of them, and nothing is believed.
What moves the eyes is what moves the forehead, found by looking; targets are the places that the learned body
image foretells for one's hands. How long the neck is, where eyes stand, how wide they see: all of that is W, learned.
"""

from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.body import OfOneBody
from babbling.body_image import PartImage, harmonic_products
from babbling.errors import BabblingError
from babbling.kinds import Numbers, kind
from babbling.regression import Regression

SIGHTS: Final = 4
"""1, d, d (u + u') / 2, d v."""
LEAST_APART: Final = 0.02
"""Least u - u': what is farther than fifty times the distance of the eyes has no place."""
ROW: Final = 0.012
"""Greatest |v - v'|, focal lengths: a pixel."""
OUTLIER: Final = 2.5
"""A hand that is missed by more standard deviations was half hidden; it is left out."""
ROUNDS: Final = 8
PRIOR: Final = 400.0
"""1/m^2: W ~ N(0, I / PRIOR), for the distance of one's eyes, which is what R's entries are told in, is some 5 cm."""
BEYOND: Final = 0.03
"""rad."""
LEAST_VARIANCE: Final = 1e-12
"""m^2."""


@kind("own eyes", "make one with `imitate play`")
@dataclass(frozen=True)
class OwnEyes(OfOneBody):
    """The learned law."""

    fingerprint: str
    joints: Annotated[IntArray, Numbers("eye_joint", low=0)]
    """(n,) posture senses that move the eyes."""
    centre: Annotated[FloatArray, Numbers("eye_joint", "rad")]
    """(n,) their middles."""
    low: Annotated[FloatArray, Numbers("eye_joint", "rad")]
    """(n,) least of them in which hands were watched: beyond, nothing is believed."""
    high: Annotated[FloatArray, Numbers("eye_joint", "rad")]
    """(n,) greatest."""
    weights: Annotated[FloatArray, Numbers("coordinate:3 sight")]
    """(3, 3^n * 4) W', m; the harmonics slowest."""
    noise: Annotated[float, Numbers(unit="m", low=0)]
    """Standard deviation of what it missed the hands by."""

    def locate(self, seen: FloatArray, postures: FloatArray, row: float = ROW) -> FloatArray:
        """Places in the body image's frame.

        Args:
            seen: (2, N, K, 2) u, v of K things in the left and the right eye, in units of the focal length, from
                anywhere, always the same; NaN unseen.
            postures: (N, F) felt.
            row: greatest |v - v'| of what is not half hidden.

        Returns: (N, K, 3) m, NaN unseen, or in a posture in which hands were never watched.
        """
        held = postures[:, self.joints]
        found = _products(harmonic_products(held - self.centre)[:, None], sights(seen, row)) @ self.weights.T
        known: BoolArray = np.asarray(((held >= self.low - BEYOND) & (held <= self.high + BEYOND)).all(1))
        return np.where(known[:, None, None], found, np.nan)


def sights(seen: FloatArray, row: float = ROW, least: float = LEAST_APART) -> FloatArray:
    """(2, ..., 2) in the left and right eye to (..., 4): 1, d, d (u + u') / 2, d v; NaN unseen, half hidden (rows
    differ by `row` and more), or too far (u - u' at most `least`)."""
    (left, v), (right, w) = np.moveaxis(seen, -1, 1)
    apart = left - right
    depth = 1 / np.where((apart > least) & (np.abs(v - w) < row), apart, np.nan)
    return np.stack([np.ones_like(depth), depth, depth * (left + right) / 2, depth * (v + w) / 2], -1)


def learn_own_eyes(
    seen: FloatArray, postures: FloatArray, places: FloatArray, head: PartImage, fingerprint: str
) -> OwnEyes:
    """The law, from watching one's own hands.

    Args:
        seen: (2, N, H, 2) where H hands were seen, NaN unseen; see `OwnEyes.locate`.
        postures: (N, F) felt.
        places: (N, H, 3) m where the body image foretells the hands.
        head: image of a part that moves as the eyes do.
        fingerprint: of the body that looked.

    Raises:
        BabblingError: hands that were hardly ever seen.
    """
    held = postures[:, head.joints]
    x = _products(harmonic_products(held - head.centre)[:, None], sights(seen))
    watched = held[np.isfinite(x.sum(-1)).any(-1)]
    x, y = x.reshape(-1, 1, x.shape[-1]), places.reshape(-1, 1, 3)
    count, least = int(np.isfinite(x.sum(-1)).sum()), 2 * x.shape[-1]
    if count < least:
        raise BabblingError(
            f"one's hands were seen {count} times; {least} at least tell where one's eyes are: watch them longer"
        )
    keep = np.isfinite(x.sum(-1))
    for _ in range(ROUNDS):
        sums = Regression(1, x.shape[-1], 3)
        sums.observe(x, y, keep)
        fit, variance = sums.fit_with_noise(PRIOR, LEAST_VARIANCE)
        missed = ((y - fit.mean(x)) ** 2).sum(-1)
        keep = missed < OUTLIER**2 * 3 * variance
    return OwnEyes(
        fingerprint, head.joints, head.centre, watched.min(0), watched.max(0), fit.coefficients[0].copy(),
        float(np.sqrt(variance)),
    )  # fmt: skip


def _products(phi: FloatArray, sight: FloatArray) -> FloatArray:
    """(..., P) and (..., 4) to (..., 4 P)."""
    both = phi[..., :, None] * sight[..., None, :]
    return np.asarray(both.reshape(*both.shape[:-2], -1))
