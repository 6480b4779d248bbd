"""What became of an object: thresholds, who lit it, joined; and that where the table stands makes no difference."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.objects import TOYS
from models.objects.states import (
    APART,
    APART_M,
    BUZZ,
    JOINED,
    LIT_BY_HAND,
    LIT_BY_HEAD,
    MOVED,
    MOVED_M,
    SAME,
    STATES,
    UP,
    UP_M,
    Watched,
    buzzed,
    handled,
    joined,
    lit,
    pulled,
)

HAIR = 1e-6
FAR = np.array([0.5, 0, 0])
T = 5


def watched(a: np.ndarray, b: np.ndarray | None = None, signal: np.ndarray | None = None) -> Watched:
    """(T, B, 3) of a, of b (far away and still), of the light (dark); hands and head far away."""
    b = np.zeros(a.shape) + FAR if b is None else b
    dark = np.zeros(a.shape[:2], bool)
    return Watched(np.stack([a, b], 2), np.full((*a.shape[:2], 3, 3), 9.0), dark if signal is None else signal)


def ways(*ends: tuple[float, float, float]) -> np.ndarray:
    """(T, B, 3) from the origin straight to each of the ends."""
    return np.linspace(0, 1, T)[:, None, None] * np.array(ends)


@pytest.mark.parametrize("state", [handled, pulled, buzzed, lambda seen: joined(seen, 0.01)])
def test_moved_is_along_the_table_and_up_is_how_high_it_ever_was(state: Callable[[Watched], np.ndarray]) -> None:
    ends = ways(
        (MOVED_M - HAIR, 0, 0), (0, -MOVED_M - HAIR, 0), (0, 0, UP_M - HAIR), (0, 0, UP_M + HAIR), (0, 0, -0.1),
        (1.0, 0, UP_M + HAIR), (0.6 * MOVED_M, 0.8 * MOVED_M + HAIR, 0),
    )  # fmt: skip
    both = watched(ends, ends + FAR)
    assert state(both).tolist() == [SAME, MOVED, SAME, UP, SAME, UP, MOVED]
    back = np.concatenate([ends, ends[::-1]])
    assert state(watched(back, back + FAR)).tolist() == [SAME, SAME, SAME, UP, SAME, UP, SAME]


def test_apart_is_how_much_further_its_ends_are_and_outdoes_the_rest() -> None:
    rest = np.zeros((T, 4, 3))
    more = APART_M + HAIR
    away = FAR + ways((APART_M - HAIR, 0, 0), (more, 0, 0), (more, 0, 0), (-0.1, 0, 0))
    rest[:, 2] = ways((0, 0, 0.1))[:, 0]
    away[:, 2, 2] = rest[:, 2, 2]
    assert pulled(watched(rest, away)).tolist() == [SAME, APART, APART, SAME]
    again = np.concatenate([away, away[::-1]])
    assert pulled(watched(np.concatenate([rest, rest[::-1]]), again)).tolist() == [SAME, SAME, UP, SAME]


def test_joined_needs_both_nearness_and_depth() -> None:
    """a ends within the ring's reach of b's middle line and below b's middle; where it was before does not matter."""
    within, b = 0.02, np.zeros((T, 5, 3))
    begin = np.tile([0.1, 0.0, 0.0], (T, 5, 1))
    for copy, end in enumerate(
        [
            (within - HAIR, 0, -HAIR),
            (within + HAIR, 0, -HAIR),
            (0, within - HAIR, HAIR),
            (0, 0, -0.1),
            (0.015, 0.015, -HAIR),
        ]
    ):
        begin[-1, copy] = end
    found = joined(watched(begin, b), within)
    assert (found == JOINED).tolist() == [True, False, False, True, False]
    assert found[1] == MOVED


