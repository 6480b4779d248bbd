"""What is planned follows what is seen: mirrored, moved, for every thing; a second look mends what has shifted."""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imitation.acting.handling import MOST_SHIFT, again, movement, postures
from imitation.acting.primitives import (
    ABOVE,
    ASIDE,
    BEYOND,
    CLEAR,
    HEAD,
    LEFT,
    LIFT,
    LOOK_AGAIN,
    NAMES,
    RIGHT,
    TOUCH,
    WAYS_S,
    Plan,
    Thing,
    plan,
)
from models.objects import TOYS
from models.objects.scene import read
from tests.imitation.arms import MIRROR, REST, image, where

TICK = 0.02
BOTH = ("pull", "spread", "push together", "squeeze", "lift with both")
CARRIED = ("carry", "carry and push")
seeds = st.integers(0, 2**31)


def thing(rng: np.random.Generator, count: int, ends: bool) -> Thing:
    """Somewhere before the chest, on the side of either hand."""
    side = np.ones(count, int) if ends else rng.choice([-1, 1], count)
    a = rng.uniform((0.0, 0.03, -0.09), (0.08, 0.1, -0.05), (count, 3)) * np.stack(
        [0 * side + 1, side, 0 * side + 1], 1
    )
    b = a * MIRROR if ends else a + rng.uniform((-0.03, -0.1, -0.02), (0.03, 0.1, 0.02), (count, 3))
    half = np.tile(rng.uniform(0.006, 0.03, 3), (count, 1))
    return Thing(a, b, half, np.full(count, ends), np.full(count, -0.07))


def aims(rng: np.random.Generator, count: int) -> np.ndarray:
    return rng.uniform((-0.02, -0.02, -0.01, 0.03, 0.0), (0.02, 0.02, 0.01, 0.06, 1.0), (count, 5))


def all_of(name: str, count: int) -> np.ndarray:
    return np.full(count, NAMES.index(name))


@pytest.mark.parametrize(("name", "ends"), [(name, False) for name in NAMES] + [(name, True) for name in BOTH])
@given(seeds)
@settings(max_examples=10, deadline=None)
def test_the_mirror_image_of_a_scene_is_planned_as_the_mirror_image(name: str, ends: bool, seed: int) -> None:
    """Left for right, forward, outwards and up the same (a head's second aim is to the left); of two ends, a is always
    the left hand's: the mirror image of b. What one hand does with ends is always the left one's, so has no mirror."""
    rng = np.random.default_rng(seed)
    seen, aim, which = thing(rng, 6, ends), aims(rng, 6), all_of(name, 6)
    a, b = (seen.b, seen.a) if ends else (seen.a, seen.b)
    other = Thing(a * MIRROR, b * MIRROR, seen.half, seen.ends, seen.floor)
    turned = aim * (1, -1 if name == "press with the head" else 1, 1, 1, 1)
    one, two = plan(seen, which, aim), plan(other, which, turned)
    np.testing.assert_allclose(two.places, one.places[:, :, [RIGHT, LEFT, HEAD]] * MIRROR, atol=1e-12)
    np.testing.assert_array_equal(two.grips, one.grips[..., ::-1])


@pytest.mark.parametrize("name", NAMES)
def test_where_a_thing_lies_is_where_it_is_done(name: str) -> None:
    """A thing further forward, all else alike: every place of contact is further forward."""
    rng = np.random.default_rng(1)
    seen, aim, which = thing(rng, 8, False), aims(rng, 8), all_of(name, 8)
    shift = np.array([0.013, 0.0, 0.0])
    moved = Thing(seen.a + shift, seen.b + shift, seen.half, seen.ends, seen.floor)
    change = plan(moved, which, aim).places - plan(seen, which, aim).places
    there = ~np.isnan(change)
    aside = np.array([LEFT, RIGHT]) if name == "press with the head" else np.array([], int)
    for part in (LEFT, RIGHT, HEAD):
        wanted = np.broadcast_to(0 * shift if part in aside else shift, change[:, :, part].shape)
        np.testing.assert_allclose(change[:, :, part][there[:, :, part]], wanted[there[:, :, part]], atol=1e-12)


def sight(toy: str) -> Thing:
    """An object as its file sets it down."""
    model = read(TOYS[toy]).compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    a, b = (data.site(name).xpos[None] - (0.1, 0, 0.1) for name in ("a", "b"))
    return Thing(a, b, np.array([TOYS[toy].half]), np.array([TOYS[toy].ends]), np.array([-0.066]))


