"""From postures found frame by frame to sub-goals that a body can follow.

Over a whole movement of one limb, min over q(t) of

    sum_t sum_s h_ts |direction_s(q_t) - direction_s(p_t)|^2  +  m sum_t |third difference of q|^2
                        +  PULL sum_t |q_t - p_t|^2           +  c sum_t |speed beyond its limit|^2

inside the range of the senses, p(t) the postures found. m makes the second term a low-pass without delay at CUT_OFF_HZ;
it also carries a limb smoothly through postures in which a sense changes nothing that is seen, and PULL keeps it from
swinging far out there. h grows where a direction that can be shown is moved by more than TUBE; c grows until the speed
limit holds, and what is left is cut. Gauss-Newton on a banded system.

Where that would cut the shape, the movement is slowed: by the least factor at which no direction that can be shown is
moved by more than CUT, or by what is in doubt of it. A leap, which the slowest would not follow, is cut all the same.
"""

import numpy as np
from scipy.linalg import solveh_banded
from scipy.ndimage import binary_dilation, binary_opening

from babbling.axes import BoolArray, FloatArray
from imitation.correspondence.inversion import LimbView
from imitation.correspondence.steadying import third_gram

CUT_OFF_HZ = 8.0
"""Limbs of humans move more slowly than this."""
TUBE, PROMISE = np.deg2rad(0.15), np.deg2rad(0.2)
"""Directions that can be shown are held as hard as it takes to stay this near; further off than PROMISE goes on."""
CUT = np.deg2rad(1.0)
SPEED_SHARE = 0.96
"""Share of the speed limit that sub-goals use."""
SLOWEST, HALVINGS = 4.0, 7
"""No movement is slowed by more, and the factor is found to a hundredth."""
LEAP = 2
"""Longest leap, ticks: what is too fast for longer is a movement."""
HURRY = 5
"""Ticks before and after a sense at its speed limit in which directions may come early or late."""
PULL = 1e-5
ROUNDS, STEPS = 10, 8


def smooth_path(
    view: LimbView,
    start: FloatArray,
    weights: FloatArray,
    holding: BoolArray,
    doubt: FloatArray,
    speed: FloatArray,
    tick_s: float,
) -> tuple[FloatArray, float]:
    """Smooth postures (T, n), and by how much slower than they were seen they are to be taken: 1 to SLOWEST.

    weights (T, S): of squared errors; holding (T, S): directions that can be shown and were seen; doubt (S,):
    what is not known of them anyway, rad; speed (n,): rad/s.
    """
    limit = SPEED_SHARE * speed * tick_s
    hurry = (np.abs(np.diff(start, axis=0)) / limit).max(1)
    leaping, rows = hurry > SLOWEST, np.arange(len(start))
    leaps = np.flatnonzero(leaping & ~binary_opening(leaping, np.ones(LEAP + 1)))
    away_from = np.abs(rows[:, None] - leaps - 0.5) > HURRY + hurry[leaps] / 2  # a leap takes time before and after
    kept = holding & away_from.all(1)[:, None]
    found, _ = view.directions(start, rows)

    def slower(factor: float) -> tuple[FloatArray, bool]:
        angles = _limited(view, start, found, weights, holding, doubt, factor * limit, tick_s)
        away = np.linalg.norm(view.directions(angles, rows)[0] - found, axis=2)
        return angles, bool((away - np.maximum(CUT, PROMISE + 1.5 * doubt))[kept].max(initial=-1) <= 0)

    angles, whole = slower(1.0)
    if whole:
        return angles, 1.0
    (angles, _), least, most = slower(SLOWEST), 1.0, SLOWEST
    for _ in range(HALVINGS):
        factor = float(np.sqrt(least * most))
        trial, whole = slower(factor)
        if whole:
            angles, most = trial, factor
        else:
            least = factor
    return angles, most


