"""Populations and differences: agents are the unit, intervals are exact where they can be and stay where rates are."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from experiments.battery.effects import (
    FEW,
    INSIDE,
    NOT_COMPARABLE,
    OTHER,
    OUTSIDE,
    SAME,
    beside,
    by_agent,
    differences,
    populations,
    sign,
)
from experiments.battery.intervals import FEWEST, Estimate, apart, cohens_h, hedges_g, of_mean
from experiments.errors import ExperimentError
from experiments.shared.judging import interval_95


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def told(hits: dict[str, Any], first: int = 0, **more: Any) -> pd.DataFrame:
    """Condition -> (agents, trials) of hits, or of values."""
    rows = [
        {"agent": first + agent, "task": "cup", "condition": shown, "trial": trial, "response": "x", "hit": hit, **more}
        for shown, each in hits.items() for agent, trials in enumerate(each) for trial, hit in enumerate(trials)
    ]  # fmt: skip
    return pd.DataFrame(rows)


def test_trials_are_no_agents() -> None:
    hits = rng(1).integers(0, 2, (30, 4)).astype(float)
    once = populations(told({"shown": hits, "still": 1 - hits[:, ::-1]}), rng=rng())
    often = populations(told({"shown": np.tile(hits, 25), "still": np.tile(1 - hits[:, ::-1], 25)}), rng=rng())
    pd.testing.assert_frame_equal(once, often)
    assert once["n"].tolist() == [30, 30]
    assert (once["high"] - once["low"]).min() > 2 * stats.norm.ppf(0.975) * hits.mean(1).std() / np.sqrt(30) * 0.9


def test_a_trial_each_is_the_exact_interval_and_any_order_of_rows_the_same() -> None:
    frame = told({"shown": rng(2).integers(0, 2, (25, 1)).astype(float)})
    [row] = populations(frame, rng=rng()).to_dict("records")
    exact = stats.binomtest(int(frame["hit"].sum()), 25).proportion_ci(0.95, "exact")
    assert (row["low"], row["high"]) == pytest.approx((exact.low, exact.high)) and row["method"] == "exact"
    mixed = told({"shown": rng(3).random((25, 3)).round(), "still": rng(4).random((25, 3)).round()})
    shuffled = mixed.sample(frac=1, random_state=5)
    pd.testing.assert_frame_equal(populations(mixed, rng=rng()), populations(shuffled, rng=rng()))
    pd.testing.assert_frame_equal(
        differences(mixed, "condition", rng=rng()), differences(shuffled, "condition", rng=rng())
    )


@pytest.mark.parametrize("n", [2, 5, FEWEST, 60])
@pytest.mark.parametrize("rate", [0.0, 0.02, 0.5, 1.0])
def test_no_interval_of_a_rate_leaves_it_or_is_a_point(n: int, rate: float) -> None:
    for trials in (1, 3):
        hits = (rng(n).random((2, n, trials)) < rate).astype(float)
        frame = told({"shown": hits[0], "still": hits[1]})
        for one in populations(frame, rng=rng()).itertuples():
            assert 0 <= one.low <= one.mean <= one.high <= 1 and one.high - one.low > 0.01
        for one in differences(frame, "condition", rng=rng()).itertuples():
            assert -1 <= one.low <= one.difference <= one.high <= 1 and one.high - one.low > 0.01
        later = pd.concat([told({"shown": hits[0]}), told({"still": hits[1]}, first=n)])
        [row] = differences(later, "condition", rng=rng()).to_dict("records")
        assert not row["paired"] and -1 <= row["low"] <= row["difference"] <= row["high"] <= 1
        assert -np.pi <= row["size_low"] <= row["size"] <= row["size_high"] <= np.pi


@pytest.mark.parametrize(
    ("n", "mean", "bounds"), [(8, 0.8, (0.0, 1.0)), (30, 0.8, (0.0, 1.0)), (8, 0.0, None), (40, 0.0, None)]
)
def test_intervals_hold_the_truth_as_often_as_they_say(n: int, mean: float, bounds: tuple[float, float] | None) -> None:
    draw, held = rng(n), 0
    for _ in range(200):
        values = draw.binomial(4, draw.beta(4, 1, n)) / 4 if bounds else draw.normal(0, 1, n)
        found = of_mean(values, draw, bounds)
        held += found.low <= mean <= found.high
    assert 180 <= held


def test_bounds_are_never_narrower_than_the_exact_interval_of_the_same_mean() -> None:
    for n, hits in ((6, 0), (6, 3), (20, 20), (20, 7)):
        exact = stats.binomtest(hits, n).proportion_ci(0.95, "exact")
        assert interval_95(hits, n) == pytest.approx((exact.low, exact.high))
        halves = np.full(n, hits / n)  # nobody differs, and yet not all is known
        found = of_mean(halves, rng(), (0.0, 1.0))
        assert (found.low, found.high) == pytest.approx((exact.low, exact.high))


def test_one_infant_has_no_interval() -> None:
    with pytest.raises(ExperimentError, match="cup, shown: 1 infant; an interval over infants needs at least 2"):
        populations(told({"shown": [[1, 0, 1]]}), rng=rng())


def test_the_same_agents_are_compared_with_themselves() -> None:
    base = rng(6).random(40)
    far = told({"shown": base[:, None] + 0.1, "still": base[:, None]}).rename(columns={"hit": "value"})
    [row] = differences(far, "condition", rng=rng()).to_dict("records")
    assert row["paired"] and row["a"] == "shown" and row["n_a"] == 40
    assert row["low"] == pytest.approx(0.1) == row["high"] and np.isnan(row["size"])  # no agent differs from another
    noisy = far.assign(value=far["value"] + rng(7).normal(0, 0.05, len(far)))
    [same] = differences(noisy, "condition", rng=rng()).to_dict("records")
    away = noisy.assign(agent=noisy["agent"] + 100 * (noisy["condition"] == "still"))
    [apart_] = differences(away, "condition", rng=rng()).to_dict("records")
    assert not apart_["paired"] and same["difference"] == pytest.approx(apart_["difference"])
    assert same["high"] - same["low"] < 0.5 * (apart_["high"] - apart_["low"]) and same["size"] > 2 * apart_["size"]


def test_agents_of_the_same_seed_are_compared_across_a_factor() -> None:
    hits = rng(8).integers(0, 2, (12, 5)).astype(float)
    parts = [told({"shown": hits}, seed=0, memory=0.5), told({"shown": hits}, first=50, seed=0, memory=1.0)]
    frame = pd.concat([part.assign(seed=part["agent"] % 50) for part in parts])
    [row] = differences(frame, "memory", rng=rng()).to_dict("records")
    assert row["paired"] and (row["a"], row["b"], row["difference"]) == (0.5, 1.0, 0.0)
    assert set(by_agent(frame)["memory"]) == {0.5, 1.0}
    with pytest.raises(ExperimentError, match=r"unknown column 'memry'; .*did you mean 'memory'"):
        differences(frame, "memry", rng=rng())


def test_differences_of_strangers_are_newcombes() -> None:
    """Newcombe (1998), method 10, but for the intervals of the two: 56/70 - 48/80 by Wilson's is 0.0524 to 0.3339."""
    both = []
    for hits, n in ((56, 70), (48, 80)):
        wilson = stats.binomtest(hits, n).proportion_ci(0.95, "wilson")
        both.append(Estimate(hits / n, wilson.low, wilson.high))
    found = apart(*both)
    assert (found.low, found.value, found.high) == pytest.approx((0.0524, 0.2, 0.3339), abs=1e-4)
    h = cohens_h(*both)
    assert h.value == pytest.approx(2 * (np.arcsin(0.8**0.5) - np.arcsin(0.6**0.5))) and h.low < h.value < h.high
    assert cohens_h(*both[::-1]).low == pytest.approx(-h.high)