@pytest.mark.parametrize("toy", TOYS)
def test_everything_can_be_done_with_every_toy(toy: str) -> None:
    """Places are whole or none, somebody always does something, palms hold with 0 to 1."""
    rng, seen, count = np.random.default_rng(0), sight(toy), len(NAMES)
    many = seen.only(np.zeros(count, int))
    found = plan(many, np.arange(count), aims(rng, count))
    assert found.places.shape == (len(WAYS_S), count, 3, 3) and found.grips.shape == (len(WAYS_S), count, 2)
    missing = np.isnan(found.places)
    assert (missing.all(-1) == missing.any(-1)).all()
    assert not missing.all((0, 2, 3)).any() and not np.isinf(found.places).any()
    assert np.nanmax(np.abs(found.places)) < 0.4, "m: nobody reaches for the moon"
    assert found.grips.min() >= 0 and found.grips.max() <= 1
    wild = plan(many, np.arange(count), 1e3 * aims(rng, count))
    assert wild.grips.max() <= 1 and not np.isinf(wild.places).any()


def test_nobody_is_told_of_others() -> None:
    rng, count = np.random.default_rng(2), 3 * len(NAMES)
    seen, aim, which = thing(rng, count, False), aims(rng, count), rng.permutation(np.arange(count) % len(NAMES))
    whole = plan(seen, which, aim)
    for row in range(count):
        alone = plan(seen.only(np.array([row])), which[[row]], aim[[row]])
        np.testing.assert_array_equal(alone.places[:, 0], whole.places[:, row])
        np.testing.assert_array_equal(alone.grips[:, 0], whole.grips[:, row])


def of(name: str, count: int = 12, ends: bool = False) -> tuple[Thing, np.ndarray, Plan, np.ndarray]:
    """A thing, aims, the plan, and (N, ways, 3) where the hand on its side goes."""
    rng = np.random.default_rng(3)
    seen, aim = thing(rng, count, ends), aims(rng, count)
    found = plan(seen, all_of(name, count), aim)
    near = np.where(seen.a[:, 1] > 0, LEFT, RIGHT)
    return seen, aim, found, found.places[:, np.arange(count), near].swapaxes(0, 1)


def test_what_is_lifted_is_raised_by_the_lift_and_held_till_then() -> None:
    _, aim, found, hand = of("lift")
    np.testing.assert_allclose(hand[:, 4:6] - hand[:, [TOUCH]], np.tile([0, 0, LIFT], (12, 2, 1)), atol=1e-12)
    np.testing.assert_array_equal(found.grips[TOUCH:6].max(-1), np.tile(aim[:, 4], (4, 1)))
    assert not found.grips[:TOUCH].any() and not found.grips[6:].any() and np.isnan(hand[:, 6:]).all()
    found = of("lift with both", ends=True)[2]
    rise = found.places[4, :, :2] - found.places[TOUCH, :, :2]
    np.testing.assert_allclose(rise, np.tile([0, 0, LIFT], (12, 2, 1)), atol=1e-12)
    held = of("hold")[3]
    np.testing.assert_array_equal(held[:, 4:6], held[:, [TOUCH, TOUCH]])


def test_what_is_carried_clears_the_other_part_comes_over_it_and_is_let_go() -> None:
    seen, _, found, hand = of("carry")
    way = hand - hand[:, [TOUCH]]  # of the thing too, while it is held
    bottom, top = seen.a[:, 2] - seen.half[:, 1], seen.b[:, 2] + seen.half[:, 2]
    assert (bottom + way[:, 4, 2] >= top + CLEAR - 1e-12).all() and (way[:, 4, 2] >= 0).all()
    np.testing.assert_allclose(way[:, 4, :2], 0, atol=1e-12)
    np.testing.assert_allclose((seen.a + way[:, 5])[:, :2], seen.b[:, :2], atol=1e-12)
    np.testing.assert_allclose(way[:, 5, 2] - way[:, 6, 2], CLEAR)
    assert found.grips[TOUCH:7].max(-1).all() and not found.grips[7:].any()
    np.testing.assert_allclose(way[:, 8] - way[:, 5], np.tile([0, 0, ABOVE], (12, 1)), atol=1e-12)


def test_a_pull_draws_outwards_by_how_far_and_a_push_goes_the_other_way() -> None:
    seen, aim, found, _ = of("pull", ends=True)
    axis = (seen.a - seen.b) / np.linalg.norm(seen.a - seen.b, axis=1, keepdims=True)
    for hand, sign in ((LEFT, 1), (RIGHT, -1)):
        np.testing.assert_allclose(found.places[4, :, hand] - found.places[3, :, hand], sign * axis * aim[:, 3:4])
    together = of("push together", ends=True)[2]
    way = together.places[4, :, LEFT] - together.places[3, :, LEFT]
    assert ((way * axis).sum(1) < 0).all() and not together.grips.any()


def test_a_head_leans_onto_a_things_top_hands_out_of_its_way() -> None:
    seen, aim, found, _ = of("press with the head")
    top = seen.a + seen.half[:, 1:2] * (0, 0, 1) + aim[:, :3]
    np.testing.assert_allclose(found.places[TOUCH, :, HEAD], top - (0, 0, BEYOND))
    np.testing.assert_allclose(found.places[TOUCH, :, RIGHT], np.tile(ASIDE * MIRROR, (12, 1)))
    assert np.isnan(of("press")[2].places[:, :, HEAD]).all()


