"""From places that one's parts are to come to, to sub-goals: postures by the learned image, and smooth ways."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.body_image import Image
from imitation.acting.primitives import LEFT, LOOK_AGAIN, NAMES, RIGHT, TOUCH, Plan, Thing
from imitation.acting.reaching import reach

MOST_SHIFT: Final = 0.04
"""m that a second look may change, at most."""


def postures(image: Image, planned: FloatArray, begin: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(W, N, F) postures for (W, N, P, 3) places from (N, F) on, and (N,) m that the worst will miss by.

    Where nothing is to be anywhere any more, one goes back to rest; arms that have nothing to do while the head leans
    forward go where they are comfortable.
    """
    found, worst, before = [], np.zeros(len(begin)), begin
    for targets in planned:
        idle = np.isnan(targets).all((-1, -2))
        before, miss = reach(image, targets, before)
        before[idle] = image.rest
        worst = np.maximum(worst, miss)
        found.append(before)
    return np.array(found), worst


def movement(ways: FloatArray, seconds: Sequence[float], begin: FloatArray, tick_s: float) -> FloatArray:
    """(T, N, F) minimum-jerk ways (Flash and Hogan 1985) through (W, N, F) postures, from (N, F) on."""
    pieces, before = [], begin
    for way, duration in zip(ways, seconds, strict=True):
        r = (np.arange(1, round(duration / tick_s) + 1) * tick_s / duration)[:, None, None]
        pieces.append(before + (way - before) * r**3 * (10 - 15 * r + 6 * r * r))
        before = way
    return np.concatenate(pieces)


def again(planned: Plan, thing: Thing, which: IntArray, palms: FloatArray, now: FloatArray) -> FloatArray:
    """The remaining (W, N, P, 3) places after a second look: what is carried hangs otherwise from the palm than it was
    meant to, and the other part may have moved.

    Args:
        planned: everything, as it was planned.
        thing: as it was seen before.
        which: (N,) primitives.
        palms: (N, P, 3) where one's parts are, by the learned image.
        now: (N, 2, 3) a and b as they are seen now; of what is hidden (NaN) it is believed that all is as it was meant.
    """
    left = planned.places[LOOK_AGAIN:].copy()
    rows = np.flatnonzero(np.isin(which, [NAMES.index("carry"), NAMES.index("carry and push")]))
    hand = np.where(thing.a[rows, 1] > 0, LEFT, RIGHT)
    meant = thing.a[rows] - planned.places[TOUCH, rows, hand]
    hangs = now[rows, 0] - palms[rows, hand]
    shift = np.clip((now[rows, 1] - thing.b[rows]) - (hangs - meant), -MOST_SHIFT, MOST_SHIFT) * (1, 1, 0)
    left[:, rows, hand] += np.nan_to_num(shift)
    return left
