"""Where to aim is Eq. (1): what brought the state about is aimed at again; what is aimed for nothing goes anywhere."""

import numpy as np
import pytest

from babbling.play import AIM_POINTS, EAGER, MIDDLE, SPREAD
from imitation.acting.aiming import aims
from tests.babbling.test_play import handled

GRID = np.linspace(-1, 1, AIM_POINTS)
UP = 2
"""The way of aiming that decides, below."""


def found_out(count: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    """Aims from all over, and whether they were high enough: the state 2 comes about, or 0."""
    shares = np.random.default_rng(0).uniform(-1, 1, (count, 5))
    return shares, np.where(shares[:, UP] > 0.4, 2, 0)


PLAY = handled(np.zeros(4000, int), found_out()[1], MIDDLE + SPREAD * found_out()[0], np.zeros(4000))


def chosen(state: int, selection: str, count: int = 3000) -> np.ndarray:
    """(count, 5) aims as shares of what may be aimed at."""
    which, states = np.zeros(count, int), np.full(count, state)
    return (aims(PLAY, 0, which, states, selection, np.random.default_rng(1)) - MIDDLE) / SPREAD


@pytest.mark.parametrize("selection", ["map", "matching", "mean"])
def test_what_worked_is_aimed_at(selection: str) -> None:
    high, low = (chosen(state, selection)[:, UP] for state in (2, 0))
    assert high.mean() > 0.3 and low.mean() < 0
    for share in (high, low):
        assert np.abs(share).max() <= 1 + 1e-12
    if selection == "map":
        assert (high > 0.4).all() and (low < 0.4).all()


def test_matching_draws_an_aim_as_often_as_it_is_probable() -> None:
    """P(aim) = c P(state | aim)^EAGER, spread over the grid's hats, one way of aiming independent of the others."""
    likely = PLAY.aimed(0, np.zeros(1, int), np.array([2]))[0] ** EAGER
    posterior = likely / likely.sum(-1, keepdims=True)
    drawn = chosen(2, "matching", 20_000)
    np.testing.assert_allclose(drawn.mean(0)[UP], posterior[UP] @ GRID, atol=0.06)  # an end's hat is folded inwards
    assert np.abs(np.corrcoef(drawn.T) - np.eye(5)).max() < 0.04


def test_what_is_aimed_for_nothing_goes_anywhere() -> None:
    drawn = chosen(-1, "matching", 20_000)
    assert np.abs(drawn.mean(0)).max() < 0.03
    assert (drawn.std(0) > 0.5).all()
