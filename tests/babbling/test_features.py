"""What a movement may depend on: plays, dead zones, signs and bends, against loops that spell them out."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.features import BEFORE, COLUMNS, DEAD, LINES, PLAYS, SLOW, WIDTHS, ZONES, Echo, Features, names
from tests.babbling.joints import JITTER, features

PATHS = st.lists(st.floats(-0.3, 0.3), min_size=1, max_size=12)


def come_to(path: list[float], widths: np.ndarray, start: float) -> list[float]:
    """Where plays stand after a path: each is pushed along by whichever end of its slack the command reaches."""
    places = []
    for width in widths:
        place = start
        for told in path:
            if told > place + width:
                place = told - width
            elif told < place - width:
                place = told + width
        places.append(place)
    return places


def after(mine: Features, path: list[float], start: float = 0.0) -> np.ndarray:
    echo = mine.start(np.full((1, 2), start))
    for told in path:
        echo = mine.after(echo, np.full((1, 2), told))
    return echo.plays[0, 0]


@settings(max_examples=40, deadline=None)
@given(PATHS, st.floats(-0.3, 0.3))
def test_a_play_is_pushed_along_by_the_ends_of_its_slack(path: list[float], start: float) -> None:
    mine = features()
    np.testing.assert_allclose(after(mine, path, start), come_to(path, mine.widths[0], start), atol=1e-15)
    assert after(mine, path, start)[0] == path[-1], "without slack it is the command itself"


@settings(max_examples=40, deadline=None)
@given(PATHS, st.lists(st.integers(1, 4), min_size=12, max_size=12))
def test_a_play_knows_the_path_and_not_the_pace(path: list[float], pauses: list[int]) -> None:
    """Any number of stops on the way leads to the same place (rate independence)."""
    slow, before = [], path[0]
    for told, steps in zip(path, pauses, strict=False):
        slow += [before + share * (told - before) for share in np.arange(1, steps) / steps] + [told]
        before = told
    np.testing.assert_allclose(after(features(), slow), after(features(), path), atol=1e-15)


@settings(max_examples=40, deadline=None)
@given(PATHS, st.floats(0, 1), st.floats(0, 1))
def test_a_small_loop_inside_a_larger_one_leaves_no_trace(path: list[float], there: float, back: float) -> None:
    """Return-point memory: turning round and coming back to the turning point is forgotten."""
    mine, turn = features(), path[-1]
    far = path[-2] if len(path) > 1 else 0.0
    first = turn + there * (far - turn)
    second = turn + back * (first - turn)
    np.testing.assert_allclose(after(mine, [*path, first, second, first, turn]), after(mine, path), atol=1e-15)


def test_a_wide_play_remembers_what_a_narrow_one_forgot() -> None:
    mine = features()
    one, other = after(mine, [0.2, 0.0]), after(mine, [-0.2, 0.0])
    wide = mine.widths[0] > 0
    assert (one[wide] > other[wide]).all() and one[0] == other[0]
    np.testing.assert_allclose(one[wide], np.minimum(mine.widths[0, wide], 0.2 - np.minimum(mine.widths[0, wide], 0.2)))


def test_every_column_is_what_its_name_says() -> None:
    rng = np.random.default_rng(0)
    share = rng.dirichlet(np.ones(len(WIDTHS)), 2)
    plain = features()
    mine = Features(plain.knots, plain.slow, plain.widths, plain.zones, share)
    q, v, c = rng.uniform([[[-0.5]], [[-2]], [[-0.5]]], [[[0.5]], [[2]], [[0.5]]], (3, 5, 2))
    last, plays = rng.uniform(-0.5, 0.5, (5, 2)), rng.uniform(-0.5, 0.5, (5, 2, len(WIDTHS)))
    echo = Echo(last, plays)
    came = mine.after(echo, c)
    before, acted = mine.before(q, v, echo), mine.acted(came.plays - q[..., None])
    assert before.shape[-1] == len(BEFORE) and acted.shape[-1] == len(PLAYS + DEAD)
    assert len(set(COLUMNS)) == len(COLUMNS) == before.shape[-1] + acted.shape[-1]
    for b, f in np.ndindex(5, 2):
        at, rate, told = q[b, f], v[b, f], c[b, f]
        slack = [width * JITTER for width in WIDTHS]
        stands = [come_to([told], [width], place)[0] for width, place in zip(slack, plays[b, f], strict=True)]
        effort = sum(part * (place - at) for part, place in zip(share[f], stands, strict=True))
        wanted = {
            "one": 1.0,
            "rate": rate,
            "before": last[b, f] - at,
            "slow": np.tanh(rate / 0.02),
            "slower": np.tanh(rate / 0.2),
            "posture": at,
            "squared": at**2,
            **{f"hinge {i + 1}": at - knot if at > knot else 0.0 for i, knot in enumerate(mine.knots[f])},
            "action": told - at,
            **{f"play {j}": stands[j] - at for j in range(1, len(WIDTHS))},
        }
        for i, zone in enumerate(np.array(ZONES) * JITTER):
            wanted[f"zone {i + 1}"] = effort - zone if effort > zone else effort + zone if effort < -zone else 0.0
        assert tuple(wanted) == COLUMNS
        np.testing.assert_allclose([*before[b, f], *acted[b, f]], list(wanted.values()), atol=1e-14)


def test_a_run_is_its_steps_one_after_the_other() -> None:
    rng, mine = np.random.default_rng(1), features()
    q, v, c = rng.uniform(-0.5, 0.5, (3, 7, 3, 2))
    whole = mine.of(q, v, c)
    assert whole.shape == (7, 3, 2, len(COLUMNS) + 4)
    weighs = np.stack([np.sin(q[..., 0]), np.sin(q[..., 1]), np.cos(q[..., 0]), np.cos(q[..., 1])], axis=-1)
    np.testing.assert_array_equal(whole[..., len(COLUMNS) :], np.broadcast_to(weighs[:, :, None], (7, 3, 2, 4)))
    for copy in range(3):
        echo = mine.start(q[0, copy])
        for t in range(7):
            here = mine.before(q[t, copy], v[t, copy], echo)
            echo = mine.after(echo, c[t, copy])
            step = np.concatenate([here, mine.acted(echo.plays - q[t, copy][:, None])], axis=-1)
            np.testing.assert_array_equal(whole[t, copy, :, : len(COLUMNS)], step)


def test_each_line_knows_more_than_the_one_before_it() -> None:
    assert set(LINES["line"]) < set(LINES["posture"]) < set(LINES["play"]) == set(COLUMNS) - {"one"}
    assert names("play", 2) == LINES["play"] and names("gravity", 2)[len(COLUMNS) - 1 :] == (
        "sin 0",
        "sin 1",
        "cos 0",
        "cos 1",
    )
    assert len(SLOW) == 2 and WIDTHS[0] == 0 and sorted(WIDTHS) == list(WIDTHS)
