"""One's own limbs, read off organ identification: which parts are decided together, by which senses, in what order.

A sense that moves two parts of which neither moves only what the other does (the waist moves both thighs) is *shared*;
parts moved by shared senses alone (the trunk) are decided first. The others fall into limbs: parts that have an own
sense in common. Within a limb a part moved by fewer senses lies nearer the torso and counts more, because what it gets
wrong everything beyond it inherits.
"""

from dataclasses import dataclass

import numpy as np

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
    sets = [frozenset(np.flatnonzero(row).tolist()) for row in moves]
    shared = {
        factor
        for a in sets
        for b in sets
        if not (a <= b or b <= a)
        for factor in a & b
    }  # fmt: skip
    first = [p for p, joints in enumerate(sets) if joints and joints <= shared]
    limbs = [_limb(group, sets, frozenset()) for group in _groups(first, sets, frozenset())]
    rest = [p for p, joints in enumerate(sets) if joints - shared]
    limbs += [_limb(group, sets, frozenset(shared)) for group in _groups(rest, sets, frozenset(shared))]
    return tuple(limbs)


def _groups(parts: list[int], sets: list[frozenset[int]], without: frozenset[int]) -> list[list[int]]:
    """Parts that have a sense in common, directly or through others."""
    groups: list[tuple[list[int], set[int]]] = []
    for part in parts:
        own = set(sets[part] - without)
        near = [group for group in groups if group[1] & own]
        groups = [group for group in groups if not group[1] & own]
        groups.append(([p for group in near for p in group[0]] + [part], own.union(*(group[1] for group in near))))
    return [sorted(members) for members, _ in groups]


def _limb(group: list[int], sets: list[frozenset[int]], without: frozenset[int]) -> OwnLimb:
    order = sorted(group, key=lambda part: (len(sets[part]), part))
    sizes = sorted({len(sets[part]) for part in order})
    ranks = [min(sizes.index(len(sets[part])), len(TOLERANCE_DEG) - 1) for part in order]
    tolerances = tuple(float(np.deg2rad(TOLERANCE_DEG[rank])) for rank in ranks)
    factors = sorted(set().union(*(sets[part] for part in order)) - without)
    return OwnLimb(tuple(order), tolerances, np.array(factors, np.int64))
