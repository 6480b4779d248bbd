"""The forward model on measured axes: against slow counting, at the limits of its prior, off its axes, in between."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import norm

from babbling.axes import Axis, FloatArray, located
from babbling.counting import hat_mass
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel

seeds = st.integers(0, 2**32 - 1)


def model(strength: float = 0.0, sizes: tuple[int, int, int] = (4, 5, 6), factors: int = 2) -> ForwardModel:
    low = np.linspace(-1.0, -0.5, factors)
    axes = [Axis(name, "rad", low, -low, size) for name, size in zip(("v", "a", "w"), sizes, strict=True)]
    return ForwardModel(axes[:1], axes[1], axes[2], factors=list(map(str, range(factors))), prior_strength=strength)


def experience(seed: int, count: int, reach: float = 1.0) -> list[FloatArray]:
    return list(np.random.default_rng(seed).uniform(-reach, reach, (3, count, 2)) * [1.0, 0.5])


def hat(axis: Axis, factor: int, x: float) -> FloatArray:
    """The definition: max(0, 1 - |x - grid point| / step)."""
    weight: FloatArray = np.maximum(0, 1 - np.abs(x - axis.points[factor]) / axis.step[factor])
    return weight


def test_counts_are_products_of_hats_one_transition_at_a_time() -> None:
    m, (v, a, w) = model(), experience(0, 60)
    m.observe([v], a, w)
    slow = np.zeros(m.counts.shape)
    for t, f in product(range(60), range(2)):
        slow[f] += np.einsum(
            "i,j,k->ijk", hat(m.contexts[0], f, v[t, f]), hat(m.action, f, a[t, f]), hat(m.outcome, f, w[t, f])
        )
    np.testing.assert_allclose(m.counts / m.unit, slow, atol=60 * 3 * 2.0**-12)
    assert m.counts.sum() == 2 * 60 * m.unit  # totals are exact


@settings(max_examples=20, deadline=None)
@given(seeds, st.integers(1, 50))
def test_sums_do_not_depend_on_the_order_or_the_portions(seed: int, portions: int) -> None:
    v, a, w = experience(seed, 120, reach=1.1)
    whole, parts = model(), model()
    whole.observe([v], a, w)
    order = np.random.default_rng(seed).permutation(120)
    for part in np.array_split(order, portions):
        parts.observe([v[part]], a[part], w[part])
    assert (whole.counts == parts.counts).all()
    assert (whole.moments.sums == parts.moments.sums).all()
    assert (whole.outside == parts.outside).all()


def test_one_portion_or_many_internal_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    v, a, w = experience(5, 300)
    whole, parts = model(), model()
    whole.observe([v], a, w)
    monkeypatch.setattr("babbling.forward_model._CHUNK", 7)
    monkeypatch.setattr("babbling.regression._CHUNK", 5)
    parts.observe([v], a, w)
    assert (whole.counts == parts.counts).all()
    assert (whole.moments.sums == parts.moments.sums).all()


def test_what_falls_off_an_axis_is_left_out_and_counted() -> None:
    m, (v, a, w) = model(), experience(1, 100, reach=0.9)
    v[:7, 0], a[5:10, 0], w[90:, 1] = 1.2, -3.0, 0.6
    v[50, 0] = np.nan  # nothing happened: not "outside"
    m.observe([v], a, w)
    assert m.outside.tolist() == [10, 10]
    assert m.counts.sum((1, 2, 3)).tolist() == [89 * m.unit, 90 * m.unit]
    assert m.transitions == 179


def test_without_a_prior_an_untried_row_has_no_evidence() -> None:
    m = model()
    m.observe([np.array([[-1.0, -0.5]])], np.array([[-1.0, -0.5]]), np.array([[0.1, 0.1]]))
    tried = m.visits > 0
    assert tried.sum() == 2
    assert (m.predictive[~tried] == 0).all()
    np.testing.assert_allclose(m.predictive[tried].sum(-1), 1)
    assert (m.likelihood((np.array([0.0, 0.0]),), np.array([0.0, 0.0])) == 0).all()


def line(count: int, seed: int = 0, noise: float = 0.03) -> tuple[ForwardModel, FloatArray, FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    v, a = rng.uniform(-0.5, 0.5, (2, count, 2))
    w = 0.1 * v + 0.6 * a + noise * rng.standard_normal(a.shape)
    m = model(1.0, (4, 9, 25))
    m.observe([v], a, np.clip(w, -0.5, 0.5))
    return m, v, a, w


def test_a_huge_prior_strength_is_the_line_and_none_is_the_frequencies() -> None:
    m, v, a, w = line(3000)
    strong, weak = model(1e12, (4, 9, 25)), model(0.0, (4, 9, 25))
    for other in (strong, weak):
        other.observe([v], a, np.clip(w, -0.5, 0.5))
    np.testing.assert_allclose(strong.predictive, m.prior(), atol=1e-8)
    visited = m.visits[..., None]
    frequencies = np.where(visited > 0, m.counts / m.unit / np.maximum(visited, 1e-300), 0)
    np.testing.assert_allclose(weak.predictive, frequencies, atol=1e-12)
    np.testing.assert_allclose(m.predictive, (visited * frequencies + m.prior()) / (visited + 1), atol=1e-12)


def test_the_prior_is_the_line_as_the_grid_sees_it() -> None:
    """E[outcome] of the prior is b_0 + b_1 v + b_2 a wherever that lies well on the axis."""
    m, *_ = line(5000)
    mean = (m.prior()[0] * m.outcome.points[0]).sum(-1)
    wanted = 0.1 * m.contexts[0].points[0][:, None] + 0.6 * m.action.points[0]
    np.testing.assert_allclose(mean, wanted, atol=0.01)
    np.testing.assert_allclose(m.prior().sum(-1), 1, atol=1e-12)


def test_a_line_that_leaves_the_axis_is_held_at_its_end() -> None:
    m, rng = model(1.0, (4, 9, 25)), np.random.default_rng(0)
    v, a = rng.uniform(-0.2, 0.2, (2, 3000, 2))
    m.observe([v], a, 2.2 * a + 0.05 * rng.standard_normal(a.shape))  # a goes on to 1: twice the outcome's range
    spread = np.sqrt(m.linear().covariance[:, 0, 0]) / m.outcome.step
    for f, (end, grid_point) in product(range(2), ((0, 0.0), (-1, 24.0))):
        held = hat_mass(np.array(grid_point), spread[f], 25)
        np.testing.assert_allclose(m.prior()[f, :, end], np.tile(held, (4, 1)), atol=1e-12)
        assert 0.3 < held[end] < 0.9  # the end has not swallowed what would lie before it


def test_infinite_experience_is_the_truth() -> None:
    """P(w | v, a) of a bent, unevenly noisy law comes within its sampling error, whatever the line says."""
    rng, count = np.random.default_rng(2), 400_000
    m = model(20.0, (2, 5, 21), factors=1)
    a = rng.choice(m.action.points[0], (count, 1))
    v = rng.choice(m.contexts[0].points[0], (count, 1))
    centre, spread = 0.5 * a**2 - 0.3, 0.05 + 0.1 * np.abs(a)
    w = centre + spread * rng.standard_normal(a.shape)
    m.observe([v], a, w)
    step = m.outcome.step[0]
    for i, action in enumerate(m.action.points[0]):
        x = (0.5 * action**2 - 0.3 + 1) / step
        truth = hat_mass(np.array(x), np.array((0.05 + 0.1 * abs(action)) / step), 21)
        assert np.abs(m.predictive[0, 0, i] - truth).sum() / 2 < 0.02


def test_more_experience_of_a_bent_law_is_nearer_the_truth() -> None:
    errors = []
    for count in (300, 3000, 30_000):
        rng = np.random.default_rng(7)
        v, a = rng.uniform(-0.5, 0.5, (2, count, 2))
        m = model(1.0, (2, 33, 25))
        m.observe([v], a, 2 * a**2 - 0.3 + 0.03 * rng.standard_normal(a.shape))
        errors.append(np.sqrt(np.mean((m.expected((v,), a) - (2 * a**2 - 0.3)) ** 2)))
    assert errors[0] > 1.2 * errors[1] > 1.2 * errors[2]
    assert errors[2] < 0.2 * np.sqrt(np.mean((m.linear().predict(v, a)[..., 0] - (2 * a**2 - 0.3)) ** 2))


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_interpolation_is_exact_for_multilinear_tables(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = model()
    c = rng.standard_normal((2, 2, 2, 3))  # factor, power of v, power of a, rest
    v, a = (axis.points for axis in (m.contexts[0], m.action))
    powers_v, powers_a = np.stack([np.ones_like(v), v], -1), np.stack([np.ones_like(a), a], -1)
    table = np.einsum("fvi,faj,fijr->fvar", powers_v, powers_a, c)
    at_v, at_a = rng.uniform(-1, 1, (2, 50, 2)) * [1.0, 0.5]
    found = located(2, (m.contexts[0], m.action), (at_v, at_a)).read(table)
    wanted = np.einsum("nfi,nfj,fijr->nfr", *(np.stack([np.ones_like(x), x], -1) for x in (at_v, at_a)), c)
    np.testing.assert_allclose(found, wanted, atol=np.abs(c).max() * 4 * 2.0**-11)


@settings(max_examples=50, deadline=None)
@given(st.floats(0, 14), st.floats(0.01, 5))
def test_hat_mass_sums_to_one_and_keeps_the_mean(mean: float, spread: float) -> None:
    mass = hat_mass(np.array(mean), np.array(spread), 15)
    assert mass.sum() == pytest.approx(1, abs=1e-9)
    assert (mass >= 0).all()
    # mean of the Gaussian cut at both ends: E[clip(x, 0, 14)]
    x = np.linspace(mean - 9 * spread, mean + 9 * spread, 20_001)
    weight = norm.pdf(x, mean, spread)
    assert mass @ np.arange(15) == pytest.approx((np.clip(x, 0, 14) * weight).sum() / weight.sum(), abs=1e-4)


def test_hat_mass_is_the_integral() -> None:
    whole = np.linspace(-10, 24, 400_001)
    weight, x = norm.pdf(whole, 3.3, 0.8), np.clip(whole, 0, 14)  # what lies beyond goes to the ends
    slow = [(np.maximum(0, 1 - np.abs(x - k)) * weight).sum() / weight.sum() for k in range(15)]
    np.testing.assert_allclose(hat_mass(np.array(3.3), np.array(0.8), 15), slow, atol=1e-6)
    # no spread: the soft assignment itself
    np.testing.assert_allclose(hat_mass(np.array(3.3), np.array(0.0), 15)[[3, 4]], [0.7, 0.3], atol=1e-5)


def test_likelihood_and_expectation_read_the_table() -> None:
    m, *_ = line(2000)
    v, w = m.contexts[0].points[:, 1], m.outcome.points[:, 12]
    f = np.arange(2)
    np.testing.assert_allclose(m.likelihood((v,), w), m.predictive[f, 1, :, 12], atol=1e-12)
    a = m.action.points[:, 3]
    mean = (m.predictive[f, 1, 3] * m.outcome.points).sum(-1)
    np.testing.assert_allclose(m.expected((v,), a), mean, atol=1e-12)


def test_habits_are_the_visits_and_as_many_of_the_line_as_the_prior_is_strong() -> None:
    m, v, *_ = line(2000)
    fit = m.moments.fit(["a"], ["v"])
    at = (fit.predict(m.contexts[0].points.T)[..., 0] - m.action.low) / m.action.step
    spread = np.sqrt(fit.covariance[:, 0, 0]) / m.action.step
    for f, i in product(range(2), range(4)):
        slow = m.visits[f, i] + hat_mass(np.clip(at[i, f], 0, 8), spread[f], 9)
        np.testing.assert_allclose(m.habits[f, i], slow / slow.sum(), atol=1e-12)
    before = m.habits
    m.observe([v], np.full(v.shape, 0.1), np.zeros(v.shape))
    assert m.habits[0, 1, 5] > 1.2 * before[0, 1, 5], "what was learned later counts as well"


def test_familiarity_is_that_of_the_nearest_action() -> None:
    m, *_ = line(2000)
    rows = m.at((m.contexts[0].points[:, 1],))
    np.testing.assert_allclose(rows.familiarity(), m.visits[:, 1], rtol=1e-12)
    for share, nearest in ((0.3, 3), (0.7, 4)):
        found = rows.familiarity(m.action.points[:, 3] + share * m.action.step)
        np.testing.assert_allclose(found, m.visits[:, 1, nearest], rtol=1e-12)


def test_who_is_nowhere_is_told_nothing() -> None:
    m, nobody = line(2000)[0], np.zeros((0, 2))
    assert m.at((nobody,)).expected(nobody).shape == (0, 2)


def test_what_cannot_be_merged_or_made() -> None:
    with pytest.raises(BabblingError, match="only tables of one pilot"):
        model().merge(model(sizes=(4, 5, 7)))
    for end in ("low", "high"):
        m = model()
        moved = replace(m.action, **{end: 1.1 * getattr(m.action, end)})
        with pytest.raises(BabblingError, match="only tables of one pilot"):
            m.merge(ForwardModel(m.contexts, moved, m.outcome, factors=m.factors))
    with pytest.raises(BabblingError, match="prior strength -1"):
        model(-1.0)
    with pytest.raises(BabblingError, match="expected 3 arrays"):
        model().observe([], np.zeros((3, 2)), np.zeros((3, 2)))
    with pytest.raises(BabblingError, match="has 2 factors, the model has 1"):
        axis = Axis("a", "rad", np.zeros(2), np.ones(2), 3)
        ForwardModel([], axis, axis)
