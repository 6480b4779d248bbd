"""The forward model's laws: counting, merging, the multinomial bound, and the quick way for categories."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.axes import UNIT, Axis
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel

seeds = st.integers(0, 2**32 - 1)


def categories(factors: int = 1, actions: int = 5, outcomes: int = 5, contexts: tuple[int, ...] = ()) -> ForwardModel:
    def axis(name: str, size: int) -> Axis:
        return Axis.categorical(name, tuple(map(str, range(size))), factors)

    names = [str(f) for f in range(factors)]
    return ForwardModel(
        [axis(f"context {i}", n) for i, n in enumerate(contexts)],
        axis("action", actions),
        axis("outcome", outcomes),
        factors=names,
    )


def measured(factors: int = 2, strength: float = 0.0) -> ForwardModel:
    low, high = np.full(factors, -1.0), np.full(factors, 1.0)
    axes = [Axis(name, "rad", low, high, size) for name, size in (("speed", 5), ("action", 7), ("outcome", 9))]
    return ForwardModel([axes[0]], axes[1], axes[2], factors=["a", "b"][:factors], prior_strength=strength)


@settings(max_examples=30, deadline=None)
@given(seeds, st.integers(1, 3), st.integers(1, 5), st.integers(1, 6), st.booleans())
def test_rows_are_relative_frequencies_counted_one_by_one(seed, factors, actions, outcomes, with_context):
    rng, n = np.random.default_rng(seed), 200
    contexts = (3,) if with_context else ()
    model = categories(factors, actions, outcomes, contexts)
    context = [rng.integers(0, 3, (n, factors)) for _ in contexts]
    action, outcome = rng.integers(0, actions, (n, factors)), rng.integers(0, outcomes, (n, factors))
    model.observe(context, action, outcome)
    slow = np.zeros(model.counts.shape, int)
    for t in range(n):
        for f in range(factors):
            slow[(f, *(c[t, f] for c in context), action[t, f], outcome[t, f])] += 1
    assert (model.counts == slow).all()
    assert model.transitions == n * factors
    visits = slow.sum(-1, keepdims=True)
    np.testing.assert_array_equal(model.predictive, np.where(visits > 0, slow / np.maximum(visits, 1), 0))


@settings(max_examples=30, deadline=None)
@given(seeds, st.integers(1, 3))
def test_the_quick_way_for_categories_equals_the_general_one(seed, factors):
    rng, n = np.random.default_rng(seed), 300
    action, outcome = (rng.integers(0, 5, (n, factors)).astype(float) for _ in range(2))
    outcome[rng.random((n, factors)) < 0.3] = np.nan
    quick, general = categories(factors), categories(factors)
    quick.observe([], action, outcome)
    general._observe([action, outcome])  # the way measured axes go
    assert (quick.counts == general.counts).all()
    assert (quick.moments.samples == general.moments.samples).all()
    whole = categories(factors)
    kept = ~np.isnan(outcome).any(1)
    whole.observe([], action[kept].astype(int), outcome[kept].astype(int))
    again = categories(factors)
    again.observe([], action[kept], outcome[kept])
    assert (whole.counts == again.counts).all()


@pytest.mark.parametrize("bad", [-1, 5, 2**40])
def test_a_category_that_does_not_exist_is_refused(bad):
    model = categories()
    with pytest.raises(BabblingError, match=r"axis 'outcome' has no category .*; it has 0 to 4"):
        model.observe([], np.array([[1]]), np.array([[bad]]))
    with pytest.raises(BabblingError, match=r"no category 0\.5"):
        model.observe([], np.array([[0.5]]), np.array([[1.0]]))
    assert model.transitions == 0


@settings(max_examples=20, deadline=None)
@given(seeds, st.booleans())
def test_merging_is_learning_on_the_union_in_any_order(seed, soft):
    rng = np.random.default_rng(seed)
    make = measured if soft else lambda: categories(2)
    data = [rng.uniform(-1, 1, (90, 2)) if soft else rng.integers(0, 5, (90, 2)) for _ in range(3 if soft else 2)]
    context = data[:-2]
    whole = make()
    whole.observe(context, data[-2], data[-1])
    shards = []
    for part in np.array_split(rng.permutation(90), 4):
        shard = make()
        shard.observe([c[part] for c in context], data[-2][part], data[-1][part])
        shards.append(shard)
    for order in (range(4), reversed(range(4)), rng.permutation(4)):
        merged = make()
        for i in order:
            merged.merge(shards[i])
        assert (merged.counts == whole.counts).all()
        assert (merged.moments.sums == whole.moments.sums).all()
        assert (merged.predictive == whole.predictive).all()


def test_counts_added_later_are_experience_like_any_other():
    rng = np.random.default_rng(0)
    action, outcome = rng.integers(0, 5, (2, 500, 1))
    lived, told = categories(), categories()
    lived.observe([], action, outcome)
    told.add(lived.counts)
    assert (told.predictive == lived.predictive).all() and told.transitions == 500
    with pytest.raises(BabblingError, match="counts of shape"):
        told.add(np.zeros((1, 2, 2), np.int64))
    with pytest.raises(BabblingError, match="merge forward models instead"):
        measured().add(np.zeros(measured().counts.shape, np.int64))


@settings(max_examples=20, deadline=None)
@given(seeds)
def test_soft_counts_keep_their_mean(seed):
    rng = np.random.default_rng(seed)
    model = measured(1)
    values = rng.uniform(-1, 1, (400, 1))
    model.observe([np.zeros((400, 1))], np.zeros((400, 1)), values)
    points = model.outcome.points[0]
    mean = (model.counts.sum((0, 1, 2)) * points).sum() / model.counts.sum()
    assert mean == pytest.approx(values.mean(), abs=2 * model.outcome.step[0] / UNIT)


def test_the_row_is_the_dirichlet_mean_by_numerical_integration():
    """P(o) = E[theta_o | counts] under a Dirichlet prior of strength k around the linear fit."""
    rng = np.random.default_rng(3)
    model = measured(1, strength=2.5)
    action = rng.uniform(-1, 1, (60, 1))
    model.observe([rng.uniform(-1, 1, (60, 1))], action, 0.7 * action)
    cell = (0, 2, 4)
    alpha = model.counts[cell] / model.unit + 2.5 * model.prior()[cell]
    draws = rng.gamma(alpha, size=(200_000, len(alpha)))
    theta = (draws / draws.sum(1, keepdims=True)).mean(0)
    np.testing.assert_allclose(model.predictive[cell], theta, atol=3e-3)
    np.testing.assert_allclose(model.predictive[cell].sum(), 1, atol=1e-12)


@pytest.mark.parametrize("draws", [100, 1000, 10_000])
def test_distance_from_the_truth_is_the_multinomial_one(draws):
    """E[TV] = 1/2 sum_j sqrt(2 p_j (1 - p_j) / (pi n)), over many factors that learn alone."""
    rng = np.random.default_rng(draws)
    truth = np.array([0.72, 0.08, 0.04, 0.06, 0.10])
    model = categories(300, 1, 5)
    model.observe([], np.zeros((draws, 300), int), rng.choice(5, (draws, 300), p=truth))
    distance = np.abs(model.predictive[:, 0] - truth).sum(-1).mean() / 2
    expected = 0.5 * np.sqrt(2 * truth * (1 - truth) / (np.pi * draws)).sum()
    assert distance == pytest.approx(expected, rel=0.06)


def test_what_nobody_tried_is_all_zero_and_says_so():
    model = categories()
    model.observe([], np.array([[1]]), np.array([[2]]))
    assert model.visits.tolist() == [[0, 1, 0, 0, 0]]
    assert model.likelihood((), np.array([[2]])).tolist() == [[[0, 1, 0, 0, 0]]]


def mixed(strength: float, outcome: Axis | None = None) -> ForwardModel:
    one, kinds = np.ones(1), Axis.categorical("kind", ("a", "b"))
    outcome = outcome or Axis.categorical("outcome", ("x", "y", "z"))
    return ForwardModel([kinds], Axis("action", "m", -one, one, 5), outcome, prior_strength=strength)


@settings(max_examples=20, deadline=None)
@given(seeds, st.integers(0, 40))
def test_categories_that_follow_from_measured_actions_lean_on_what_usually_follows(seed, count):
    """P(o | c, a) = (n + k q) / (N + k), in experiences, whatever unit counts are kept in; merged as ever."""
    rng, k = np.random.default_rng(seed), 2.5
    kind, action, outcome = (
        rng.integers(0, 2, (count, 1)),
        rng.uniform(-1, 1, (count, 1)),
        rng.integers(0, 3, (count, 1)),
    )
    model, first, second = mixed(k), mixed(k), mixed(k)
    model.observe([kind], action, outcome)
    half = count // 2
    first.observe([kind[:half]], action[:half], outcome[:half])
    second.observe([kind[half:]], action[half:], outcome[half:])
    first.merge(second)
    np.testing.assert_array_equal(first.predictive, model.predictive)
    counts = model.counts[0] / model.unit
    for c in range(2):
        met = outcome[kind == c]
        usual = (np.bincount(met, minlength=3) + 1 / 3) / (len(met) + 1)
        np.testing.assert_allclose(
            model.predictive[0, c], (counts[c] + k * usual) / (counts[c].sum(-1, keepdims=True) + k), atol=1e-12
        )


def test_measured_outcomes_of_categories_have_no_line_to_lean_on():
    one = np.ones(1)
    with pytest.raises(BabblingError, match="prior strength 1: it must be >= 0, and 0 for measured outcomes"):
        mixed(1.0, Axis("outcome", "m", -one, one, 5))
    with pytest.raises(BabblingError, match="prior strength -1"):
        mixed(-1.0)
    assert mixed(0.0, Axis("outcome", "m", -one, one, 5)).prior_strength == 0
