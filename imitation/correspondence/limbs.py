"""One's own limbs, read off organ identification: which parts are decided together, by which senses, in what order.

A sense that moves two parts of which neither moves only what the other does (the waist moves both thighs) is *shared*;
parts moved by shared senses alone (the trunk) are decided first. The others fall into limbs: parts that have an own
sense in common. Within a limb a part moved by fewer senses lies nearer the torso and counts more, because what it gets
wrong everything beyond it inherits.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import connected_components

from babbling.axes import BoolArray, IntArray

TOLERANCE_DEG = (0.2, 0.9, 6.0)
"""How far a part is expected to miss because bodies differ, from the torso outwards; the last also for all beyond."""


@dataclass(frozen=True)
class OwnLimb:
    """parts: their numbers, from the torso outwards; tolerances: how far each may miss, rad; factors: (n,) senses that
    this limb decides."""

    parts: tuple[int, ...]
    tolerances: tuple[float, ...]
    factors: IntArray


def own_limbs(moves: BoolArray) -> tuple[OwnLimb, ...]:
    """Limbs in the order in which they are decided, from (P, F) which factor moves which part."""
    common, size = moves.astype(int) @ moves.T, moves.sum(1)
    nested = (common == size) | (common == size[:, None])
    own = moves & ~(moves[:, None] & moves & ~nested[..., None]).any((0, 1))
    trunk = moves.any(1) & ~own.any(1)
    return (*_limbs(np.flatnonzero(trunk), moves, size), *_limbs(np.flatnonzero(own.any(1)), own, size))


def _limbs(parts: IntArray, decides: BoolArray, size: IntArray) -> Iterator[OwnLimb]:
    """Of parts that have a sense (P, F) in common, directly or through others; `size` (P,) senses move each in all."""
    count, label = connected_components(decides[parts] @ decides[parts].T) if len(parts) else (0, parts)
    for number in range(count):
        group = parts[label == number]
        group = group[np.argsort(size[group], kind="stable")]
        rank = np.unique(size[group], return_inverse=True)[1]
        tolerances = np.deg2rad(TOLERANCE_DEG)[np.minimum(rank, len(TOLERANCE_DEG) - 1)]
        yield OwnLimb(tuple(group.tolist()), tuple(tolerances.tolist()), np.flatnonzero(decides[group].any(0)))
