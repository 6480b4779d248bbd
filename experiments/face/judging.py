"""What a judge sees of a face who is not told what was shown to it: labels, organs, and how well it matched."""

from functools import lru_cache
from typing import Final

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.relations import RELATIONS
from experiments.face.theories import GESTURES
from imitation.correspondence.own_acts import OwnActs

ORGANS: Final = ("jaw", "tongue", "lips", "brows", "head")
WHOSE: Final = (*ORGANS, "nothing")
"""Whose act it may be; nobody's, last."""
_OF_JOINT: Final = np.array([0, 1, 1, 1, 2, 3, 4, 4])
"""Organ that each joint of a face belongs to."""
ORGAN_SHOWN: Final = np.array([1, 1, 0, 2, 3, 4])
"""Of each gesture."""
MAIN: Final = np.array([RELATIONS.index(name) for name in ("beyond", "side", "gap", "purse", "brow", "turn")])
"""Relation that each gesture is about."""
RANGE: Final = np.array([0.83, 0.96, 0.64, 0.47, 0.23, 0.31, 0.67, 0.44])
"""Of each relation in a newborn's face, widths of the mouth and quarter turns: what shares are shares of."""
OPEN, OUT, ASIDE, LEAST = 0.1, -0.02, 0.055, 0.1
"""Widths of the mouth from which it is open, the tongue beyond the lips, to the side; share of a range from which
anything counts."""


def labels(relations: FloatArray) -> IntArray:
    """(...) number of the gesture that (..., 8) true relations look like, from rest; 6 is nothing."""
    share = np.abs(relations) / RANGE
    head = np.maximum(share[..., 6], share[..., 7])
    seen = np.stack([share[..., 0], share[..., 4], 2 * share[..., 5], 2 * head], axis=-1)  # brows and head go both ways
    found = np.where(seen.max(-1) > LEAST, np.array([2, 3, 4, 5])[seen.argmax(-1)], len(GESTURES))
    tongue = (relations[..., 0] > OPEN) & (relations[..., 1] > OUT)
    return np.where(tongue, np.where(np.abs(relations[..., 2]) > ASIDE, 1, 0), found)


def organs(acts: OwnActs, probability: FloatArray, joints: IntArray) -> FloatArray:
    """(..., 6) P(organ), nothing last, of (..., H) P(motors moved); where several moved, in equal shares, and the mouth
    counts only where nothing else did.

    Args:
        acts: whose hypotheses they are.
        probability: over `acts.acts`.
        joints: (M,) joint that each motor moves.
    """
    return np.asarray(probability @ _shares(tuple(one.motors for one in acts.acts), tuple(joints.tolist())))


@lru_cache(maxsize=64)
def _shares(sets: tuple[tuple[int, ...], ...], joints: tuple[int, ...]) -> FloatArray:
    """(H, 6) how much of each set of motors is each organ's."""
    shares = np.zeros((len(sets), len(WHOSE)))
    for row, motors in zip(shares, sets, strict=True):
        moved = {int(_OF_JOINT[joints[motor]]) for motor in motors}
        moved = moved - {0} or moved or {len(ORGANS)}
        row[list(moved)] = 1 / len(moved)
    return shares


def largest_change(relations: FloatArray, still: FloatArray) -> IntArray:
    """(...) organ whose relation changed most, as a share of its range: the peer that weighs no hypotheses."""
    share = np.abs(relations - still) / RANGE
    return np.asarray(_OF_JOINT[share.argmax(-1)])
