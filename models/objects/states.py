"""What became of an object: its states, by which a child would name them, from what was seen of it.

The very same functions are given noisy sightings by the mind and the simulated object's own places by those who judge.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import BoolArray, FloatArray, IntArray

STATES: Final = ("same", "moved", "up", "apart", "joined", "lit by hand", "lit by head", "buzz")
SAME, MOVED, UP, APART, JOINED, LIT_BY_HAND, LIT_BY_HEAD, BUZZ = range(len(STATES))
MOVED_M: Final = 0.02
"""m along the table that an object lies elsewhere by."""
UP_M: Final = 0.025
"""m that it is lifted."""
APART_M: Final = 0.02
"""m that its ends are further from each other."""
HEAD: Final = 2
"""Of the three parts that handle things, the one that is no hand."""


@dataclass(frozen=True)
class Watched:
    """B objects over T looks, the first before anything is done to them, the last after all is done."""

    handles: FloatArray
    """(T, B, 2, 3) m, table frame: the middles of the two parts that it is known by."""
    parts: FloatArray
    """(T, B, 3, 3) m: left hand, right hand and forehead of whoever handles it."""
    signal: BoolArray
    """(T, B) whether it shines or buzzes."""
    touch: FloatArray | None = None
    """(T, B, 3) N that left hand, right hand and forehead felt since the look before; None of somebody whom one only
    sees."""


def handled(seen: Watched) -> IntArray:
    """(B,) same, moved or up: what may become of anything."""
    place = seen.handles[:, :, 0]
    found = np.full(place.shape[1], SAME)
    found[np.linalg.norm((place[-1] - place[0])[:, :2], axis=1) > MOVED_M] = MOVED
    found[(place[..., 2] - place[0, :, 2]).max(0) > UP_M] = UP
    return found


def pulled(seen: Watched) -> IntArray:
    """(B,) whether its ends came apart, or else what may become of anything."""
    ends = np.linalg.norm(seen.handles[:, :, 0] - seen.handles[:, :, 1], axis=-1)
    return np.where(ends[-1] - ends[0] > APART_M, APART, handled(seen))


def joined(seen: Watched, within: float) -> IntArray:
    """(B,) whether the first part ended around (or in) the second, at most `within` m from its middle line and lower
    than its middle."""
    away = seen.handles[-1, :, 0] - seen.handles[-1, :, 1]
    there = (np.linalg.norm(away[:, :2], axis=1) < within) & (away[:, 2] < 0)
    return np.where(there, JOINED, handled(seen))


def lit(seen: Watched) -> IntArray:
    """(B,) whether it shone, and by which part: the one that felt most as it lit up; of somebody whom one only sees, of
    those that show, the one that was nearest."""
    copies, first = np.arange(seen.signal.shape[1]), seen.signal.argmax(0)
    away = np.linalg.norm(seen.parts - seen.handles[:, :, :1], axis=-1)[first, copies]
    part = np.nan_to_num(away, nan=np.inf).argmin(-1)
    if seen.touch is not None:
        felt = seen.touch[first, copies]
        part = np.where(felt.max(-1) > 0, felt.argmax(-1), part)
    return np.where(seen.signal.any(0), np.where(part == HEAD, LIT_BY_HEAD, LIT_BY_HAND), SAME)


def buzzed(seen: Watched) -> IntArray:
    """(B,) whether it buzzed, or else what may become of anything."""
    return np.where(seen.signal.any(0), BUZZ, handled(seen))


EITHER: Final = {"lit": (LIT_BY_HAND, LIT_BY_HEAD)}
"""What one may want besides a state: any of several."""
