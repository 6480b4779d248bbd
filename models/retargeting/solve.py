"""Inverse kinematics, frame by frame: the posture whose segments point most nearly where they should.

For each frame, min over q of sum_s w_s |direction_s(q) - wanted_s|^2 + sum_j e_j (q_j - rest_j)^2 within the joint
ranges, by Levenberg-Marquardt with the joints that lean on their stops held there (projected Newton; Bertsekas 1982).
All frames are solved together; frames that end away from their target try again from other postures. Such frames have
several optima about as good (a leg lifted too high can lean either way), and the path through them that jumps least
is taken.
"""

import numpy as np
from numpy.typing import NDArray

from models.retargeting.chain import Chain

Array = NDArray[np.float64]
JUMP = 0.5
"""What a squared jump between frames (rad^2) counts against a weighted squared error."""
STEPS = 25
TOLERANCE = 1e-5
"""Smallest relative gain for which a frame goes on."""
GOOD_ENOUGH = 1e-4
"""Weighted squared error above which a frame tries other starts (about half a degree of the outermost part)."""
STARTS = (0.2, 0.5, 0.8)
"""Other starts: every joint at this share of its range, alternately counted from the other end."""


def solve(chain: Chain, wanted: Array, weights: Array, rest: Array, stiffness: Array, jump: float = JUMP) -> Array:
    """Postures (T, n) for wanted directions (T, S, 3).

    weights (S,): of the squared errors; rest (n,): radians; stiffness (n,): e above; jump: what a squared
    jump between frames counts, 0 for frames that have nothing to do with each other.
    """
    first = np.tile(np.clip(rest, chain.low, chain.high), (len(wanted), 1))
    angles, cost = _descend(chain, wanted, weights, rest, stiffness, first)
    off = np.flatnonzero(cost > GOOD_ENOUGH * weights.min())
    found, costs = [angles], [cost]
    for start in _other_starts(chain) if len(off) else []:
        angles, cost = found[0].copy(), np.full(len(wanted), np.inf)
        angles[off], cost[off] = _descend(chain, wanted[off], weights, rest, stiffness, np.tile(start, (len(off), 1)))
        found.append(angles)
        costs.append(cost)
    return _smoothest(np.array(found), np.array(costs), jump)


def _smoothest(found: Array, costs: Array, jump: float) -> Array:
    """Through one of K postures per frame, (K, T, n) at costs (K, T), the path of least cost + jump |change|^2."""
    total = costs[:, 0]
    came_from = np.zeros(costs.shape, dtype=int)
    for frame in range(1, costs.shape[1]):
        change = ((found[None, :, frame] - found[:, None, frame - 1]) ** 2).sum(axis=2)
        ways = total[:, None] + jump * change
        came_from[:, frame] = ways.argmin(axis=0)
        total = ways.min(axis=0) + costs[:, frame]
    path = np.empty(costs.shape[1], dtype=int)
    path[-1] = total.argmin()
    for frame in range(costs.shape[1] - 1, 0, -1):
        path[frame - 1] = came_from[path[frame], frame]
    return np.asarray(found[path, np.arange(costs.shape[1])])


def _other_starts(chain: Chain) -> list[Array]:
    odd = np.arange(len(chain.low)) % 2 == 1
    shares = [np.where(odd, 1 - share, share) for share in STARTS]
    shares += [np.full(len(odd), share) for share in STARTS if share != 0.5]
    return [chain.low + share * (chain.high - chain.low) for share in shares]


def _cost(
    chain: Chain, angles: Array, wanted: Array, weights: Array, rest: Array, stiffness: Array
) -> tuple[Array, Array, Array]:
    """Cost (T,), residual (T, S, 3) and its derivative (T, S, 3, n)."""
    found, slope = chain.directions(angles)
    residual = found - wanted
    cost = np.einsum("tsi,s->t", residual**2, weights) + (stiffness * (angles - rest) ** 2).sum(axis=1)
    return cost, residual, slope


def _descend(
    chain: Chain, wanted: Array, weights: Array, rest: Array, stiffness: Array, angles: Array
) -> tuple[Array, Array]:
    """Local optimum from given postures, and its cost."""
    size = angles.shape[1]
    damping = np.full(len(angles), 1e-2)
    cost, residual, slope = _cost(chain, angles, wanted, weights, rest, stiffness)
    active = np.arange(len(angles))
    for _ in range(STEPS):
        here, part = angles[active], slope[active]
        weighted = part * weights[None, :, None, None]
        gradient = np.einsum("tsin,tsi->tn", weighted, residual[active]) + stiffness * (here - rest)
        matrix = np.einsum("tsin,tsim->tnm", weighted, part)
        held = ((here <= chain.low) & (gradient > 0)) | ((here >= chain.high) & (gradient < 0))
        gradient[held] = 0
        free = ~held
        matrix *= free[:, :, None] & free[:, None, :]
        diagonal = np.einsum("tnn->tn", matrix)
        lift = damping[active, None] * (diagonal + 1e-2 * diagonal.max(axis=1, keepdims=True)) + stiffness
        matrix = matrix + (lift + held)[:, :, None] * np.eye(size)
        step = np.linalg.solve(matrix, gradient[:, :, None])[:, :, 0]
        trial = np.clip(here - step, chain.low, chain.high)
        found = _cost(chain, trial, wanted[active], weights, rest, stiffness)
        better = found[0] < cost[active]
        moved = active[better]
        drop = cost[moved] - found[0][better]
        angles[moved], cost[moved] = trial[better], found[0][better]
        residual[moved], slope[moved] = found[1][better], found[2][better]
        damping[active] *= np.where(better, 0.2, 6)
        going = np.ones(len(active), dtype=bool)
        going[better] = drop > TOLERANCE * cost[moved]
        going &= damping[active] < 1e8
        active = active[going]
        if not len(active):
            break
    return angles, cost