# --- a second look ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_nothing_that_stayed_as_it_was_meant_to_be_changes_a_plan(name: str) -> None:
    seen, _, found, _ = of(name)
    here = found.places[TOUCH].copy()
    now = np.stack([seen.a, seen.b], 1)
    np.testing.assert_allclose(again(found, seen, all_of(name, 12), here, now), found.places[LOOK_AGAIN:], atol=1e-12)


def test_what_is_carried_ends_over_where_the_other_part_is_seen_now() -> None:
    """It hangs askew and the cup was pushed: hand and what hangs from it come so that a is over b all the same."""
    seen, _, found, _ = of("carry")
    rng, rows = np.random.default_rng(4), np.arange(12)
    near = np.where(seen.a[:, 1] > 0, LEFT, RIGHT)
    palms = rng.uniform(-0.1, 0.1, (12, 3, 3))
    meant = seen.a - found.places[TOUCH, rows, near]
    hangs = meant + rng.uniform(-0.015, 0.015, (12, 3))
    now = np.stack([palms[rows, near] + hangs, seen.b + rng.uniform(-0.02, 0.02, (12, 3))], 1)
    left = again(found, seen, all_of("carry", 12), palms, now)
    for way in (0, 1):
        np.testing.assert_allclose((left[way, rows, near] + hangs)[:, :2], now[:, 1, :2], atol=1e-12)
        np.testing.assert_array_equal(left[way, rows, near, 2], found.places[LOOK_AGAIN + way, rows, near, 2])
    idle = left[:, rows, 1 - near]
    assert np.isnan(idle).all() and np.isnan(left[:, :, HEAD]).all()


@pytest.mark.parametrize("name", NAMES)
def test_a_second_look_shifts_what_is_carried_alone_and_never_far(name: str) -> None:
    seen, _, found, _ = of(name)
    before, gone = found.places.copy(), np.stack([seen.a, np.add(seen.b, (0.5, -0.5, 0.5))], 1)
    left = again(found, seen, all_of(name, 12), found.places[TOUCH], gone)
    np.testing.assert_array_equal(found.places, before)
    change = (left - before[LOOK_AGAIN:])[~np.isnan(left)].reshape(-1, 3)
    bound = np.array([MOST_SHIFT, -MOST_SHIFT, 0]) if name in CARRIED else np.zeros(3)
    np.testing.assert_allclose(change, np.tile(bound, (len(change), 1)), atol=1e-12)


# --- from places to movement ------------------------------------------------------------------------------------------


def test_postures_bring_parts_there_and_where_nothing_is_wanted_one_rests() -> None:
    of_arms, rng = image(), np.random.default_rng(5)
    wanted = np.stack([where(REST + 0.3 * rng.uniform(-1, 1, (4, 7))) for _ in range(3)])
    wanted[1, :2] = np.nan
    wanted[2, 3, 0] = (5.0, 0, 0)
    found, miss = postures(of_arms, wanted, np.tile(REST, (4, 1)) + 0.1)
    away = np.linalg.norm(np.stack([where(one) for one in found]) - wanted, axis=-1).max(-1)
    assert np.nanmax(away[:, :3]) < 1e-3
    np.testing.assert_array_equal(found[1, :2], np.tile(REST, (2, 1)))
    assert miss[:3].max() < 1e-3 and miss[3] == pytest.approx(away[2, 3])


def jerk(ways: Callable[[float], float], steps: int) -> np.ndarray:
    return np.array([ways((n + 1) / steps) for n in range(steps)])


def test_a_movement_goes_through_its_postures_with_no_pace_at_either_end() -> None:
    rng, seconds = np.random.default_rng(6), (0.9, 0.5, 0.4)
    begin, ways = rng.normal(size=(5, 7)), rng.normal(size=(3, 5, 7))
    path = movement(ways, seconds, begin, TICK)
    assert len(path) == round(sum(seconds) / TICK)
    ends, before = np.cumsum([round(s / TICK) for s in seconds]), begin
    for way, end, duration in zip(ways, ends, seconds, strict=True):
        steps = round(duration / TICK)
        piece, far = path[end - steps : end], way - before
        np.testing.assert_allclose(piece[-1], way, atol=1e-12)
        share = jerk(lambda r: 10 * r**3 - 15 * r**4 + 6 * r**5, steps)
        np.testing.assert_allclose(piece, before + share[:, None, None] * far, atol=1e-12)
        pace = np.diff(np.concatenate([before[None], piece]), axis=0) / far
        assert (pace >= 0).all() and (pace[[0, -1]] < 10 / steps**3).all()
        np.testing.assert_allclose(pace, pace[::-1], atol=1e-9)
        before = way
    np.testing.assert_array_equal(movement(begin[None], (0.5,), begin, TICK), np.tile(begin, (25, 1, 1)))
