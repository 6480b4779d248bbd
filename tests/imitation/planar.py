"""A planar arm of two links, its body image written down: links point at a and at a + b in the x-y plane."""

from types import MappingProxyType

import numpy as np

from babbling.body_image import Image, PartImage
from imitation.correspondence.inversion import LimbView
from imitation.correspondence.limbs import own_limbs

COSINE, SINE = np.array([1.0, 0, -1]), np.array([0.0, 1, 0])
"""cos and sin in the harmonics 1, sin, 1 - cos."""


def image(
    low: tuple[float, float] = (-2.5, -2.5), high: tuple[float, float] = (2.5, 2.5), remembered: int = 60
) -> Image:
    """An exact image of the arm, with so many postures to choose from."""
    upper = np.stack([COSINE, SINE, 0 * SINE], -1)
    both = [np.multiply.outer(COSINE, COSINE) - np.multiply.outer(SINE, SINE),
            np.multiply.outer(SINE, COSINE) + np.multiply.outer(COSINE, SINE)]  # fmt: skip
    fore = np.stack([*both, 0 * both[0]], -1)
    parts = {
        "upper": PartImage(np.array([0]), np.zeros(1), upper, 0.0),
        "fore": PartImage(np.arange(2), np.zeros(2), fore.reshape(-1, 3), 0.0),
    }
    library = np.random.default_rng(0).uniform(low, high, (remembered, 2))
    return Image(
        MappingProxyType(parts), np.array(low), np.array(high), np.zeros(2), library, np.zeros((remembered, 2))
    )


def view(of: Image, frames: int) -> LimbView:
    """The arm over so many frames."""
    (limb,) = own_limbs(of.moves)
    return LimbView(of, limb, list(limb.parts), np.tile(of.rest, (frames, 1)), 0.0)


def pointing(angles: np.ndarray) -> np.ndarray:
    """(T, 2, 3) where the links point at (T, 2) angles."""
    ways = np.cumsum(angles, 1)
    return np.stack([np.cos(ways), np.sin(ways), 0 * ways], -1)
