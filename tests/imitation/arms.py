"""A trunk with two arms of three joints, its image written down: where palms and forehead are, exactly."""

from types import MappingProxyType

import numpy as np

from babbling.body_image import Image, PartImage

SHOULDER, UPPER, FORE, TRUNK = np.array([-0.1, 0.1, 0.05]), 0.12, 0.15, 0.17
MIRROR = np.array([1.0, -1.0, 1.0])
LOW, HIGH = np.array([-1.2, -1.0, 0.1, -0.8, -1.0, 0.1, -0.5]), np.array([0.8, 1.5, 2.2, 1.2, 1.5, 2.2, 1.2])
"""Left arm (turn, lower, bend), right arm, waist."""
REST = np.array([0.0, 0.8, 0.9, 0.0, 0.8, 0.9, 0.0])
JOINTS = {"left": np.arange(3), "right": np.arange(3, 6), "head": np.array([6])}


def where(postures: np.ndarray) -> np.ndarray:
    """(N, 3, 3) m, in closed form."""
    found = []
    for arm in (postures[:, :3], postures[:, 3:6]):
        turn, low, bend = arm.T
        out, down = UPPER * np.cos(low) + FORE * np.cos(low + bend), UPPER * np.sin(low) + FORE * np.sin(low + bend)
        side = MIRROR if len(found) else 1
        found.append(SHOULDER * side + np.stack([out * np.cos(turn), out * np.sin(turn), -down], 1))
    lean = postures[:, 6]
    found.append((-0.1, 0, -0.05) + TRUNK * np.stack([np.sin(lean), 0 * lean, np.cos(lean)], 1))
    return np.stack(found, 1)


def image(remembered: int = 100) -> Image:
    """The exact image: as many exact sights as there are harmonics, times four, leave one solution."""
    rng, parts = np.random.default_rng(0), {}
    for number, (part, joints) in enumerate(JOINTS.items()):
        count = 3 ** len(joints)
        postures = rng.uniform(LOW, HIGH, (4 * count, len(LOW)))
        phi = np.ones((len(postures), 1))
        for angle in postures[:, joints].T:
            basis = np.stack([np.ones_like(angle), np.sin(angle), 1 - np.cos(angle)], 1)
            phi = (phi[:, :, None] * basis[:, None]).reshape(len(postures), -1)
        weights = np.linalg.lstsq(phi, where(postures)[:, number], rcond=None)[0]
        parts[part] = PartImage(joints, np.zeros(len(joints)), weights, 0.0)
    library = rng.uniform(LOW, HIGH, (remembered, len(LOW)))
    return Image(MappingProxyType(parts), LOW, HIGH, REST, library, np.zeros((remembered, 3)))
