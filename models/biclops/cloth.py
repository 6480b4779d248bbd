"""What one sees with a cloth before one's own eyes."""

import numpy as np

from models.arrays import FloatArray
from models.retina import Image

CLOTH_LEVELS = (70.0, 70.0, 76.0)
"""Colour of the cloth seen from behind, levels of 255."""
TRANSMISSION = {"opaque": 0.0, "see_through": 0.55}
"""Share of the light from outside that comes through each kind of cloth."""


def through_cloth(image: Image, kind: str, noise: float, rng: np.random.Generator) -> Image:
    """The image behind a cloth that covers the eye: what comes through, the cloth's colour, and pixel noise anew."""
    share = TRANSMISSION[kind]
    mixed: FloatArray = share * image + (1.0 - share) * np.array(CLOTH_LEVELS)
    mixed = mixed + 255.0 * noise * np.sqrt(1.0 - share**2) * rng.standard_normal(image.shape)
    return np.clip(np.rint(mixed), 0, 255).astype(np.uint8)