def test_hedges_g_and_its_interval_by_the_noncentral_t() -> None:
    a, b = rng(9).normal(1, 1, 12), rng(10).normal(0, 1, 15)
    found = hedges_g(a, b, paired=False)
    t = stats.ttest_ind(a, b).statistic
    few, scale = 1 - 3 / (4 * 25 - 1), np.sqrt(1 / 12 + 1 / 15)
    assert found.value == pytest.approx(few * t * scale)
    for end, tail in ((found.low, 0.975), (found.high, 0.025)):
        assert stats.nct.cdf(t, 25, end / few / scale) == pytest.approx(tail)
    assert (found.low > 0) == (stats.ttest_ind(a, b).pvalue < 0.05)
    own = hedges_g(a, b[:12], paired=True)
    assert own.value == pytest.approx((1 - 3 / 43) * stats.ttest_rel(a, b[:12]).statistic / np.sqrt(12))
    assert (own.low > 0) == (stats.ttest_rel(a, b[:12]).pvalue < 0.05)
    assert np.isnan(hedges_g(np.ones(3), np.zeros(3), paired=False).value)


def test_an_effect_beyond_all_bounds_has_an_interval_too() -> None:
    rng = np.random.default_rng(0)
    near, far = 1e-3 * rng.standard_normal(20), 60 + 0.5 * rng.standard_normal(20)
    for paired in (True, False):
        found = hedges_g(far, near, paired=paired)
        assert 0 < found.low < found.value < found.high < np.inf
        less = hedges_g(near, far, paired=paired)
        assert less.high == pytest.approx(-found.low, rel=0.1) and less.low == pytest.approx(-found.high, rel=0.1)
    assert hedges_g(1e4 * far, near, paired=False).high < np.inf


def test_a_rate_is_inside_where_the_published_interval_has_it() -> None:
    exact = stats.binomtest(8, 10).proportion_ci(0.95, "exact")
    for rate, word in (
        (exact.low + 1e-6, INSIDE),
        (exact.low - 1e-6, FEW),
        (exact.low - 0.02, OUTSIDE),
        (0.8, INSIDE),
        (0.99, OUTSIDE),
    ):
        found = beside(Estimate(rate, rate - 0.01, min(rate + 0.01, 1)), 0.8, 10)
        assert found.word == word and found.published is not None
    simulated = Estimate(0.8, 0.7, 0.9)
    assert beside(simulated, 0.8, None).word == beside(simulated, None, 10).word == NOT_COMPARABLE
    with pytest.raises(ExperimentError, match=r"published rate 80 of 10 infants"):
        beside(simulated, 80, 10)


def test_a_sign_needs_an_interval_on_one_side() -> None:
    assert sign(Estimate(0.2, 0.1, 0.3)).word == SAME and sign(Estimate(-0.2, -0.3, -0.1)).word == OTHER
    assert sign(Estimate(0.2, -0.1, 0.5)).word == sign(Estimate(0.2, 0.0, 0.5)).word == FEW
