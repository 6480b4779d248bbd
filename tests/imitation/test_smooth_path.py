"""Smoothing: a low-pass without delay that lets go of nothing that can be shown, inside ranges and speed limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imitation.correspondence.smooth_path import (
    CUT,
    CUT_OFF_HZ,
    PROMISE,
    SLOWEST,
    SPEED_SHARE,
    smooth_path,
    within_speed,
)
from tests.imitation.planar import image, pointing, view

TICK, FRAMES = 0.02, 300
TIME = TICK * np.arange(FRAMES)
MIDDLE = slice(50, -50)


def smoothed(
    start: np.ndarray,
    holding: bool = True,
    doubt: float = 0.0,
    speed: float = 50.0,
    weights: tuple[float, float] = (1.0, 1.0),
    reach: float = 2.5,
) -> np.ndarray:
    """The planar arm's (T, 2) angles made smooth."""
    seen = view(image((-reach, -reach), (reach, reach)), len(start))
    shape = (len(start), 2)
    held = np.full(shape, holding)
    every = np.tile(weights, (len(start), 1))
    return smooth_path(seen, start, every, held, np.full(2, doubt), np.full(2, speed), TICK)[0]


def slow() -> np.ndarray:
    return np.stack([0.8 * np.sin(2 * TIME), 0.5 + 0.4 * np.cos(3 * TIME)], 1)


def shaky(seed: int, size: float = 0.01) -> np.ndarray:
    return slow() + size * np.random.default_rng(seed).standard_normal((FRAMES, 2))


