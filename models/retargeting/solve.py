"""Inverse kinematics, frame by frame: the posture whose segments point most nearly where they should.

For each frame, min over q of sum_s w_s |direction_s(q) - wanted_s|^2 + e |q - rest|^2 within the joint ranges, by
Levenberg-Marquardt with the joints that lean on their stops held there (projected Newton; Bertsekas 1982).
All frames are solved together; frames that end away from their target try again from other postures.
"""

import numpy as np
from numpy.typing import NDArray

from models.retargeting.chain import Chain

Array = NDArray[np.float64]
REST = 1e-8
"""e: pull towards rest, only felt where a joint changes no direction (a twist of a straight arm)."""
STEPS = 40
GOOD_ENOUGH = 1e-4
"""Weighted squared error above which a frame tries other starts (about half a degree of the outermost part)."""
STARTS = (0.1, 0.35, 0.65, 0.9)
"""Other starts: every joint at this share of its range, alternately counted from the other end."""


def solve(chain: Chain, wanted: Array, weights: Array, rest: Array) -> Array:
    """Postures (T, n) for wanted directions (T, S, 3); weights (S,) of the squared errors; rest (n,) radians."""
    start = np.clip(rest, chain.low, chain.high)
    best, cost = _descend(chain, wanted, weights, rest, np.tile(start, (len(wanted), 1)))
    for start in _other_starts(chain):
        off = np.flatnonzero(cost > GOOD_ENOUGH * weights.min())
        if not len(off):
            break
        tried, tried_cost = _descend(chain, wanted[off], weights, rest, np.tile(start, (len(off), 1)))
        better = tried_cost < cost[off] * (1 - 1e-3)
        best[off[better]], cost[off[better]] = tried[better], tried_cost[better]
    return best


def _other_starts(chain: Chain) -> list[Array]:
    odd = np.arange(len(chain.low)) % 2 == 1
    shares = [np.where(odd, 1 - share, share) for share in STARTS] + [np.full(len(odd), s) for s in STARTS]
    return [chain.low + share * (chain.high - chain.low) for share in shares]


def _cost(chain: Chain, angles: Array, wanted: Array, weights: Array, rest: Array) -> tuple[Array, Array, Array]:
    """Cost (T,), residual (T, S, 3) and its derivative (T, S, 3, n)."""
    found, slope = chain.directions(angles)
    residual = found - wanted
    cost = np.einsum("tsi,s->t", residual**2, weights) + REST * ((angles - rest) ** 2).sum(axis=1)
    return cost, residual, slope


def _descend(chain: Chain, wanted: Array, weights: Array, rest: Array, angles: Array) -> tuple[Array, Array]:
    """Local optimum from given postures, and its cost."""
    size = angles.shape[1]
    damping = np.full(len(angles), 1e-2)
    cost, residual, slope = _cost(chain, angles, wanted, weights, rest)
    active = np.arange(len(angles))
    for _ in range(STEPS):
        here, part = angles[active], slope[active]
        weighted = part * weights[None, :, None, None]
        gradient = np.einsum("tsin,tsi->tn", weighted, residual[active]) + REST * (here - rest)
        matrix = np.einsum("tsin,tsim->tnm", weighted, part)
        held = ((here <= chain.low) & (gradient > 0)) | ((here >= chain.high) & (gradient < 0))
        gradient[held] = 0
        free = ~held
        matrix *= free[:, :, None] & free[:, None, :]
        diagonal = np.einsum("tnn->tn", matrix)
        lift = damping[active, None] * (diagonal + 1e-2 * diagonal.max(axis=1, keepdims=True)) + REST
        matrix = matrix + (lift + held)[:, :, None] * np.eye(size)
        step = np.linalg.solve(matrix, gradient[:, :, None])[:, :, 0]
        trial = np.clip(here - step, chain.low, chain.high)
        found = _cost(chain, trial, wanted[active], weights, rest)
        better = found[0] < cost[active]
        moved = active[better]
        drop = cost[moved] - found[0][better]
        angles[moved], cost[moved] = trial[better], found[0][better]
        residual[moved], slope[moved] = found[1][better], found[2][better]
        damping[active] *= np.where(better, 0.2, 6)
        going = np.ones(len(active), dtype=bool)
        going[better] = drop > 1e-12 * weights.min()
        going &= damping[active] < 1e8
        active = active[going]
        if not len(active):
            break
    return angles, cost
