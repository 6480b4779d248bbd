"""How good something was: proper scores against the constant peer, tests of equivalence, intervals over learners."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import norm, t

from experiments.shared.judging import (
    Sweep,
    Verdict,
    above_zero,
    alike,
    constant_confidence,
    difference,
    more_often,
    oftener,
    over_learners,
    over_learners_above_zero,
    scores,
    share_over_learners,
    within,
)


def test_scores_by_hand() -> None:
    belief, target = np.array([[0.5, 0.3, 0.2], [0.1, 0.1, 0.8]]), np.array([1, 2])
    loss, brier, off = scores(belief, target)
    assert loss == pytest.approx(-(np.log(0.3) + np.log(0.8)) / 2)
    assert brier == pytest.approx((0.5**2 + 0.7**2 + 0.2**2 + 0.1**2 + 0.1**2 + 0.2**2) / 2)
    assert off == pytest.approx((0.5 + 0.2) / 2)
    assert scores(np.eye(3)[[0]], np.array([1]))[0] == pytest.approx(-np.log(1e-6))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 5))
def test_constant_confidence_is_calibrated_and_says_no_more_than_its_accuracy(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    belief, target = rng.dirichlet(np.ones(count), 50), rng.integers(count, size=50)
    right = float((belief.argmax(1) == target).mean())
    wrong = 1 - right
    loss, brier, off = scores(constant_confidence(belief, target), target)
    terms = [-p * np.log(q) for p, q in ((right, right), (wrong, wrong / (count - 1))) if p > 0]
    assert loss == pytest.approx(sum(terms))
    assert brier == pytest.approx(right * (wrong**2 + wrong**2 / (count - 1)) + wrong * (
        right**2 + (1 - wrong / (count - 1)) ** 2 + (count - 2) * (wrong / (count - 1)) ** 2))  # fmt: skip
    if right > 1 / count:
        assert off == pytest.approx(0, abs=1e-12)


def test_proper_scores_tell_who_knows_when_from_who_knows_how_often() -> None:
    rng = np.random.default_rng(0)
    belief = rng.dirichlet(np.full(4, 0.5), 20_000)
    target = (belief.cumsum(1) < rng.random((20_000, 1))).sum(1)
    ours, constant = scores(belief, target), scores(constant_confidence(belief, target), target)
    assert ours[2] < 0.02 and constant[2] < 1e-12  # calibration error praises both
    assert ours[0] < constant[0] - 0.1 and ours[1] < constant[1] - 0.05


@pytest.mark.parametrize(("one", "other"), [((50, 100), (50, 100)), ((97, 100), (99, 100)), ((20, 20), (20, 20))])
def test_alike_is_where_the_90_percent_interval_lies_within_the_margin(
    one: tuple[int, int], other: tuple[int, int]
) -> None:
    gap, error = difference(one, other)
    edge = abs(gap) + norm.ppf(0.95) * error
    assert alike(one, other, edge) == pytest.approx(0.05)
    assert alike(one, other, edge + 0.01) < 0.05 < alike(one, other, edge - 0.01)
    assert alike(one, other, 0.1) == pytest.approx(alike(other, one, 0.1))


def test_few_trials_never_make_things_alike() -> None:
    assert alike((5, 10), (5, 10), 0.19) > 0.05 > alike((250, 500), (250, 500), 0.19)
    assert alike((10, 100), (90, 100), 0.19) > 0.99


@pytest.mark.parametrize("p", [0.5, 0.75])
def test_what_differs_by_the_margin_is_called_alike_once_in_twenty(p: float) -> None:
    rng, n, margin = np.random.default_rng(1), 100, 0.19
    hits = rng.binomial(n, [p, p - margin], (3000, 2))
    share = np.mean([alike((int(a), n), (int(b), n), margin) < 0.05 for a, b in hits])
    assert 0.03 < share < 0.065


def test_intervals_over_learners_hold_the_truth_nineteen_times_in_twenty() -> None:
    values = np.random.default_rng(2).normal(3.0, 2.0, (5, 4000))
    mean, half = over_learners(values)
    assert np.mean(np.abs(mean - 3.0) <= half) == pytest.approx(0.95, abs=0.012)
    assert half[0] == pytest.approx(t.ppf(0.975, 4) * values[:, 0].std(ddof=1) / np.sqrt(5))


def test_shares_over_learners_lie_between_none_and_all() -> None:
    all_but_one = np.array([0.95, 1.0, 1.0])
    mean, half = over_learners(all_but_one)
    assert mean + half > 1
    assert share_over_learners(all_but_one) == (pytest.approx(mean - half), 1.0)
    assert share_over_learners(1 - all_but_one)[0] == 0.0
    assert share_over_learners(all_but_one[:1]) is None


def test_one_rule_beyond_another_is_paired_by_learner() -> None:
    base = np.array([[0.2, 0.4], [0.6, 0.8], [0.5, 0.1]])
    right = np.stack([base + 0.1, base], axis=1)
    sweep = Sweep("noise", (1.0, 2.0), ("ours", "theirs"), right)
    np.testing.assert_allclose(sweep.beyond("theirs"), 0.1)  # learners differ, the gap does not
    assert sweep.numbers()["theirs"]["half_95"].min() > 0.3


def verdicts(n: int, p: float, q: float, rng: np.random.Generator) -> list[Verdict]:
    """Of things that happen so often, in n trials each: together, apart, and over n learners."""
    one, other = rng.random(n) < p, rng.random(n) < q
    apart = oftener((int(one.sum()), n), (int(other.sum()), n))
    return [more_often(one, other), apart, over_learners_above_zero(p - q + rng.normal(0, 0.2, n))]


@pytest.mark.parametrize("n", [0, 1, 2, 3])
def test_with_very_few_trials_no_claim_is_made_whatever_they_say(n: int) -> None:
    yes, no = np.ones(n, bool), np.zeros(n, bool)
    told = [more_often(yes, no), more_often(no, yes), oftener((n, n), (0, n)), oftener((0, n), (n, n))]
    assert all(one.holds is None and one.said == "too few to tell" and one.n == n for one in told)
    assert over_learners_above_zero(np.ones(min(n, 1))).holds is None
    if n:
        gap, error = difference((n, n), (n, n))
        assert within(gap - 1.645 * error, gap + 1.645 * error, n, 0.19).holds is None


@pytest.mark.parametrize(("p", "q", "holds"), [(0.8, 0.5, True), (0.5, 0.8, False), (0.6, 0.6, None)])
def test_many_trials_tell_what_is_true(p: float, q: float, holds: bool | None) -> None:
    rng = np.random.default_rng(5)
    for _ in range(5):
        told = verdicts(1000, p, q, rng)
        assert all(one.holds in ((holds,) if holds is not None else (None, True, False)) for one in told)
    gap, error = difference((500, 1000), (510, 1000))
    assert within(gap - 1.645 * error, gap + 1.645 * error, 1000, 0.19).holds is True
    assert within(0.3, 0.5, 1000, 0.19).holds is False and within(-0.5, -0.3, 1000, 0.19).holds is False


def test_of_what_happens_as_often_something_else_is_claimed_once_in_twenty_at_most() -> None:
    rng = np.random.default_rng(6)
    for n in (10, 40):
        told = [verdicts(n, 0.6, 0.6, rng) for _ in range(600)]
        wrong = np.mean([[one.holds is not None for one in each] for each in told], axis=0)
        assert (wrong[:2] < 0.05).all() and wrong[2] < 0.07


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 60), st.floats(0, 1), st.floats(0, 1))
def test_a_claim_never_contradicts_its_interval(seed: int, n: int, p: float, q: float) -> None:
    for one in verdicts(n, p, q, np.random.default_rng(seed)):
        assert one.low <= one.high
        assert one.holds is (True if one.low > 0 else False if one.high < 0 else None)
        if one.holds is None:
            assert one.told().startswith("too few to tell (") and f"n = {n})" in one.told()
        assert one.numbers["holds"] is one.holds and one.numbers["said"] == one.told()


def test_the_interval_of_a_difference_holds_the_truth_at_least_nineteen_times_in_twenty() -> None:
    rng, p, q = np.random.default_rng(7), 0.7, 0.45
    told = [oftener((int(a), 30), (int(b), 30)) for a, b in rng.binomial(30, [p, q], (800, 2))]
    assert np.mean([one.low <= p - q <= one.high for one in told]) > 0.95
    assert above_zero(0.0, 0.1, 9).holds is None  # an end at 0 includes it
