"""One leg: which loads are one sole, what lifts the other, and what is free to move while pressure is on one sole.

Found after `babbling.balance`, from what it left:

1. Soles. Wiggling also changes loads beside pressure: toes of one foot and heel of the other. Loads that do so together
   lie on one side of x = 0 along the second direction, the side shift: a sole.
2. The lift. Of all joints and directions, the one that takes most load off a sole over its range.
3. The shift. It shifts its weight onto one sole, more or less far, and lifts the other. Half way between the least and
   the most with which it stands, it is best there.
4. What is free. There it wiggles: a joint of the leg that stands turns the organ of balance, one of the other does not.
"""

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.balance import Balance, Stood, shares
from babbling.regression import regress

SIDES = (-1, 1)
"""Of the second direction of pressure; what is by side is in this order."""
LIFT = np.deg2rad(45.0)
"""How far the lifting joint is moved."""
STAYED, MOSTLY = 50, 0.8
"""Who stands on one leg for this share of so many ticks stands."""
EMPTY = 0.05
"""A sole with less than this share of the load is in the air."""


def soles(known: Balance) -> FloatArray:
    """(L,) the side of the sole that each load belongs to, -1 or 1."""
    x, effects = known.pressing, known.effects * known.carries
    beside = effects - np.linalg.pinv(x) @ (x @ effects)
    return np.asarray(np.sign(x[0] * (beside @ (beside.T @ (x[0] * x[1])))))


def lifts(known: Balance, low: FloatArray, high: FloatArray) -> FloatArray:
    """(2, F) rad beside home that lift the other sole, for each side to stand on; (F,) ends of the joints' ranges."""
    onto = np.outer(SIDES, soles(known) @ known.effects * known.carries)  # share per rad that comes onto the sole
    room = np.where(onto > 0, high - known.home, low - known.home)
    best = np.abs(onto * room).argmax(1)
    return np.asarray(LIFT * np.sign(room) * np.eye(room.shape[1])[best])


def alone(known: Balance, run: Stood, side: IntArray) -> BoolArray:
    """(T, B) who is upright on one leg, (B,) which of `SIDES` each was to stand on."""
    other = soles(known) != np.take(SIDES, side)[:, None]
    return np.asarray(run.upright & ((shares(run.loads) * other).sum(-1) < EMPTY))


def shifts(known: Balance, run: Stood, side: IntArray, goal: FloatArray) -> FloatArray:
    """(2, 2) pressures to shift the weight to before lifting the other leg, for each side.

    Args:
        known: balance on both legs.
        run: B copies shift their weight, lift a leg, and stay so for the last second.
        side: (B,) which of `SIDES` each stood on.
        goal: (B,) pressure along the second direction that it had shifted its weight to before.
    """
    up, x = alone(known, run, side)[-STAYED:].mean(0) > MOSTLY, known.pressed(run.loads[-STAYED:]).mean(0)
    there = np.zeros_like(known.there)
    for k in range(len(SIDES)):
        if (stood := up & (side == k)).any():
            there[k] = -x[stood, 0].mean(), (goal[stood].min() + goal[stood].max()) / 2
    return there


def free(known: Balance, run: Stood, side: IntArray, first: int) -> FloatArray:
    """(2, F) 1 for carrying joints that turn the organ less while one stands on this side's leg than on the other, for
    each side, as `shifts`; they wiggled from tick `first` on."""
    up, turns = alone(known, run, side)[first:], np.zeros_like(known.free)
    for k in range(len(SIDES)):
        keep = up & (side == k)
        if not keep.any():
            return 0 * turns
        moving, turning = run.moving[first:][keep], run.turning[first:][keep]
        slopes = regress(moving[:, None], turning[:, None]).coefficients[0, :, : turns.shape[1]]
        turns[k] = np.linalg.norm(slopes, axis=0)
    return np.asarray(known.carries * (known.following.diagonal() > 0) * (turns < turns[::-1]))
