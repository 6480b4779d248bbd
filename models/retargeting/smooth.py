"""The smoothest movement that still shows every direction inverse kinematics found.

Over a whole movement of one limb, min over q(t) of

    sum_t sum_s w_st |direction_s(q_t) - found_st|^2  +  m sum_t |third difference of q|^2
                                                      +  c sum_t |speed beyond its limit|^2

within the joint ranges. The middle term alone makes a sixth-order low-pass without delay, whose cut-off sets m; it also
carries a joint smoothly through postures in which it changes no direction (a straight arm's twist). Where smoothing
moves a reachable direction too far, that frame's w grows; c grows until speeds keep the limit to a hundredth, and the
rest is cut to the nearest movement that keeps it.

Gauss-Newton on a banded system: the time grows with the number of frames, not with its square.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

from models.retargeting.chain import Chain

Array = NDArray[np.float64]
CUT_OFF_HZ = 8.0
"""Human limbs move below this; noise of motion capture and of corners at joint stops lies above."""
TUBE = np.deg2rad(0.8)
"""Reachable directions are held as hard as it takes to stay about this near."""
PROMISE = np.deg2rad(0.95)
"""No reachable direction is left further away than this, unless a joint is at its speed limit."""
SPEED_SHARE = 0.96
"""Share of the speed limit that is used; the rest is for what happens between samples."""
REST = 1e-6
OUT_OF_REACH = 0.1
"""What directions count that are out of reach anyway, against those that are not."""
REACH = 5
"""Frames before and after a joint at its speed limit in which directions may come early or late."""
ROUNDS = 30
STEPS = 12


@dataclass(frozen=True, eq=False)
class Smoothed:
    """angles (T, n) radians, and (T,) the frames near which a joint works at its speed limit."""

    angles: Array
    hurried: NDArray[np.bool_]


def smooth(
    chain: Chain, start: Array, weights: Array, holding: NDArray[np.bool_], rest: Array, speed: Array, dt: float
) -> Smoothed:
    """Smooth postures (T, n) found frame by frame.

    weights (S,): what each direction counts where not all can be had in time; holding (T, S): directions that must
    stay within a degree; speed (n,): limits in rad/s; dt: seconds per frame.
    """
    found, _ = chain.directions(start)
    least = weights * np.where(holding, 1.0, OUT_OF_REACH)
    hold = least
    bending = (2 * np.sin(np.pi * CUT_OFF_HZ * dt)) ** -6
    step_limit = SPEED_SHARE * speed * dt
    angles, brake = start, 1.0
    hurried = np.zeros(len(start), dtype=bool)
    for _ in range(ROUNDS):
        angles = _descend(chain, angles, found, hold, brake, step_limit, bending, rest)
        away = np.linalg.norm(chain.directions(angles)[0] - found, axis=2)
        excess = np.abs(np.diff(angles, axis=0)) / step_limit - 1
        fast = (excess > -1e-3).any(axis=1)
        hurried[1:] |= fast
        hurried[:-1] |= fast
        held = holding & ~_widened(hurried, REACH)[:, None]
        if excess.max() < 0.01 and away[held].max(initial=0) < PROMISE:
            break
        hold[held] *= away[held] / TUBE
        hold = np.maximum(hold, least)
        if excess.max() >= 0.01:
            brake *= 5
    return Smoothed(_within_speed(angles, step_limit), _widened(hurried, REACH))


def _widened(where: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """True also `reach` frames before and after each true one (first axis)."""
    wide = where.copy()
    for shift in range(1, reach + 1):
        wide[shift:] |= where[:-shift]
        wide[:-shift] |= where[shift:]
    return wide


def _within_speed(angles: Array, step: Array) -> Array:
    """The movement nearest in the largest difference that moves at most `step` (n,) per frame.

    Halfway between the lowest such movement above all angles and the highest below them.
    """
    above, below = angles.copy(), angles.copy()
    for frame in range(1, len(angles)):
        above[frame] = np.maximum(above[frame], above[frame - 1] - step)
        below[frame] = np.minimum(below[frame], below[frame - 1] + step)
    for frame in range(len(angles) - 2, -1, -1):
        above[frame] = np.maximum(above[frame], above[frame + 1] - step)
        below[frame] = np.minimum(below[frame], below[frame + 1] + step)
    return np.asarray((above + below) / 2)


def _descend(
    chain: Chain,
    angles: Array,
    found: Array,
    weights: Array,
    brake: float,
    limit: Array,
    bending: float,
    rest: Array,
) -> Array:
    """Local optimum of the smoothing cost, from given angles."""

    def cost_of(trial: Array) -> tuple[float, Array, Array]:
        shown, slope = chain.directions(trial)
        residual = shown - found
        cost = np.sum(weights[:, :, None] * residual**2) + bending * np.sum(np.diff(trial, 3, axis=0) ** 2)
        cost += brake * np.sum(_excess(trial, limit) ** 2) + REST * np.sum((trial - rest) ** 2)
        return float(cost), residual, slope

    cost, residual, slope = cost_of(angles)
    for _ in range(STEPS):
        weighted = slope * weights[:, :, None, None]
        gradient = np.einsum("tsin,tsi->tn", weighted, residual) + REST * (angles - rest)
        excess = brake * _excess(angles, limit)
        gradient += bending * _third_gram(angles) - np.diff(np.pad(excess, ((1, 1), (0, 0))), axis=0)
        brakes = np.where(excess != 0, brake, 0)
        blocks = np.einsum("tsin,tsim->tnm", weighted, slope)
        held = ((angles <= chain.low) & (gradient > 0)) | ((angles >= chain.high) & (gradient < 0))
        step = solveh_banded(
            _banded(blocks, brakes, bending, held), np.where(held, 0, gradient).ravel(), lower=True
        ).reshape(angles.shape)
        share = 1.0
        while share > 1e-3:
            trial = np.clip(angles - share * step, chain.low, chain.high)
            trial_cost, trial_residual, trial_slope = cost_of(trial)
            if trial_cost < cost:
                break
            share /= 2
        else:
            break
        gain = cost - trial_cost
        angles, cost, residual, slope = trial, trial_cost, trial_residual, trial_slope
        if gain < 1e-4 * cost + 1e-10:
            break
    return angles


def _third_gram(angles: Array) -> Array:
    """D'D q for third differences D."""
    third = np.diff(angles, 3, axis=0)
    return np.asarray(-np.diff(np.pad(third, ((3, 3), (0, 0))), 3, axis=0))