def moved(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(T, 2) by how much directions differ, rad."""
    return np.linalg.norm(pointing(first) - pointing(second), axis=-1)


@pytest.mark.parametrize("holding", [True, False])
def test_a_slow_movement_passes(holding: bool) -> None:
    np.testing.assert_allclose(smoothed(slow(), holding)[MIDDLE], slow()[MIDDLE], atol=1e-3)


@pytest.mark.parametrize("factor", [0.5, 1.0, 1.5])
def test_it_is_a_low_pass_at_its_cut_off(factor: float) -> None:
    """What need not be held passes by 1 / (1 + (sin(pi f dt) / sin(pi f_c dt))^6), a half at the cut-off, undelayed."""
    wave = 0.01 * np.sin(2 * np.pi * factor * CUT_OFF_HZ * TIME + 0.3)
    found = smoothed(np.stack([wave, 0 * wave], 1), holding=False, weights=(1, 0))[MIDDLE, 0]
    gain = 1 / (1 + (np.sin(np.pi * factor * CUT_OFF_HZ * TICK) / np.sin(np.pi * CUT_OFF_HZ * TICK)) ** 6)
    np.testing.assert_allclose(found, gain * wave[MIDDLE], atol=2e-4)


def test_noise_is_taken_off_but_what_can_be_shown_is_held() -> None:
    """Held directions stay as near as promised, nearer the less is in doubt; others are made as smooth as can be."""
    start = shaky(1)
    held, doubted, free = smoothed(start), smoothed(start, doubt=0.01), smoothed(start, holding=False)
    assert np.quantile(moved(held, start), 0.95) <= PROMISE and moved(held, start).max() < 2 * PROMISE
    assert 2 * PROMISE < moved(doubted, start).max() <= PROMISE + 1.5 * 0.01
    jerk = [np.abs(np.diff(path, 3, axis=0)).mean() for path in (start, held, doubted, free)]
    assert jerk[0] > 1.4 * jerk[1] and jerk[1] > 4 * jerk[2] and jerk[2] > jerk[3]
    assert moved(free, slow()).mean() < 0.65 * moved(start, slow()).mean()


def test_a_sense_that_nothing_seen_decides_stays_where_it_was_found() -> None:
    """Neither pulled to rest nor thrown about: a leap that nobody sees is a slow one, without swinging far beyond."""
    start = np.stack([np.where(TIME < 3, -0.3, 0.3), np.where(TIME < 3, 0.7, 0.2)], 1)
    found = smoothed(start, weights=(1, 0))[:, 1]
    assert np.abs(found - start[:, 1])[np.abs(TIME - 3) > 1.5].max() < 0.02
    assert 0.1 < found.min() and found.max() < 0.8
    assert np.abs(np.diff(found)).max() < 0.05


@pytest.mark.parametrize(("faster", "least"), [(0.9, 1.0), (2.0, 1.75), (3.0, 2.6), (9.0, 4.0)])
def test_a_movement_too_fast_is_slowed_not_cut(faster: float, least: float) -> None:
    """A swing at that many times the speed limit, by as little as keeps every direction within the degree; the slowest
    has its end."""
    start = np.stack([0.5 * np.sin(6 * TIME), 0.3 + 0 * TIME], 1)
    speed = np.full(2, 3 / faster / SPEED_SHARE)
    seen, every = view(image((-2.5, -2.5), (2.5, 2.5)), FRAMES), np.ones((FRAMES, 2))
    found, factor = smooth_path(seen, start, every, every > 0, np.zeros(2), speed, TICK)
    assert (factor == 1) == (faster < 1) and least <= factor <= min(max(faster, 1) * 1.02, SLOWEST)
    assert np.abs(np.diff(found, axis=0)).max() <= factor * 3 / faster * TICK * (1 + 1e-9)
    assert (moved(found, start).max() <= CUT * (1 + 1e-6)) == (faster <= SLOWEST)


def test_a_leap_slows_nothing() -> None:
    start = np.stack([np.where(TIME < 3, -0.5, 0.5), 0.3 + 0 * TIME], 1)
    seen, every = view(image((-2.5, -2.5), (2.5, 2.5)), FRAMES), np.ones((FRAMES, 2))
    assert smooth_path(seen, start, every, every > 0, np.zeros(2), np.full(2, 2.0), TICK)[1] == 1


@pytest.mark.parametrize("speed", [2.0, 5.0])
def test_the_speed_limit_is_kept(speed: float) -> None:
    """A leap takes as long as the limit asks, shared before and after; elsewhere directions stay held."""
    start = np.stack([np.where(TIME < 3, -0.5, 0.5), 0.3 + 0 * TIME], 1)
    found = smoothed(start, speed=speed)
    assert np.abs(np.diff(found, axis=0)).max() <= SPEED_SHARE * speed * TICK * (1 + 1e-9)
    assert np.abs(np.diff(found, axis=0)).max() > 0.9 * SPEED_SHARE * speed * TICK, "and it is used"
    away = moved(found, start)[:, 0] > 0.1
    assert away.sum() * TICK < 1.3 / speed and abs(TIME[away].mean() - 3) < 2 * TICK
    assert moved(found, start)[np.abs(TIME - 3) > 0.5 / speed + 0.3].max() < 0.01


def test_ranges_are_kept() -> None:
    """Postures at a stop, with noise, come out inside."""
    start = np.clip(1.5 * slow(), -0.9, 0.9)
    found = smoothed(start, reach=0.9)
    assert np.abs(found).max() <= 0.9 and (np.abs(found) == 0.9).any()


@pytest.mark.parametrize("speed", [3.0, 50.0])
def test_it_knows_no_direction_of_time(speed: float) -> None:
    start = shaky(2)
    start[FRAMES // 3 :, 0] += 0.5
    np.testing.assert_allclose(smoothed(start[::-1], speed=speed), smoothed(start, speed=speed)[::-1], atol=1e-6)


@pytest.mark.parametrize("frames", [3, 4, 10])
def test_short_movements_are_left_alone(frames: int) -> None:
    np.testing.assert_allclose(smoothed(slow()[:frames]), slow()[:frames], atol=2e-3)


@given(st.integers(0, 2**31))
@settings(max_examples=30, deadline=None)
def test_nearest_movementwithin_speed(seed: int) -> None:
    """It keeps limit and range, leaves alone what already keeps the limit, and no such movement is nearer."""
    rng = np.random.default_rng(seed)
    angles, step = rng.normal(size=(40, 2)).cumsum(axis=0), np.array([0.5, 2.0])
    kept = within_speed(angles, step)
    assert (np.abs(np.diff(kept, axis=0)) <= step + 1e-12).all()
    assert (kept >= angles.min(axis=0) - 1e-12).all() and (kept <= angles.max(axis=0) + 1e-12).all()
    np.testing.assert_allclose(within_speed(kept, step), kept, atol=1e-12)
    gap = np.abs(np.arange(40)[:, None] - np.arange(40))[:, :, None] * step
    least = ((angles[:, None] - angles[None]) - gap).max(axis=(0, 1)) / 2
    np.testing.assert_allclose(np.abs(kept - angles).max(axis=0), least.clip(0), atol=1e-9)