def test_what_lit_it_is_what_was_nearest_when_it_lit_up() -> None:
    signal = np.zeros((T, 5), bool)
    signal[2:4] = [True, True, True, False, True]
    seen = watched(np.zeros((T, 5, 3)), signal=signal)
    at = {0: 0, 1: 1, 2: 2, 3: 2}
    for copy, part in at.items():
        seen.parts[2, copy, part] = 0.01
    seen.parts[3:, 0, 2] = seen.parts[0, 1, 2] = 0.001  # nearer, but before or after
    seen.parts[2, 4] = [[0.03, 0, 0], [0, 0.03, 0], [0, 0, 0.029]]
    assert lit(seen).tolist() == [LIT_BY_HAND, LIT_BY_HAND, LIT_BY_HEAD, SAME, LIT_BY_HEAD]
    under_a_blanket = seen.parts.copy()
    under_a_blanket[:, :, :2] = np.nan
    hidden = lit(Watched(seen.handles, under_a_blanket, seen.signal)).tolist()
    assert hidden == [LIT_BY_HEAD, LIT_BY_HEAD, LIT_BY_HEAD, SAME, LIT_BY_HEAD]  # what does not show did not do it


def test_of_oneself_one_feels_what_lit_it_whatever_is_nearest() -> None:
    signal, touch = np.zeros((T, 4), bool), np.zeros((T, 4, 3))
    signal[2:4] = [True, True, True, False]
    seen = watched(np.zeros((T, 4, 3)), signal=signal)
    seen.parts[2, :, 2] = 0.01
    touch[2, :2] = [[0, 70.0, 0.4], [1.0, 0, 20.0]]
    touch[1, 0, 2] = touch[3, 0, 2] = 99.0  # before and after
    assert lit(seen).tolist() == [LIT_BY_HEAD, LIT_BY_HEAD, LIT_BY_HEAD, SAME]
    assert lit(replace(seen, touch=touch)).tolist() == [
        LIT_BY_HAND,
        LIT_BY_HEAD,
        LIT_BY_HEAD,
        SAME,
    ]  # nothing felt: seen


def test_a_buzz_outdoes_the_rest_however_short_it_was() -> None:
    signal = np.zeros((T, 3), bool)
    signal[1, 0] = signal[-1, 1] = True
    assert buzzed(watched(ways((0, 0, 1), (0, 0, 0), (0, 0, 1)), signal=signal)).tolist() == [BUZZ, BUZZ, UP]


@pytest.mark.parametrize("toy", TOYS)
@given(st.integers(0, 2**31), st.floats(-np.pi, np.pi), st.tuples(*[st.floats(-2, 2)] * 3))
@settings(max_examples=25, deadline=None)
def test_where_the_table_stands_makes_no_difference(toy: str, seed: int, turn: float, shift: tuple[float, ...]) -> None:
    """Turned about the upright axis and moved as a whole, copies in any order: the same things became of them."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(0, 0.006, (T, 20, 5, 3)).cumsum(0) + rng.uniform(-0.03, 0.03, (20, 5, 3))
    signal = rng.random((T, 20)) < 0.1
    cosine, sine = np.cos(turn), np.sin(turn)
    moved = steps @ np.array([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]]) + shift
    order = rng.permutation(20)
    one, other = (
        TOYS[toy].state(Watched(steps[:, :, 3:], steps[:, :, :3], signal)),
        TOYS[toy].state(Watched(moved[:, order, 3:], moved[:, order, :3], signal[:, order])),
    )
    np.testing.assert_array_equal(one[order], other)
    assert set(one) <= set(range(len(STATES)))


def test_all_states_come_about_in_such_scenes() -> None:
    """What the law above is checked on is not always the same state."""
    rng, found = np.random.default_rng(0), set()
    for toy in TOYS.values():
        steps = rng.normal(0, 0.006, (T, 200, 5, 3)).cumsum(0) + rng.uniform(-0.03, 0.03, (200, 5, 3))
        found |= set(toy.state(Watched(steps[:, :, 3:], steps[:, :, :3], rng.random((T, 200)) < 0.1)).tolist())
    assert found == set(range(len(STATES)))
