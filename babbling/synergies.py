"""Pairs of joints that move together, and what of all that pairs can do changes pressure one way and nothing else."""

from itertools import combinations

import numpy as np
from scipy.optimize import linprog

from babbling.axes import BoolArray, FloatArray

ALIKE = 0.5
"""Two joints are a pair if together they change what is not pressure by less than this share of what each does."""
STRAIN = 0.1
"""rad in a synergy that are worth one less of the greatest change of a load's share beside pressure, in units of the
greatest that pressure brings."""
FEW = 0.05
"""Pairs with less than this share of the strongest, in both synergies, have no part in them."""


def find_pairs(strain: FloatArray, carries: BoolArray) -> list[tuple[int, int, int]]:
    """Pairs (i, j, sign): i and sign j moved together strain the loads least, of (L, F) effects beside pressure."""
    free, size = set(np.flatnonzero(carries).tolist()), np.linalg.norm(strain, axis=0) + 1e-12
    left = {
        (i, j, sign): np.linalg.norm(strain[:, i] + sign * strain[:, j]) / np.hypot(size[i], size[j])
        for i, j in combinations(sorted(free), 2)
        for sign in (1, -1)
    }
    found = list[tuple[int, int, int]]()
    for i, j, sign in sorted(left, key=lambda pair: left[pair]):
        if {i, j} <= free and left[i, j, sign] < ALIKE:
            found.append((i, j, sign))
            free -= {i, j}
    return found


def least(effects: FloatArray, pressure: FloatArray, wanted: FloatArray) -> FloatArray:
    """(P,) shares of P pairs that change pressure (2, L) as wanted (2,), with the least sum of absolute shares, which
    is the fewest and strongest, and little `STRAIN` otherwise: a linear program; the largest is 1."""
    both = np.hstack([effects, -effects])
    patterns = np.asarray(np.linalg.pinv(pressure))
    most = -np.full((len(patterns), 1), np.abs(patterns @ wanted).max())
    beside = both - patterns @ (pressure @ both)
    cost = np.append(np.ones(both.shape[1]), STRAIN)
    bounds = np.vstack([np.hstack([beside, most]), np.hstack([-beside, most])])
    found = linprog(cost, bounds, np.zeros(len(bounds)), np.hstack([pressure @ both, np.zeros((2, 1))]), wanted).x
    share = found[: effects.shape[1]] - found[effects.shape[1] : -1]
    return np.asarray(share / np.abs(share).max())


def synergies(effects: FloatArray, pressure: FloatArray) -> FloatArray:
    """(2, P) shares of P pairs that change pressure along each direction, from their (L, P) effects on loads and (2, L)
    pressure: those few that do it with the `least`, each direction mended by the other's. Shares that differ little
    do so by noise and are made even: legs that sway far and not alike strain."""
    few = (np.abs([least(effects, pressure, one) for one in np.eye(2)]) > FEW).any(0)
    work = np.linalg.pinv(pressure @ effects * few).T
    work /= np.abs(work).max(1, keepdims=True)
    return np.where(np.abs(work) > ALIKE, np.sign(work), work)
