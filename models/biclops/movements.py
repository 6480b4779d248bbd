"""What a teacher's head does: nod, shake, look around, and random sequences of looks; angles over time.

Every movement starts and ends at rest, straight ahead, and stays within the unit's speed and acceleration (facts.py).
"""

from collections.abc import Callable
from types import MappingProxyType

import numpy as np

from models.arrays import FloatArray
from models.biclops.facts import MAX_ACCELERATION_DEG_S2
from models.errors import BodyError, unknown

TICK_S = 0.02
SHARE = 0.75
"""Of the run profile's acceleration that a teacher uses."""
PEAK = 10.0 / np.sqrt(3.0)
"""Peak acceleration of a minimum-jerk move is PEAK D / T^2 (Flash and Hogan 1985)."""
PAN_DEG, TILT_DEG = 26.0, 16.0
"""Largest looks aside, up and down."""
PAUSE_S = (0.05, 0.5)


def through(postures: FloatArray, pauses: FloatArray, hurry: FloatArray | None = None) -> FloatArray:
    """(T, 2) pan and tilt, rad, through (N, 2) postures in degrees by minimum-jerk moves with (N,) pauses after each.

    Each move is as quick as `SHARE` of the accelerations allows, times 1 / `hurry` (N - 1,), 0 < hurry <= 1.
    """
    limit = SHARE * np.array(MAX_ACCELERATION_DEG_S2)
    pace = np.ones(len(postures) - 1) if hurry is None else hurry
    parts = [np.repeat(postures[:1], round(pauses[0] / TICK_S) + 1, axis=0)]
    for start, end, pause, quick in zip(postures[:-1], postures[1:], pauses[1:], pace, strict=True):
        seconds = max(np.sqrt(PEAK * np.abs(end - start) / limit).max(), 0.3) / quick
        count = max(int(np.ceil(seconds / TICK_S)), 2)
        r = (np.arange(1, count + 1) / count)[:, None]
        parts.append(start + (end - start) * r**3 * (10 - 15 * r + 6 * r**2))
        parts.append(np.repeat(end[None], round(pause / TICK_S), axis=0))
    return np.asarray(np.deg2rad(np.concatenate(parts)))


def nod(rng: np.random.Generator) -> FloatArray:
    """Yes: down and up three times."""
    depth = rng.uniform(8, 12)
    return _tour([(0, depth), (0, -0.4 * depth)] * 3)


def shake(rng: np.random.Generator) -> FloatArray:
    """No: from side to side three times."""
    width = rng.uniform(14, 22)
    return _tour([(width, 0), (-width, 0)] * 3)


def look_around(rng: np.random.Generator) -> FloatArray:
    """Up left, right, down and back."""
    jitter = rng.uniform(0.85, 1.0, (4, 2))
    return _tour(np.array([(22, -8), (-24, -4), (-10, 14), (12, 10)]) * jitter, pause=0.3)


def random_looks(rng: np.random.Generator) -> FloatArray:
    """Four random looks, at random paces."""
    looks = rng.uniform(-1, 1, (4, 2)) * (PAN_DEG, TILT_DEG)
    postures = np.vstack([(0, 0), looks, (0, 0)])
    pauses = np.concatenate([[0.3], rng.uniform(*PAUSE_S, 4), [0.3]])
    return through(postures, pauses, rng.uniform(0.6, 1.0, 5))


def _tour(looks: object, pause: float = 0.0) -> FloatArray:
    postures = np.vstack([(0, 0), np.asarray(looks, float), (0, 0)])
    pauses = np.full(len(postures), pause)
    pauses[[0, -1]] = 0.3
    return through(postures, pauses)


MOVEMENTS: MappingProxyType[str, Callable[[np.random.Generator], FloatArray]] = MappingProxyType(
    {"nod": nod, "shake": shake, "look_around": look_around, "random": random_looks}
)
"""Every movement a teacher knows."""


def movement(name: str, rng: np.random.Generator) -> FloatArray:
    """(T, 2) pan and tilt every 20 ms, rad.

    Raises:
        BodyError: no such movement.
    """
    if name not in MOVEMENTS:
        raise BodyError(unknown("head movement", name, MOVEMENTS))
    return MOVEMENTS[name](rng)
