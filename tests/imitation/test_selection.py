"""Selection rules: frequencies, ties and means are what the rule says, on categories and between grid points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chisquare, kstest

from babbling.axes import Axis
from imitation.errors import ImitationError
from imitation.inference.selection import SELECTION, select_map, select_matching, select_mean, selection_rule

seeds = st.integers(0, 2**32 - 1)
CATEGORIES = Axis.categorical("action", ("N", "E", "S", "W", "X"))
GRID = Axis("action", "rad", np.array([-1.0, 2.0]), np.array([1.0, 6.0]), 41)


def posterior(centre: float, spread: float) -> np.ndarray:
    """(2, 41) Gaussians about the same place in grid steps."""
    k = np.arange(41)
    p = np.exp(-(((k - centre) / spread) ** 2) / 2)
    return np.tile(p / p.sum(), (2, 1))


def test_matching_draws_with_the_posteriors_frequencies() -> None:
    p = np.array([0.5, 0.25, 0.0, 0.2, 0.05])
    drawn = select_matching(np.tile(p, (20_000, 1, 1)), CATEGORIES, np.random.default_rng(0))
    counts = np.bincount(drawn.astype(int).ravel(), minlength=5)
    assert counts[2] == 0  # the impossible is never done
    assert chisquare(counts[p > 0], 20_000 * p[p > 0]).pvalue > 1e-3


def test_matching_on_a_measured_axis_draws_from_the_density_of_the_grid() -> None:
    """One certain grid point gives its hat: triangular, two steps wide."""
    p = np.zeros((8000, 2, 41))
    p[..., 20] = 1
    drawn = select_matching(p, GRID, np.random.default_rng(1))

    def hat(x: np.ndarray) -> np.ndarray:
        """Cumulative distribution of the triangle on -1 .. 1."""
        return np.where(x < 0, (1 + x) ** 2 / 2, 1 - (1 - x) ** 2 / 2)

    for f, centre in enumerate((0.0, 4.0)):
        assert kstest((drawn[:, f] - centre) / GRID.step[f], hat).pvalue > 1e-3


def test_map_breaks_ties_by_the_generator_alone() -> None:
    tied = np.tile(np.array([0.3, 0.0, 0.3, 0.1, 0.3]), (9000, 1, 1))
    counts = np.bincount(select_map(tied, CATEGORIES, np.random.default_rng(0)).astype(int).ravel(), minlength=5)
    assert counts[1] == counts[3] == 0
    assert chisquare(counts[[0, 2, 4]]).pvalue > 1e-3
    clear = np.array([[0.1, 0.6, 0.3, 0.0, 0.0]])
    rng = np.random.default_rng(7)
    assert select_map(clear, CATEGORIES, rng) == 1
    assert rng.random() == np.random.default_rng(7).random()  # without a tie nobody asks it


@settings(max_examples=60, deadline=None)
@given(st.floats(1.0, 39.0), st.floats(0.6, 6.0))
def test_map_finds_the_peak_between_grid_points(centre: float, spread: float) -> None:
    """Exact for a Gaussian: its log is a parabola."""
    found = select_map(posterior(centre, spread), GRID, np.random.default_rng(0))
    np.testing.assert_allclose(found, GRID.low + centre * GRID.step, atol=1e-9)


@pytest.mark.parametrize("end", [0, 40])
def test_map_at_an_end_or_beside_the_impossible_stays_on_its_grid_point(end: int) -> None:
    found = select_map(posterior(end, 2.0), GRID, np.random.default_rng(0))
    np.testing.assert_allclose(found, GRID.points[:, end])
    p = np.zeros((2, 41))
    p[:, 7] = 1
    np.testing.assert_allclose(select_map(p, GRID, np.random.default_rng(0)), GRID.points[:, 7])


@settings(max_examples=60, deadline=None)
@given(seeds, st.sampled_from([1, 3, 1000]))
def test_map_stays_within_half_a_step_of_the_most_probable_grid_point(seed: int, levels: int) -> None:
    """With few levels nearly everything is tied; the peak of a flat top may lie half-way, never beyond."""
    p = np.random.default_rng(seed).integers(0, levels + 1, (50, 2, 41)) + 1e-3
    p[..., 20] = levels + 1e-3
    p[:, 1] *= 1 - np.random.default_rng(seed).integers(0, 9, (50, 41)) * 2.0**-53  # as near to a tie as can be
    place = (select_map(p / p.sum(-1, keepdims=True), GRID, np.random.default_rng(0)) - GRID.low) / GRID.step
    best = p >= p.max(-1, keepdims=True) * (1 - 1e-12)
    away = np.where(best, np.abs(np.arange(41) - place[..., None]), np.inf).min(-1)
    assert away.max() <= 0.5 + 1e-9


def test_mean_minimises_the_expected_squared_error() -> None:
    p = np.random.default_rng(0).dirichlet(np.ones(41), 2)
    mean = select_mean(p, GRID, np.random.default_rng(0))
    costs = [(p * (GRID.points - (mean + shift)[:, None]) ** 2).sum(-1) for shift in (-1e-3, 0, 1e-3)]
    assert (costs[1] < costs[0]).all() and (costs[1] < costs[2]).all()


def test_categories_have_no_mean() -> None:
    with pytest.raises(ImitationError, match=r"categories and have no mean; use map or matching"):
        select_mean(np.full((1, 5), 0.2), CATEGORIES, np.random.default_rng(0))


@settings(max_examples=25, deadline=None)
@given(seeds)
def test_matching_is_right_on_average(seed: int) -> None:
    """The mean of many draws is the posterior mean (hats keep it), away from the axis' ends."""
    p = np.zeros((2, 41))
    p[:, 5:36] = np.random.default_rng(seed).dirichlet(np.ones(31), 2)
    drawn = select_matching(np.tile(p, (2000, 1, 1)), GRID, np.random.default_rng(seed))
    mean = select_mean(p, GRID, np.random.default_rng(0))
    spread = np.sqrt((p * GRID.points**2).sum(-1) - mean**2 + GRID.step**2 / 6)
    assert (np.abs(drawn.mean(0) - mean) < 5 * spread / np.sqrt(2000)).all()


def test_unknown_rules() -> None:
    with pytest.raises(ImitationError, match=r"unknown selection 'men'; there are .*; did you mean 'mean'\?"):
        selection_rule("men")
    assert set(SELECTION) == {"mean", "map", "matching"}