def _limited(
    view: LimbView,
    start: FloatArray,
    found: FloatArray,
    weights: FloatArray,
    holding: BoolArray,
    doubt: FloatArray,
    limit: FloatArray,
    tick_s: float,
) -> FloatArray:
    """Smooth postures (T, n) for `found` directions, of steps up to `limit` (n,)."""
    rows = np.arange(len(start))
    hold = np.sqrt(weights)
    bending = (2 * np.sin(np.pi * CUT_OFF_HZ * tick_s)) ** -6
    tube, promise = TUBE + doubt, PROMISE + 1.5 * doubt
    angles, brake = start, 1.0
    for _ in range(ROUNDS):
        angles = _descend(view, angles, start, found, hold, brake, limit, bending)
        away = np.linalg.norm(view.directions(angles, rows)[0] - found, axis=2)
        excess = np.abs(np.diff(angles, axis=0)) / limit - 1
        fast = (excess > -1e-3).any(1)
        hurried = binary_dilation(np.append(fast, False) | np.append(False, fast), iterations=HURRY)
        held = holding & ~hurried[:, None]
        if excess.max() < 0.01 and (away - promise)[held].max(initial=-1) < 0:
            break
        hold = np.where(held, np.maximum(hold * away / tube, hold / 2), hold)
        hold = np.clip(hold, np.sqrt(weights), 1e6)
        brake *= 5 if excess.max() >= 0.01 else 1
    return within_speed(angles, limit)


def _descend(
    view: LimbView,
    angles: FloatArray,
    start: FloatArray,
    found: FloatArray,
    hold: FloatArray,
    brake: float,
    limit: FloatArray,
    bending: float,
) -> FloatArray:
    rows = np.arange(len(angles))

    def cost_of(trial: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        shown, slope = view.directions(trial, rows)
        miss = shown - found
        cost = (hold * (miss**2).sum(-1)).sum() + bending * (np.diff(trial, 3, axis=0) ** 2).sum()
        cost += brake * (_excess(trial, limit) ** 2).sum() + PULL * ((trial - start) ** 2).sum()
        return float(cost), miss, slope

    cost, miss, slope = cost_of(angles)
    for _ in range(STEPS):
        weighted = (slope * hold[:, :, None, None]).reshape(len(angles), -1, angles.shape[1])
        flat = slope.reshape(weighted.shape)
        gradient = (weighted.swapaxes(1, 2) @ miss.reshape(len(angles), -1, 1))[..., 0] + PULL * (angles - start)
        third = np.diff(angles, 3, axis=0)
        gradient += bending * -np.diff(np.pad(third, ((3, 3), (0, 0))), 3, axis=0)
        excess = brake * _excess(angles, limit)
        gradient -= np.diff(np.pad(excess, ((1, 1), (0, 0))), axis=0)
        held = ((angles <= view.low) & (gradient > 0)) | ((angles >= view.high) & (gradient < 0))
        bands = _banded(weighted.swapaxes(1, 2) @ flat, np.where(excess != 0, brake, 0.0), bending, held)
        step = solveh_banded(bands, np.where(held, 0, gradient).ravel(), lower=True).reshape(angles.shape)
        share = 1.0
        while share > 1e-2:
            trial = np.clip(angles - share * step, view.low, view.high)
            other = cost_of(trial)
            if other[0] < cost:
                break
            share /= 3
        else:
            break
        gain = cost - other[0]
        angles, (cost, miss, slope) = trial, other
        if gain < 1e-3 * cost + 1e-10:
            break
    return angles


def _excess(angles: FloatArray, limit: FloatArray) -> FloatArray:
    """What each step (T - 1, n) has beyond the limit, signed."""
    step = np.diff(angles, axis=0)
    return np.asarray(step - np.clip(step, -limit, limit))


def _banded(blocks: FloatArray, brakes: FloatArray, bending: float, held: BoolArray) -> FloatArray:
    """The Gauss-Newton matrix, lower banded; rows and columns of held angles are the identity's."""
    count, size = held.shape
    bands = np.zeros((3 * size + 1, count, size))
    for below in range(size):
        for column in range(size - below):
            bands[below, :, column] = blocks[:, column + below, column]
    bands[0] += PULL
    bands[0, :-1] += brakes
    bands[0, 1:] += brakes
    bands[size, :-1] -= brakes
    bands[::size] += bending * third_gram(count)[:, :, None]
    flat, fixed = bands.reshape(3 * size + 1, -1), held.ravel()
    for below in range(3 * size + 1):
        length = flat.shape[1] - below
        flat[below, :length][fixed[:length] | fixed[below:]] = 0
    flat[0][fixed] = 1
    return flat


def within_speed(angles: FloatArray, step: FloatArray) -> FloatArray:
    """The movement nearest in the largest difference that moves at most `step` (n,) per frame."""
    above, below = angles.copy(), angles.copy()
    for order in (range(1, len(angles)), range(len(angles) - 2, -1, -1)):
        last = -1 if order.step > 0 else 1
        for t in order:
            above[t] = np.maximum(above[t], above[t + last] - step)
            below[t] = np.minimum(below[t], below[t + last] + step)
    return np.asarray((above + below) / 2)
