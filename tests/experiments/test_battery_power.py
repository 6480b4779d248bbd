"""Power: what it is where there is nothing to find, where there is, and against the exact sum."""

import numpy as np
import pytest
from scipy import stats

from experiments.battery.power import ALPHA, NS, Power, fisher, power, power_figure, welch
from experiments.errors import ExperimentError


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_power_of_rates_is_the_sum_over_all_studies() -> None:
    """Draws with replacement are binomial, so that power is a sum over both counts of hits."""
    a, b, n = np.repeat([1.0, 0.0], [16, 4]), np.repeat([1.0, 0.0], [8, 12]), 20
    found = power(a, b, (n,), 4000, rng=rng())
    weight = [stats.binom.pmf(np.arange(n + 1), n, rate) for rate in (0.8, 0.4)]
    sure = [[stats.fisher_exact([[k, n - k], [m, n - m]])[1] < ALPHA for m in range(n + 1)] for k in range(n + 1)]
    exact = weight[0] @ np.array(sure) @ weight[1]
    assert found.test == "Fisher's exact test" and found.interval[0, 0] <= exact <= found.interval[0, 1]


def test_fisher_is_scipys_whichever_group_is_first() -> None:
    draw = rng(1)
    a, b = draw.integers(0, 16, (2, 60))
    expected = [stats.fisher_exact([[k, 15 - k], [m, 15 - m]])[1] < ALPHA for k, m in zip(a, b, strict=True)]
    assert fisher(a, b, 15).tolist() == fisher(b, a, 15).tolist() == expected
    assert 5 < sum(expected) < 55


def test_nothing_to_find_is_found_as_often_as_alpha() -> None:
    same = rng(2).normal(0, 1, 200)
    means = power(same, same, (8, 40), 4000, rng=rng(3))
    assert means.test == "Welch's t test" and means.share == pytest.approx(ALPHA, abs=0.012)
    hits = np.repeat([1.0, 0.0], 20)
    rates = power(hits, hits, (8, 128), 4000, rng=rng(4))
    assert (rates.share <= ALPHA).all() and rates.share[1] > 0.02  # exact tests keep below


def test_welch_is_scipys_and_groups_of_no_spread_are_compared() -> None:
    a, b = rng(5).normal(0.8, 1, (50, 12)), rng(6).normal(0, 2, (50, 12))
    expected = stats.ttest_ind(a, b, axis=1, equal_var=False).pvalue < ALPHA
    assert welch(a, b).tolist() == expected.tolist() and 0 < expected.sum() < 50
    assert welch(np.ones((2, 3)), np.array([[1, 1, 1], [2, 2, 2.0]])).tolist() == [False, True]


def test_more_infants_find_more_and_enough_is_where_it_stays_enough() -> None:
    a, b = np.repeat([1.0, 0.0], [14, 6]), np.repeat([1.0, 0.0], [8, 12])
    found = power(a, b, rng=rng(7))
    assert found.ns == NS and found.share[-1] > 0.98 and found.share[0] < 0.3
    assert (np.diff(found.share) > -0.03).all()
    assert found.enough is not None and 40 <= found.enough <= 56  # 42 by the usual table of h = 0.61
    wavers = Power("", "", (8, 16, 24), np.array([90, 70, 85]), 100)
    assert wavers.enough == 24 and Power("", "", (8, 16), np.array([90, 70]), 100).enough is None
    assert Power("", "", (8, 16), np.array([80, 90]), 100).enough == 8


def test_intervals_are_of_the_draws() -> None:
    few, many = (power(np.array([0, 1.0] * 5), np.ones(10), (16,), n, rng=rng(8)).interval[0] for n in (100, 10_000))
    assert few[1] - few[0] == pytest.approx(10 * (many[1] - many[0]), rel=0.4)


def test_nobody_is_no_group() -> None:
    with pytest.raises(ExperimentError, match="power of cup: 1 in a group; at least 2"):
        power(np.ones(1), np.ones(5), name="cup", rng=rng())
    with pytest.raises(ExperimentError, match="1 in a group"):
        power(np.ones(5), np.ones(5), (1,), rng=rng())


def test_the_figure_says_how_many_are_enough() -> None:
    a, b = np.repeat([1.0, 0.0], [14, 6]), np.repeat([1.0, 0.0], [8, 12])
    found = [power(a, b, repeats=200, name="cup", rng=rng()), power(a, a, repeats=200, name="same", rng=rng())]
    figure = power_figure(found)
    told = [text.get_text() for text in figure.legends[0].get_texts()]
    assert told[0].startswith(f"cup: {found[0].enough} infants") and "same: more than 128" in told[1]
    assert figure.get_label()
