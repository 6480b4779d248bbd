"""Play's laws: all is counted, plays add up exactly, aims are Gaussian posteriors, what surprises is practised."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.errors import BabblingError
from babbling.files import load, save
from babbling.play import AIMS, COMFORT, FINE, HANDS, LEAST, MIDDLE, PRIOR_STRENGTH, SPREAD, Play
from tests.babbling.creature import Creature

KINDS, ACTS, STATES, SEEN = ("dumbbell", "panel"), ("pull", "press", "hold"), ("same", "up", "lit", "apart"), 4
seeds = st.integers(0, 2**31)


def nothing(fingerprint: str = "me") -> Play:
    return Play.empty(fingerprint, KINDS, ACTS, STATES, SEEN)


Tries = tuple[int, int, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def tries(rng: np.random.Generator, count: int = 30) -> Tries:
    """What `Play.after` is told, but for minutes."""
    kind, hands = rng.integers(len(KINDS)), rng.integers(len(HANDS))
    which, states = rng.integers(0, len(ACTS), count), rng.integers(0, len(STATES), count)
    aims, features = rng.normal(0.1, 0.3, (count, AIMS)), rng.normal(0, 0.2, (count, SEEN))
    return int(kind), int(hands), which, states, aims, features, rng.exponential(2.0, count), rng.random(count) < 0.7


def played(seed: int, rounds: int = 3) -> Play:
    rng, play = np.random.default_rng(seed), nothing()
    for number in range(rounds):
        play = replace(play.after(*tries(rng), minutes=0.5), rounds=number + 1)
    return play


def numbers(play: Play) -> dict[str, np.ndarray]:
    whole = {field.name: np.asarray(getattr(play, field.name)) for field in fields(play)}
    model = play.outcomes
    return whole | {"outcomes": model.counts, "moments": model.moments.sums, "predictive": model.predictive}


def assert_same(one: Play, other: Play) -> None:
    theirs = numbers(other)
    for name, value in numbers(one).items():
        np.testing.assert_array_equal(value, theirs[name], err_msg=name)


def test_everything_that_was_tried_is_counted_one_by_one() -> None:
    rng, play, slow = np.random.default_rng(0), nothing(), nothing()
    shape = (len(KINDS), len(HANDS), len(ACTS), len(STATES))
    skilled_counts, close = np.zeros(shape, int), FINE * 90
    sums = {name: np.zeros(np.shape(getattr(slow, name))) for name in ("reached", "aimed", "moved", "strain")}
    for _ in range(4):
        kind, hands, which, states, aims, features, strain, skilled = one = tries(rng)
        play = play.after(*one, minutes=1.5)
        for i, (act, state) in enumerate(zip(which, states, strict=True)):
            sums["reached"][kind, act, state] += 1
            sums["aimed"][kind, act, state] += aims[i]
            sums["moved"][kind, act] += features[i]
            sums["strain"][kind, act] += strain[i]
            skilled_counts[kind, hands, act, state] += skilled[i]
    np.testing.assert_array_equal(play.reached, sums["reached"])
    np.testing.assert_array_equal(play.outcomes.counts[0], skilled_counts)
    np.testing.assert_array_equal(play.tried, sums["reached"].sum(-1))
    for name in ("aimed", "moved", "strain"):  # each within half of what is counted in
        np.testing.assert_allclose(getattr(play, name) * FINE, sums[name], atol=close)
    assert play.minutes == 6.0 and play.kinds == KINDS


@given(seeds)
@settings(max_examples=20, deadline=None)
def test_merging_is_having_played_it_all_in_any_order_and_grouping(seed: int) -> None:
    a, b, c = (played(seed + i, rounds=1 + i) for i in range(3))
    assert_same(a.merged(b), b.merged(a))
    assert_same(a.merged(b).merged(c), a.merged(b.merged(c)))
    assert_same(a.merged(a.nothing()), a)
    rng = np.random.default_rng(seed)
    one, other = tries(rng), tries(rng)
    apart = nothing().after(*one, minutes=0.5).merged(nothing().after(*other, minutes=0.25))
    assert_same(apart, nothing().after(*one, minutes=0.5).after(*other, minutes=0.25))
    before = numbers(a)
    a.merged(b)
    a.after(*tries(rng), minutes=1.0)
    for name, value in numbers(a).items():
        np.testing.assert_array_equal(before[name], value, err_msg=f"{name} changed behind one's back")


def test_others_play_is_refused() -> None:
    with pytest.raises(BabblingError, match=r"plays of two bodies \(fingerprints me and you\) cannot be merged"):
        nothing().merged(nothing("you"))
    with pytest.raises(BabblingError, match="do not share their axes"):
        nothing().merged(Play.empty("me", ("ring",), ACTS, STATES, SEEN))
    with pytest.raises(BabblingError, match="movements were seen at other moments"):
        nothing().merged(Play.empty("me", KINDS, ACTS, STATES, SEEN + 1))
    with pytest.raises(BabblingError, match="learned by another body"):
        nothing().check(Creature(copies=1))


@pytest.mark.parametrize("rounds", [0, 1, 4])
def test_a_file_of_play_comes_back(rounds: int, tmp_path: Path) -> None:
    """At whatever moment it was put down: before anything was tried, or before anything was done well."""
    play = played(7, rounds)
    save(play, tmp_path / "play.nc")
    found = load(tmp_path / "play.nc", Play)
    assert_same(found, play)
    more = tries(np.random.default_rng(1))
    assert_same(found.after(*more, minutes=1.0), play.after(*more, minutes=1.0))


# --- what becomes of things -------------------------------------------------------------------------------------------


@given(seeds)
@settings(max_examples=20, deadline=None)
def test_what_becomes_of_a_thing_is_expected_by_what_usually_does(seed: int) -> None:
    """P(o | c, a) = (n + k q) / (N + k), q = (what happened in c whatever one did + 1 / O) / (their number + 1); a
    row that was never tried is q itself, a context never met is anything alike."""
    model = played(seed, rounds=2).outcomes
    k, size = PRIOR_STRENGTH, len(STATES)
    for kind, hands in np.ndindex(len(KINDS), len(HANDS)):
        counts = model.counts[0, kind, hands]
        usual = [(sum(counts[act, o] for act in range(len(ACTS))) + 1 / size) / (counts.sum() + 1) for o in range(size)]
        for act in range(len(ACTS)):
            row = [(counts[act, o] + k * usual[o]) / (counts[act].sum() + k) for o in range(size)]
            np.testing.assert_allclose(model.predictive[0, kind, hands, act], row, atol=1e-12)
            if not counts[act].sum():
                np.testing.assert_allclose(model.predictive[0, kind, hands, act], usual, atol=1e-12)
        if not counts.sum():
            np.testing.assert_allclose(model.predictive[0, kind, hands], 1 / size)
    np.testing.assert_allclose(model.predictive.sum(-1), 1)


def test_habits_are_what_one_does_and_where_nothing_is_known_what_one_does_elsewhere() -> None:
    """(visits + k g) / (all + k), g = (how often each was done anywhere + 1 / A) / (all + 1)."""
    model = played(3, rounds=1).outcomes  # one kind and pair of hands alone
    visits = model.counts[0].sum(-1)
    g = (visits.sum((0, 1)) + 1 / len(ACTS)) / (visits.sum() + 1)
    wanted = (visits + PRIOR_STRENGTH * g) / (visits.sum(-1, keepdims=True) + PRIOR_STRENGTH)
    np.testing.assert_allclose(model.habits[0], wanted)
    assert (visits.sum(-1) == 0).sum() == 3
    np.testing.assert_allclose(model.habits[0][visits.sum(-1) == 0], np.tile(g, (3, 1)))


# --- skill ------------------------------------------------------------------------------------------------------------


def reaching(counts: np.ndarray) -> Play:
    """A play in which (A, O) states came about so often with the first kind."""
    which, states = (axis.ravel() for axis in np.indices(counts.shape))
    which, states = np.repeat(which, counts.ravel()), np.repeat(states, counts.ravel())
    count, none = len(which), np.zeros(len(which), bool)
    return nothing().after(
        0, 0, which, states, np.zeros((count, AIMS)), np.zeros((count, SEEN)), np.zeros(count), none, 0.0
    )


def test_what_surprises_most_is_practised() -> None:
    """-log P(state | kind) over all that was done with it; not what came about less than twice."""
    play = reaching(np.array([[9, 3, 0, 2], [8, LEAST, LEAST - 1, 0], [1, 1, 1, 1]]))
    assert play.practised(0).tolist() == [3, 1, -1]
    assert play.practised(1).tolist() == [-1, -1, -1]
    assert reaching(np.array([[5, 0, 0, 0], [0] * 4, [0] * 4])).practised(0).tolist() == [0, -1, -1]


@given(seeds, st.integers(0, 12))
@settings(max_examples=30, deadline=None)
def test_an_aim_is_the_gaussian_of_its_successes_and_one_imagined(seed: int, successes: int) -> None:
    """Mean and variance of the aims with which it came about, and of one drawn from N(MIDDLE, SPREAD^2)."""
    rng = np.random.default_rng(seed)
    aims = rng.normal(0.05, 0.1, (successes, AIMS))
    which, states = np.full(successes, 1), np.full(successes, 2)
    none = np.zeros(successes, bool)
    play = nothing().after(0, 1, which, states, aims, np.zeros((successes, SEEN)), np.zeros(successes), none, 0.0)
    mean, spread = play.aim(0, np.array([1, 1, 0, 2]), np.array([2, -1, 2, 3]))
    total = successes + 1
    expected = (aims.sum(0) + MIDDLE) / total
    square = ((aims**2).sum(0) + MIDDLE**2 + SPREAD**2) / total
    np.testing.assert_allclose(mean[0], expected, atol=FINE)
    np.testing.assert_allclose(spread[0] ** 2, square - expected**2, atol=2 * FINE)
    np.testing.assert_allclose(mean[1:], np.tile(MIDDLE, (3, 1)))
    np.testing.assert_allclose(spread[1:], np.tile(SPREAD, (3, 1)))


def test_an_aim_closes_in_on_what_works() -> None:
    works, rng = np.array([0.01, -0.004, 0.002, 0.05, 0.9]), np.random.default_rng(0)
    aims, count = works + 0.001 * rng.standard_normal((400, AIMS)), 400
    which, none = np.zeros(count, int), np.zeros(count, bool)
    play = nothing().after(0, 0, which, which, aims, np.zeros((count, SEEN)), np.zeros(count), none, 0.0)
    mean, spread = play.aim(0, which[:1], which[:1])
    np.testing.assert_allclose(mean[0], works, atol=1e-3)
    assert (spread[0] < SPREAD).all()


def test_comfort_is_a_distribution_and_what_strains_is_rarely_done() -> None:
    count, none = 6, np.zeros(6, bool)
    which, strain = np.arange(6) % 3, np.array([0.5, 2.0, 4.0, 1.5, 2.0, 6.0])
    play = nothing().after(
        0, 0, which, np.zeros(count, int), np.zeros((count, AIMS)), np.zeros((count, SEEN)), strain, none, 0.0
    )
    glad = np.exp(-np.array([1.0, 2.0, 5.0]) / (2 * COMFORT**2))
    np.testing.assert_allclose(play.comfort(0), glad / glad.sum())
    np.testing.assert_allclose(play.comfort(1), 1 / len(ACTS))  # never tried: alike
    for kind in (0, 1):
        assert play.comfort(kind).sum() == pytest.approx(1)
