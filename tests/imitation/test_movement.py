"""Movements and the way into them; what one attempt leaves to the next; the temper that rehearsal finds."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from babbling.axes import FloatArray
from babbling.schema import BodySchema
from imitation.acting.attempts import SMOOTHING, Practice
from imitation.acting.movement import APPROACH_S, RUN_UP_S, Movement, approach, slowed
from imitation.acting.rehearsal import CALM, calmest
from imitation.errors import ImitationError

TICK = 0.02
EVERYWHERE = np.array(-np.inf), np.array(np.inf)
seeds = st.integers(0, 2**32 - 1)


@settings(max_examples=40, deadline=None)
@given(seeds)
def test_the_approach_starts_at_rest_and_arrives_with_the_movements_pace(seed: int) -> None:
    rng = np.random.default_rng(seed)
    start = rng.uniform(-1, 1, 3)
    t = np.arange(8)[:, None] * TICK
    c = rng.uniform(-1, 1, (3, 3)) * [[1], [2], [5]]
    goals = c[0] + c[1] * t + c[2] * t**2  # a parabola: its differences are its derivatives
    way = approach(start, goals, TICK, *EVERYWHERE)
    assert len(way) == round(APPROACH_S / TICK) + round(RUN_UP_S / TICK)
    np.testing.assert_allclose(way[0], start, atol=1e-12)
    assert np.abs(way[1] - way[0]).max() < 1e-3  # from rest: r^3
    whole = np.concatenate([way, goals])
    n = len(way)
    pace = (whole[n] - whole[n - 2]) / (2 * TICK) + 0 * goals[0]
    np.testing.assert_allclose(
        (whole[n] - whole[n - 1]) / TICK, c[1] - c[2] * TICK, atol=0.05 + 0.05 * np.abs(c[1]).max()
    )
    assert np.abs(pace).max() < 10
    jumps = np.abs(np.diff(whole, n=2, axis=0)) / TICK**2
    assert jumps[n - 3 : n + 1].max() < 2.5 * np.abs(2 * c[2]).max() + 8 * np.abs(c[1]).max() + 1


def test_an_approach_to_a_still_movement_is_one_minimum_jerk() -> None:
    goals = np.tile([0.4, -0.2], (5, 1))
    way = approach(np.zeros(2), goals, TICK, *EVERYWHERE)
    r = np.arange(round(APPROACH_S / TICK))[:, None] * TICK / APPROACH_S
    np.testing.assert_allclose(way[: len(r)], goals[0] * r**3 * (10 - 15 * r + 6 * r * r), atol=1e-12)
    np.testing.assert_allclose(way[len(r) :], np.tile(goals[0], (len(way) - len(r), 1)), atol=1e-12)


@settings(max_examples=60, deadline=None)
@given(seeds)
@example(14702171)
def test_no_approach_leaves_the_ranges_and_each_is_one_way_into_the_movement(seed: int) -> None:
    """Also from a stop, and into movements that begin fast, at a stop or away from it."""
    rng = np.random.default_rng(seed)
    low, high = -rng.uniform(0.1, 1, 4), rng.uniform(0.1, 1, 4)
    start = np.clip(rng.uniform(1.3 * low, 1.3 * high, (2, 4)), low, high)
    t = np.arange(8)[:, None] * TICK
    pace = rng.uniform(-6, 6, 4)
    goals = np.clip(rng.uniform(1.3 * low, 1.3 * high), low, high) + pace * t
    way = approach(start, goals, TICK, low, high)
    free = approach(start, goals, TICK, *EVERYWHERE)
    assert (way >= low).all() and (way <= high).all()
    np.testing.assert_array_equal(way[0], start)
    steps = np.abs(np.diff(np.concatenate([way, np.tile(goals[:1, None], (1, 2, 1))]), axis=0))
    fastest = np.maximum(15 / 8 * (high - low) / APPROACH_S, np.abs(pace))  # minimum jerk, or the movement's own pace
    assert (steps <= fastest * TICK + 1e-9).all()
    inside = ((free > low) & (free < high)).all(0)
    np.testing.assert_allclose(way[:, inside], free[:, inside], atol=1e-12)  # where there is room nothing changes
    bent = approach(start, goals + rng.uniform(-50, 50, 4) * t**2, TICK, low, high)
    assert (bent >= low).all() and (bent <= high).all()


def test_a_run_up_with_little_room_is_short_and_gathers_the_whole_pace() -> None:
    goals = (0.1 + 2.0 * TICK * np.arange(5))[:, None]
    way = approach(np.array([0.5]), goals, TICK, np.zeros(1), np.ones(1))[:, 0]
    np.testing.assert_allclose(way[round((APPROACH_S + RUN_UP_S - 0.1) / TICK) - 1], 0, atol=1e-12)  # 2 x 0.1 / 2.0
    assert (np.diff(way[round(APPROACH_S / TICK) :]) >= 0).all(), "never back"
    assert (goals[0, 0] - way[-1]) / TICK == pytest.approx(2.0, rel=0.1)
    assert np.abs(np.diff(way[-25:], 2)).max() <= 1.5 * 2.0 / 0.1 * TICK**2, "without a jerk"


@given(st.floats(1, 4))
def test_slowed_frames_are_the_same_movement_later(factor: float) -> None:
    frames = np.polynomial.polynomial.polyval(np.linspace(-1, 1, 30), [[0.1, 2], [1, -1], [0.5, 1], [-1, 0.2]]).T
    late = np.arange(int(29 * factor + 1e-9) + 1) / factor
    same = np.polynomial.polynomial.polyval(late / 14.5 - 1, [[0.1, 2], [1, -1], [0.5, 1], [-1, 0.2]]).T
    np.testing.assert_allclose(slowed(frames, factor), same, atol=1e-9)  # a spline holds cubics exactly
    assert slowed(frames, 1.0) is frames


def schema(postures: list[int]) -> BodySchema:
    one = np.ones(len(postures))
    return BodySchema(np.array(postures), np.array(postures), one, one, one, one, np.zeros((len(postures), 4)))


def test_a_movement_is_read_by_the_schema_and_what_is_unseen_is_named() -> None:
    senses = np.arange(12.0).reshape(3, 4)
    senses[:, 1] = np.nan
    movement = Movement("nod", TICK, senses)
    np.testing.assert_array_equal(movement.postures(schema([2, 0])), senses[:, [2, 0]])
    with pytest.raises(ImitationError, match="nod: nothing was seen for the posture that motor 1 moves"):
        movement.postures(schema([2, 1]))
    with pytest.raises(ValueError, match="read-only"):
        movement.senses[0] = 0
    senses[:] = 0
    assert movement.senses[2, 3] == 11
    with pytest.raises(ImitationError, match="2 frames; a movement needs at least 3"):
        Movement("nod", TICK, np.zeros((2, 4)))


def plant(aim: FloatArray, goals: FloatArray, gain: float, lag: float) -> FloatArray:
    """(T, 1, F) reached when aiming beside goals: a first-order lag with a wrong gain."""
    reached = np.zeros_like(aim)
    y = goals[0]
    for t in range(len(goals)):
        y = lag * y + (1 - lag) * gain * (goals[t] + aim[t, 0])
        reached[t, 0] = y
    return reached


@pytest.mark.parametrize(("gain", "lag"), [(0.8, 0.3), (1.2, 0.2), (0.9, 0.6)])
def test_attempts_come_nearer_and_practice_is_never_worse_than_the_best(gain: float, lag: float) -> None:
    t = np.arange(150)[:, None] * TICK
    goals = np.concatenate([0.5 * np.sin(3 * t) + 0.5, np.cos(2 * t)], 1)
    practice, sizes = Practice.empty(150, 1, 2), []
    for _ in range(8):
        error = goals[:, None] - plant(practice.aim, goals, gain, lag)
        sizes.append(np.sqrt(np.mean(error**2, axis=0)))
        practice = practice.after(error)
        np.testing.assert_allclose(practice.size, np.min(sizes, axis=0))
    assert (practice.size < 0.25 * sizes[0]).all()


def test_an_attempt_that_was_worse_is_not_built_upon() -> None:
    rng = np.random.default_rng(0)
    good, bad = 0.1 * rng.standard_normal((20, 1, 2)), rng.standard_normal((20, 1, 2))
    first = Practice.empty(20, 1, 2).after(good)
    second = first.after(bad)
    np.testing.assert_array_equal(second.best_aim, first.best_aim)
    np.testing.assert_array_equal(second.best_error, good)
    np.testing.assert_allclose(second.aim, first.aim / 2)  # from aim 0: half the share of the same error
    np.testing.assert_array_equal(second.share, first.share / 2)


def test_an_error_no_larger_than_the_doubt_is_not_aimed_against() -> None:
    """A plant that does what it is told, felt through noise of a known size: practice leaves it alone, where without
    the doubt it would learn the noise; and a real error is undone all the same."""
    rng, sigma = np.random.default_rng(3), 0.1
    doubt = np.full(2, sigma**2 * (SMOOTHING**2).sum())
    true = np.stack([np.zeros((400, 1)), np.full((400, 1), 1.0)], -1)  # one that is right, one that is off by 1
    felt = true + sigma * rng.standard_normal(true.shape)
    sure, naive = (Practice.empty(400, 1, 2).after(felt, known).aim for known in (doubt, 0 * doubt))
    wrong = [np.sqrt(np.mean(aim[..., 0] ** 2)) for aim in (sure, naive)]
    assert wrong[0] < 0.01 and wrong[1] == pytest.approx(0.6 * np.sqrt(doubt[0]), rel=0.1)
    np.testing.assert_allclose(sure[..., 1], naive[..., 1], rtol=0.01)
    sure = Practice.empty(400, 1, 2).after(true, doubt).aim
    np.testing.assert_allclose(sure[..., 1], 0.6 * (1 - doubt[1]))


def test_lasting_longer_is_better_than_erring_less_and_what_did_not_happen_teaches_nothing() -> None:
    rng = np.random.default_rng(2)
    fell = Practice.empty(40, 1, 2).after(0.1 * rng.standard_normal((20, 1, 2)))
    assert np.abs(fell.aim[:20]).min() > 0 and not fell.aim[22:].any(), "the kernel reaches two ticks"
    sooner = fell.after(0.01 * rng.standard_normal((5, 1, 2)))
    np.testing.assert_array_equal(sooner.best_error, fell.best_error)
    np.testing.assert_array_equal(sooner.share, fell.share / 2)
    at_once = fell.after(np.zeros((0, 1, 2)))
    np.testing.assert_array_equal(at_once.aim, sooner.aim)
    whole = rng.standard_normal((40, 1, 2))
    later = sooner.after(whole)
    np.testing.assert_array_equal(later.best_error, whole)
    np.testing.assert_array_equal(later.best_aim, sooner.aim)
    assert later.lasted == 40 and (later.size > sooner.size).all()


def test_factors_and_copies_remember_apart() -> None:
    rng = np.random.default_rng(1)
    errors = rng.standard_normal((3, 15, 2, 3))
    whole = Practice.empty(15, 2, 3)
    for error in errors:
        whole = whole.after(error)
    alone = Practice.empty(15, 1, 1)
    for error in errors:
        alone = alone.after(error[:, 1:, 2:])
    np.testing.assert_array_equal(alone.aim[:, 0, 0], whole.aim[:, 1, 2])


@given(seeds)
def test_the_calmest_within_fifteen_percent_is_kept(seed: int) -> None:
    errors = np.random.default_rng(seed).uniform(0.5, 2, (6, 5))
    chosen = calmest(errors)
    assert CALM == 1.15
    for f in range(5):
        best = errors[:, f].min()
        assert errors[chosen[f], f] <= 1.15 * best
        assert (errors[: chosen[f], f] > 1.15 * best).all()
