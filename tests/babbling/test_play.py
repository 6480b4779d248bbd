"""Play's laws: all is counted, plays add up exactly, what surprises is practised, what strains is rarely done."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.errors import BabblingError
from babbling.files import load, save
from babbling.play import (
    AIM_POINTS,
    AIM_STRENGTH,
    AIMS,
    COMFORT,
    CURIOUS,
    FINE,
    HANDS,
    LEAST,
    MIDDLE,
    PRIOR_STRENGTH,
    SPREAD,
    Play,
)
from tests.babbling.creature import Creature

KINDS, ACTS, STATES, SEEN = ("dumbbell", "panel"), ("pull", "press", "hold"), ("same", "up", "lit", "apart"), 4
CHILDREN = 5
FREE, BUSY = range(len(HANDS))
seeds = st.integers(0, 2**31)


def nothing(fingerprint: str = "me") -> Play:
    return Play.empty(fingerprint, KINDS, ACTS, STATES, SEEN, CHILDREN)


Tries = tuple[int, int, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def tries(rng: np.random.Generator, count: int = 30) -> Tries:
    """What `Play.after` is told, but for minutes; every second aim lies on a grid point."""
    kind, hands = rng.integers(len(KINDS)), rng.integers(len(HANDS))
    which, states = rng.integers(0, len(ACTS), count), rng.integers(0, len(STATES), count)
    aims = MIDDLE + SPREAD * rng.uniform(-1.2, 1.2, (count, len(AIMS)))
    aims[::2] = MIDDLE + SPREAD * np.linspace(-1, 1, AIM_POINTS)[rng.integers(0, AIM_POINTS, aims[::2].shape)]
    who, moved = rng.integers(0, CHILDREN, count), rng.normal(0, 0.2, (count, SEEN))
    return int(kind), int(hands), which, states, aims, moved, rng.exponential(2.0, count), who


def played(seed: int, rounds: int = 3) -> Play:
    rng, play = np.random.default_rng(seed), nothing()
    for number in range(rounds):
        play = replace(play.after(*tries(rng), minutes=0.5), rounds=number + 1)
    return play


def handled(which: np.ndarray, states: np.ndarray, aims: np.ndarray, strain: np.ndarray, hands: int = FREE) -> Play:
    """After tries with the first kind of thing, movements unseen."""
    one = np.zeros(len(which), int)
    return nothing().after(0, hands, which, states, aims, np.zeros((len(which), SEEN)), strain, one, minutes=0.0)


def numbers(play: Play) -> dict[str, np.ndarray]:
    whole = {
        name: np.asarray(getattr(play, name))
        for name in ("each", "moved", "moved_products", "strain", "rounds", "minutes")
    }
    for name, model in (("outcomes", play.outcomes), ("aims", play.aims)):
        whole |= {name: model.counts, f"{name} moments": model.moments.sums, f"{name} P": model.predictive}
    return whole


def assert_same(one: Play, other: Play) -> None:
    theirs = numbers(other)
    for name, value in numbers(one).items():
        np.testing.assert_array_equal(value, theirs[name], err_msg=name)
    assert one.fingerprint == other.fingerprint


def test_everything_that_was_tried_is_counted_one_by_one() -> None:
    """With hands bound, only what became of it."""
    rng, play = np.random.default_rng(0), nothing()
    outcomes = np.zeros((len(KINDS), len(HANDS), len(ACTS), len(STATES)), int)
    each = np.zeros((CHILDREN, *outcomes.shape), int)
    moved, strained, reached = (np.zeros((len(KINDS), len(ACTS), n)) for n in (SEEN, 1, len(STATES)))
    for _ in range(6):
        kind, hands, which, states, _, features, strain, who = one = tries(rng)
        play = play.after(*one, minutes=1.5)
        for i, (act, state) in enumerate(zip(which, states, strict=True)):
            outcomes[kind, hands, act, state] += 1
            each[who[i], kind, hands, act, state] += 1
            if hands == FREE:
                moved[kind, act] += features[i]
                strained[kind, act] += strain[i]
                reached[kind, act, state] += 1
    assert outcomes[:, BUSY].sum() and outcomes[:, FREE].sum()
    np.testing.assert_array_equal(play.outcomes.counts[0], outcomes)
    np.testing.assert_array_equal(play.each, each)
    for child in range(CHILDREN):
        alone = play.alone(child)
        np.testing.assert_array_equal(alone.outcomes.counts[0], each[child])
        np.testing.assert_array_equal(alone.aims.counts, play.aims.counts)  # skill is all children's
    np.testing.assert_array_equal(play.reached, reached)
    np.testing.assert_array_equal(play.tried, reached.sum(-1))
    aimed = play.aims.counts / play.aims.unit
    np.testing.assert_allclose(aimed.sum(-2), np.tile(reached, (len(AIMS), 1, 1, 1)))
    for found, wanted in ((play.moved, moved), (play.strain, strained[..., 0])):
        np.testing.assert_allclose(found * FINE, wanted, atol=180 * FINE / 2)  # each within half of what is counted in
    assert play.minutes == 9.0 and play.kinds == KINDS


@given(seeds)
@settings(max_examples=15, deadline=None)
def test_merging_is_having_played_it_all_in_any_order_and_grouping(seed: int) -> None:
    a, b, c = (played(seed + i, rounds=1 + i) for i in range(3))
    before = numbers(a)
    assert_same(a.merged(b), b.merged(a))
    assert_same(a.merged(b).merged(c), a.merged(b.merged(c)))
    assert_same(a.merged(a.nothing()), a)
    rng = np.random.default_rng(seed)
    one, other = tries(rng), tries(rng)
    apart = nothing().after(*one, minutes=0.5).merged(nothing().after(*other, minutes=0.25))
    assert_same(apart, nothing().after(*one, minutes=0.5).after(*other, minutes=0.25))
    a.after(*tries(rng), minutes=1.0)
    for name, value in numbers(a).items():
        np.testing.assert_array_equal(before[name], value, err_msg=f"{name} changed behind one's back")


def test_others_play_is_refused() -> None:
    with pytest.raises(BabblingError, match=r"plays of two bodies \(fingerprints me and you\) cannot be merged"):
        nothing().merged(nothing("you"))
    with pytest.raises(BabblingError, match="do not share their axes"):
        nothing().merged(Play.empty("me", ("ring",), ACTS, STATES, SEEN, CHILDREN))
    with pytest.raises(BabblingError, match="plays of 5 and of 2 children cannot be merged"):
        nothing().merged(Play.empty("me", KINDS, ACTS, STATES, SEEN, 2))
    with pytest.raises(BabblingError, match="movements were seen at other moments"):
        nothing().merged(Play.empty("me", KINDS, ACTS, STATES, SEEN + 1, CHILDREN))
    with pytest.raises(BabblingError, match="learned by another body"):
        nothing().check(Creature(copies=1))


@pytest.mark.parametrize("rounds", [0, 1, 4])
def test_a_file_of_play_comes_back(rounds: int, tmp_path: Path) -> None:
    """At whatever moment it was put down, also before anything was tried; and one plays on from it alike."""
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
    which, states = (np.repeat(axis.ravel(), counts.ravel()) for axis in np.indices(counts.shape))
    return handled(which, states, np.tile(MIDDLE, (len(which), 1)), np.zeros(len(which)))


def test_what_surprises_most_is_practised() -> None:
    """-log P(state | kind) over all that was done with it; not what came about less than twice."""
    play = reaching(np.array([[9, 3, 0, 2], [8, LEAST, LEAST - 1, 0], [1, 1, 1, 1]]))
    assert play.practised(0).tolist() == [3, 1, -1]
    assert play.practised(1).tolist() == [-1, -1, -1]
    assert reaching(np.array([[5, 0, 0, 0], [0] * 4, [0] * 4])).practised(0).tolist() == [0, -1, -1]


@given(seeds)
@settings(max_examples=20, deadline=None)
def test_what_an_aim_brings_about_is_counted_where_it_was_aimed(seed: int) -> None:
    """P(state | aim) = (n + k q) / (N + k) at every aim, q = (what this primitive brings about wherever one aims, and
    1 / O) / (its number + 1), for each way of aiming by itself; 1 where nothing is aimed for."""
    rng, count, size = np.random.default_rng(seed), 40, len(STATES)
    which, states = rng.integers(0, len(ACTS), count), rng.integers(0, size, count)
    cells = rng.integers(0, AIM_POINTS, (count, len(AIMS)))
    aims = MIDDLE + SPREAD * (2 * cells / (AIM_POINTS - 1) - 1)
    found = handled(which, states, aims, np.zeros(count)).aimed(0, np.arange(len(ACTS)), np.array([0, 3, -1]))
    assert found.shape == (len(ACTS), len(AIMS), AIM_POINTS)
    for act, goal in ((0, 0), (1, 3)):
        usual = (((which == act) & (states == goal)).sum() + 1 / size) / ((which == act).sum() + 1)
        for way, cell in np.ndindex(len(AIMS), AIM_POINTS):
            here = (which == act) & (cells[:, way] == cell)
            row = ((here & (states == goal)).sum() + AIM_STRENGTH * usual) / (here.sum() + AIM_STRENGTH)
            assert found[act, way, cell] == pytest.approx(row)
    np.testing.assert_array_equal(found[2], 1)


def test_with_bound_hands_one_learns_nothing_of_aims_and_movements() -> None:
    rng = np.random.default_rng(0)
    _, _, *rest = tries(rng)
    play = nothing().after(0, BUSY, *rest, minutes=1.0)
    assert play.outcomes.counts.sum() == 30 and not play.aims.counts.any()
    assert not (play.moved.any() or play.strain.any() or play.tried.any())
    np.testing.assert_allclose(play.aimed(0, np.zeros(1, int), np.zeros(1, int)), 1 / len(STATES))


def test_comfort_is_a_distribution_and_what_strains_is_rarely_done() -> None:
    strain = np.array([0.5, 2.0, 4.0, 1.5, 2.0, 6.0])
    play = handled(np.arange(6) % 3, np.zeros(6, int), np.tile(MIDDLE, (6, 1)), strain)
    glad = np.exp(-np.array([1.0, 2.0, 5.0]) / (2 * COMFORT**2))
    np.testing.assert_allclose(play.comfort(0), glad / glad.sum())
    np.testing.assert_allclose(play.comfort(1), 1 / len(ACTS))  # never tried: alike
    for kind in (0, 1):
        assert play.comfort(kind).sum() == pytest.approx(1)


def test_appeal_is_comfort_times_what_there_is_to_learn() -> None:
    """comfort (1 + CURIOUS 4 P (1 - P)), P of what is practised; what was never tried has no appeal once others do."""
    which = np.repeat([0, 1], [40, 40])
    states = np.concatenate([np.repeat([0, 3], 20), np.repeat(1, 40)])  # sometimes apart; always up
    play = handled(which, states, np.tile(MIDDLE, (80, 1)), np.full(80, 1.0))
    chance = play.outcomes.predictive[0, 0, FREE, [0, 1], play.practised(0)[:2]]
    raw = play.comfort(0)[:2] * (1 + CURIOUS * 4 * chance * (1 - chance))
    np.testing.assert_allclose(play.appeal(0), [*(raw / raw.sum()), 0.0])
    assert play.appeal(0)[0] > 2 * play.appeal(0)[1]
    np.testing.assert_allclose(play.appeal(1), 1 / len(ACTS))


@given(seeds)
@settings(max_examples=15, deadline=None)
def test_what_one_likes_is_what_one_does_again(seed: int) -> None:
    """Of n tries of a child that ended in several ways, (n - 1) / n each; the rest is the prior, k = PRIOR_STRENGTH."""
    play, k = played(seed), PRIOR_STRENGTH
    liked = np.zeros(play.each.shape[1:])
    for own in play.each:
        for cell in np.ndindex(own.shape[:-1]):
            count = own[cell].sum()
            liked[cell] += own[cell] * (count - 1) / count if count else 0
    np.testing.assert_allclose(play.liked, liked)
    counts = play.outcomes.counts[0]
    for kind, hands in np.ndindex(len(KINDS), len(HANDS)):
        for found, axis in ((play.liking, -1), (play.ends, 0)):
            again, done = liked[kind, hands].sum(axis), counts[kind, hands].sum(axis)
            prior = (done + 1 / len(done)) / (done.sum() + 1)
            np.testing.assert_allclose(found[kind, hands], (again + k * prior) / (again.sum() + k))
    once = nothing().after(*tries(np.random.default_rng(seed), 1), minutes=0.1)
    assert not once.liked.any() and once.outcomes.counts.sum() == 1  # a first try is no liking
