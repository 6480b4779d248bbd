"""One leg, in a world that is known: which loads are a sole, what lifts, where one stands best, what is free then."""

from dataclasses import replace

import numpy as np
import pytest

from babbling.balance import Balance, Stood
from babbling.one_leg import LIFT, SIDES, STAYED, alone, free, lifts, shifts, soles
from tests.babbling import soles as world
from tests.babbling.soles import COUNT, HOME

SOLE = np.array([1, 1, 1, 1, -1, -1, -1, -1])
FRONT = np.array([1, 1, -1, -1, 1, 1, -1, -1.0])
ACROSS = np.array([1, 0.05, 0.9, 0.1, -0.05, -1, -0.1, -0.9])
"""Inner loads lie nearly between the feet: little tells by itself which foot is theirs."""
OUTER = np.array([1, -1, 1, -1, 1, -1, 1, -1.0])
SIDE = np.arange(8) % 2
"""Of `SIDES`, for eight copies."""


@pytest.fixture(scope="module")
def known() -> Balance:
    """Toes of one foot against the heel of the other, and inner edges against outer ones, beside pressure."""
    balance, rng = world.stood(np.random.default_rng(0), 1), np.random.default_rng(1)
    ways = np.stack([SOLE * FRONT, (1 + SOLE) * OUTER, (1 - SOLE) * OUTER], 1)
    effects = ways @ rng.uniform(-1, 1, (3, COUNT)) + np.stack([FRONT, ACROSS], 1) @ rng.uniform(-1, 1, (2, COUNT))
    return replace(balance, pressing=np.stack([FRONT, ACROSS]), effects=effects, following=np.eye(COUNT))


def run_of(loads: np.ndarray, turning: np.ndarray | None = None, told: np.ndarray | None = None) -> Stood:
    """Nobody falls."""
    shape = loads.shape[:2]
    told = np.zeros((*shape, COUNT)) if told is None else told
    turning = np.zeros((*shape, 3)) if turning is None else turning
    return Stood(told, np.zeros((*shape, 2)), told, loads, turning, np.ones(shape, bool))


def on_one(side: np.ndarray, ticks: int = 80) -> np.ndarray:
    """(T, B, 8) loads of those who stand in the middle of one sole."""
    return np.tile(17.0 * (SOLE == np.take(SIDES, side)[:, None]), (ticks, 1, 1))


@pytest.mark.parametrize("seed", range(5))
def test_soles_are_found_whatever_the_order_and_the_signs(known: Balance, seed: int) -> None:
    rng = np.random.default_rng(seed)
    order, signs = rng.permutation(8), rng.choice([-1, 1], 2)
    effects = known.effects + 0.05 * rng.standard_normal(known.effects.shape)
    mixed = replace(known, effects=effects[order], pressing=signs[:, None] * known.pressing[:, order])
    assert soles(mixed).tolist() == (signs[1] * SOLE[order]).tolist()


def test_what_takes_most_off_a_sole_over_its_range_lifts_it(known: Balance) -> None:
    across = np.zeros(COUNT)
    across[[2, 5]] = -1.0, 2.0  # joint 2 takes load off side 1 when it grows, joint 5 puts twice as much there
    effects = known.effects + np.outer(ACROSS, across - SOLE @ known.effects / (SOLE @ ACROSS))
    low, high = HOME - 0.1, HOME + 0.1
    high[2] = HOME[2] + 1.0
    up = lifts(replace(known, effects=effects), low, high)
    wanted = np.zeros((2, COUNT))
    wanted[SIDES.index(-1), 2] = LIFT  # the sole of side -1 stays
    wanted[SIDES.index(1), 5] = LIFT
    np.testing.assert_allclose(up, wanted)
    carried = replace(known, effects=effects, carries=1.0 * (np.arange(COUNT) != 2))
    assert lifts(carried, low, high)[0, 2] == 0, "what does not carry lifts nothing"


def test_who_stands_on_one_leg_has_nothing_on_the_other_sole_and_is_upright(known: Balance) -> None:
    loads = on_one(SIDE)
    loads[:, 2] = 8.0
    run = run_of(loads)
    run.upright[40:, 3] = False
    stood = alone(known, run, SIDE)
    assert stood[:40].all(0).tolist() == [copy != 2 for copy in range(8)] and not stood[40:, 3].any()
    assert not alone(known, run, 1 - SIDE).any()


def test_one_stands_best_half_way_between_the_least_and_the_most(known: Balance) -> None:
    goal = np.take(SIDES, SIDE) * np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.9, 1.0])
    loads = on_one(SIDE)
    loads[..., FRONT > 0] *= 1.5  # a little forward: 0.2
    loads[-STAYED // 2 :, [0, 1, 6]] = 8.0
    there = shifts(known, run_of(loads), SIDE, goal)
    np.testing.assert_allclose(there, [[-0.2, -0.4], [-0.2, 0.7]])
    loads[:, SIDE == 0] = 8.0
    assert not shifts(known, run_of(loads), SIDE, goal)[0].any(), "nobody stood there"


def test_what_turns_nothing_on_this_leg_and_much_on_the_other_is_free(known: Balance) -> None:
    rng = np.random.default_rng(4)
    told = HOME + world.moves(0.04, 8, 4.0, rng, COUNT)
    legs = np.where(np.arange(COUNT) < 4, -1, 1)  # of each joint
    stands = legs == np.take(SIDES, SIDE)[:, None]
    run = run_of(on_one(SIDE, len(told)), told=told)
    pace = run.moving[..., :COUNT] * np.where(stands, 1.0, 0.2)
    ways = rng.choice([-1.0, 1.0], (COUNT, 3))
    run = run._replace(turning=pace @ ways + 0.02 * rng.standard_normal((*told.shape[:2], 3)))
    wanted = np.stack([legs != side for side in SIDES]) * known.carries
    np.testing.assert_array_equal(free(known, run, SIDE, 20), wanted)
    home = replace(known, following=np.diag(1.0 * (np.arange(COUNT) != 1)))
    assert not free(home, run, SIDE, 20)[:, 1].any(), "what has to stay home does so in the air"
    assert not free(known, run, 0 * SIDE, 20).any(), "nothing to compare with"