def _excess(angles: Array, limit: Array) -> Array:
    """What each step (T-1, n) has beyond the limit (n,), signed."""
    step = np.diff(angles, axis=0)
    return np.asarray(step - np.clip(step, -limit, limit))


def _banded(blocks: Array, brakes: Array, bending: float, held: NDArray[np.bool_]) -> Array:
    """The Gauss-Newton matrix in lower banded form; rows and columns of held angles become the identity's."""
    count, size = held.shape
    bands = np.zeros((3 * size + 1, count, size))
    for below in range(size):
        for column in range(size - below):
            bands[below, :, column] = blocks[:, column + below, column]
    bands[0] += REST
    bands[0, :-1] += brakes
    bands[0, 1:] += brakes
    bands[size, :-1] -= brakes
    stencil = np.array([-1.0, 3.0, -3.0, 1.0])
    for first in range(4):
        for second in range(first, 4):
            value = bending * stencil[first] * stencil[second]
            bands[(second - first) * size, first : count - 3 + first] += value
    flat, fixed = bands.reshape(3 * size + 1, -1), held.ravel()
    for below in range(3 * size + 1):
        length = flat.shape[1] - below
        flat[below, :length][fixed[:length] | fixed[below:]] = 0
    flat[0][fixed] = 1
    return flat
