"""Ways to keep to one thing among look-alikes: what each is told, and where the simple ones fail and filters do not."""

import numpy as np
import pytest

from imitation.seeing.trackers import TRACKERS, Followed
from imitation.seeing.tracking import TrackOptions

OPTIONS = TrackOptions(dt=0.04, acceleration=60.0, start_speed=30.0)
FRAMES, MEET = 120, 60
NOISE = 0.15


def crossing(seed: int, *, gap: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """(T, 4, 3) candidates and (T, 2) the truth: a thing sways, a larger look-alike passes right through its place;
    while they touch, `gap` frames either side, only one thing between them is found."""
    rng = np.random.default_rng(seed)
    time = np.arange(FRAMES) * 0.04
    truth = np.stack([80 + 6 * np.sin(1.3 * time + seed), 60 + 4 * np.cos(1.1 * time)], -1)
    stray = truth[MEET] + np.stack([80.0 * (time - time[MEET]), 0 * time], -1)
    found = np.full((FRAMES, 4, 3), np.nan)
    for t in range(FRAMES):
        things = [(*stray[t], 40.0), (*truth[t], 20.0)]
        if abs(t - MEET) <= gap:
            things = [(*((2 * stray[t] + truth[t]) / 3), 55.0)]
        things = [one for one in things if 5 < one[0] < 155]
        for k, one in enumerate(things):
            found[t, k] = (*(np.array(one[:2]) + NOISE * rng.standard_normal(2)), one[2])
    return found, truth


def follow(name: str, found: np.ndarray) -> Followed:
    return TRACKERS[name](found, OPTIONS, np.random.default_rng(5))


@pytest.mark.parametrize("name", TRACKERS)
def test_a_thing_by_itself_is_followed_by_every_way_and_its_own_numbers_are_told(name: str) -> None:
    found, truth = crossing(0)
    alone = np.full_like(found, np.nan)
    alone[:, 0] = found[:, 1]
    alone[np.isnan(alone[:, 0, 0]), 0] = found[np.isnan(found[:, 1, 0]), 0]  # before the look-alike came it stood first
    alone[abs(np.arange(FRAMES) - MEET) <= 3] = np.nan  # hidden
    kept = follow(name, alone)
    told = np.isfinite(kept.numbers[:, 0])
    assert told[:50].all() and told.mean() > 0.9
    np.testing.assert_array_equal(kept.numbers[told], alone[told, 0])  # as they were found: no smoothing on the way
    assert np.linalg.norm(kept.place - truth, axis=1)[:50].max() < 1.0


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", ["kalman", "particles"])
def test_filters_keep_to_the_thing_through_a_look_alike_that_crosses_it(name: str, seed: int) -> None:
    found, truth = crossing(seed)
    kept = follow(name, found)
    apart = np.linalg.norm(kept.numbers[:, :2] - truth, axis=1)
    clear = abs(np.arange(FRAMES) - MEET) > 8
    assert np.nanmax(apart[clear]) < 1.0
    assert np.isfinite(apart[MEET + 35 :]).all()  # and takes it up again once it has been unseen for a second
    unseen = np.isnan(apart[: MEET + 35])
    assert kept.spread[: MEET + 35][unseen & clear[: MEET + 35]].max() > 5 * kept.spread[MEET - 10]  # it knew


def test_the_largest_is_the_look_alike_and_one_of_two_is_nothing_without_a_filter() -> None:
    found, truth = crossing(1)
    both = np.isfinite(found[:, 1, 0])
    apart = np.linalg.norm(follow("largest", found).numbers[:, :2] - truth, axis=1)
    assert np.median(apart[both]) > 10
    assert np.isnan(follow("none", found).numbers[both]).all()
    assert np.isfinite(follow("none", found).numbers[~both]).all()


def test_the_nearest_one_is_carried_off_by_what_hides_the_thing() -> None:
    found, truth = crossing(2, gap=5)
    apart = np.linalg.norm(follow("nearest", found).numbers[:, :2] - truth, axis=1)
    assert apart[MEET - 10] < 1.0 and apart[MEET + 20] > 10


@pytest.mark.parametrize("name", ["kalman", "particles"])
def test_what_is_long_unseen_is_taken_up_where_one_thing_alone_is_found(name: str) -> None:
    found = np.full((120, 2, 3), np.nan)
    found[:20, 0] = (30.0, 30.0, 9.0)
    found[60:, 0] = (120.0, 80.0, 9.0)  # elsewhere, 1.6 s later: no motion explains it
    kept = follow(name, found)
    assert np.isnan(kept.numbers[20:60]).all()
    np.testing.assert_array_equal(kept.numbers[60:, 0], 120.0)


@pytest.mark.parametrize("name", TRACKERS)
def test_nothing_found_is_nothing_told_and_the_same_seed_tells_the_same(name: str) -> None:
    assert np.isnan(follow(name, np.full((5, 2, 3), np.nan)).numbers).all()
    found, _ = crossing(3)
    for one, again in zip(follow(name, found), follow(name, found), strict=True):
        np.testing.assert_array_equal(one, again)
