"""Eq. (1) as an inverse model: against its definition, one term and several, its limits, and the ladder below it."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from babbling.axes import UNIT, Axis
from babbling.forward_model import ForwardModel
from imitation.errors import ImitationError
from imitation.inference.bayes import action_posterior
from imitation.inference.inverse import CATEGORIES, MEASURED, BayesianInverse, LinearInverse, Rung, Term, descend

LOW = np.array([-1.0, -2.0])


def measured(*sizes, strength=1.0, noise=0.1, seed=0):
    """Two factors; the last two sizes are those of action and outcome, w = 0.5 a + 0.1 v + ... + noise."""
    rng = np.random.default_rng(seed)
    names = [*(f"v{i}" for i in range(len(sizes) - 2)), "a", "w"]
    axes = [Axis(name, "rad", LOW, -LOW, size) for name, size in zip(names, sizes, strict=True)]
    model = ForwardModel(axes[:-2], axes[-2], axes[-1], factors=("0", "1"), prior_strength=strength)
    *v, a = rng.uniform(-1, 1, (len(sizes) - 1, 500, 2)) * -LOW
    w = 0.5 * a + sum(0.1 * (i + 1) * x for i, x in enumerate(v)) + noise * rng.standard_normal(a.shape)
    model.observe(v, a, np.clip(w, LOW, -LOW))
    return model


def categories(*sizes, seed=0):
    """Two factors of categories with random counts; a third of the counts is zero."""
    rng = np.random.default_rng(seed)
    names = [*(f"c{i}" for i in range(len(sizes) - 2)), "a", "o"]
    axes = [Axis.categorical(name, tuple(map(str, range(size))), 2) for name, size in zip(names, sizes, strict=True)]
    model = ForwardModel(axes[:-2], axes[-2], axes[-1], factors=("0", "1"))
    model.add(rng.integers(1, 9, (2, *sizes)) * (rng.random((2, *sizes)) > 1 / 3))
    return model


def test_one_term_in_one_context_is_to_the_bit_what_eq_1_says_written_out():
    rng = np.random.default_rng(1)
    model, copies, exponent = measured(4, 9, 11), 5, np.array([1.0, 0.1])
    v, w = rng.uniform(-1, 1, (2, copies, 2)) * -LOW
    choice = BayesianInverse(model, trust=exponent).choose([Term(model, (v,), w)], rng)

    def soft(axis, x):
        position = (x - axis.low) / ((axis.high - axis.low) / (axis.size - 1))
        whole = np.rint(np.clip(position, 0, axis.size - 1) * UNIT).astype(int)
        lower = np.minimum(whole // UNIT, axis.size - 2)
        return lower, (whole - lower * UNIT) / UNIT

    (i, s), (k, t) = soft(model.contexts[0], v), soft(model.outcome, w)
    table, f = model.predictive, np.arange(2)
    s, t = s[..., None], t[..., None]
    likelihood = table[f, i, :, k] * (1 - s) * (1 - t)
    likelihood = likelihood + table[f, i, :, k + 1] * (1 - s) * t
    likelihood = likelihood + table[f, i + 1, :, k] * s * (1 - t)
    likelihood = likelihood + table[f, i + 1, :, k + 1] * s * t
    habits = model.habits ** exponent[:, None, None]
    habits = habits / habits.sum(-1, keepdims=True)
    joint = likelihood * (habits[f, i] * (1 - s) + habits[f, i + 1] * s)
    evidence = joint.sum(-1)
    posterior = joint / evidence[..., None]
    assert choice.posterior.probability.tobytes() == posterior.tobytes()
    assert choice.posterior.evidence.tobytes() == evidence.tobytes()
    assert choice.action.tobytes() == (posterior * model.action.points).sum(-1).tobytes()
    assert not choice.rung.any()


def test_each_choice_is_eq_1_by_brute_force():
    rng = np.random.default_rng(0)
    model = measured(3, 9, 11)
    context, wanted = model.contexts[0].points[:, 1][None], model.outcome.points[:, 7][None]
    term = Term(model, (context,), wanted)
    choice = BayesianInverse(model, "mean", trust=1.0).choose([term], rng)
    table = model.counts / model.unit + model.prior()
    for f in range(2):
        likelihood = np.array([table[f, 1, i, 7] / table[f, 1, i].sum() for i in range(9)])
        habit = model.habits[f, 1]
        joint = [likelihood[i] * habit[i] for i in range(9)]
        np.testing.assert_allclose(choice.posterior.probability[0, f], np.array(joint) / sum(joint), atol=1e-12)
        mean = sum(p * x for p, x in zip(joint, model.action.points[f], strict=True)) / sum(joint)
        assert choice.action[0, f] == pytest.approx(mean, abs=1e-12)
    # no habit is the uniform prior; a prior given replaces it
    plain = BayesianInverse(model, "mean", trust=0.0).choose([term], rng).posterior
    uniform = action_posterior(model.likelihood((context,), wanted))
    np.testing.assert_allclose(plain.probability, uniform.probability, atol=1e-12)
    sure = np.zeros((2, 9))
    sure[:, 4] = 1
    assert BayesianInverse(model, prior=sure).choose([term], rng).action == pytest.approx(np.zeros((1, 2)))
    own = rng.dirichlet(
        np.ones(9), (2, 3)
    )  # one for every context: read between the grid points of the context as well
    between = model.contexts[0].points[:, :2].mean(1)[None]
    there = Term(model, (between,), wanted)
    mine = BayesianInverse(model, prior=own).choose([there], rng).posterior.probability
    joint = model.likelihood((between,), wanted) * own[:, :2].mean(1)
    np.testing.assert_allclose(mine, joint / joint.sum(-1, keepdims=True), atol=1e-12)


def test_two_terms_with_different_contexts_multiply_by_brute_force():
    """Every axis of another size: swapped ones do not fit."""
    rng = np.random.default_rng(0)
    one, two = categories(3, 4, 5, 6, seed=1), categories(2, 5, 7, seed=2)
    here = [rng.integers(0, size, (8, 2)).astype(float) for size in (3, 4, 2)]
    wanted = [rng.integers(0, size, (8, 2)).astype(float) for size in (6, 7)]
    weight = np.array([0.5, 2.0])
    inverse = BayesianInverse(one, "map")
    terms = [Term(one, (here[0], here[1]), wanted[0]), Term(two, (here[2],), wanted[1], weight)]
    choice = inverse.choose(terms, rng)
    for b, f in product(range(8), range(2)):
        i, j, k, o, p = (int(x[b, f]) for x in (*here, *wanted))
        habit = one.counts[f, i, j].sum(-1) / one.counts[f, i, j].sum()
        joint = np.zeros(5)
        for a in range(5):
            first, second = one.counts[f, i, j, a], two.counts[f, k, a]
            joint[a] = first[o] / first.sum() * (second[p] / second.sum()) ** weight[f] * habit[a]
        assert choice.posterior.evidence[b, f] == pytest.approx(joint.sum(), abs=1e-12)
        assert bool(choice.uninformed[b, f]) == (joint.sum() == 0)
        if joint.sum():
            np.testing.assert_allclose(choice.posterior.probability[b, f], joint / joint.sum(), atol=1e-12)
            assert choice.action[b, f] == joint.argmax()
    assert 0 < choice.uninformed.sum() < 16


def test_two_measured_contexts_are_read_in_their_order():
    model, rng = measured(3, 4, 9, 11), np.random.default_rng(0)
    f = np.arange(2)
    context = tuple(axis.points[:, i][None] for axis, i in zip(model.contexts, (2, 1), strict=True))
    choice = BayesianInverse(model).choose([Term(model, context, model.outcome.points[:, 6][None])], rng)
    joint = model.predictive[f, 2, 1, :, 6] * model.habits[f, 2, 1]
    np.testing.assert_allclose(choice.posterior.probability[0], joint / joint.sum(-1, keepdims=True), atol=1e-12)
    expected = BayesianInverse(model).expect(context, model.action.points[:, 3][None])
    mean = (model.predictive[f, 2, 1, 3] * model.outcome.points).sum(-1)
    np.testing.assert_allclose(expected[0], mean, atol=1e-12)
    line = LinearInverse(model).choose([Term(model, context, np.array([[0.1, 0.2]]))], rng).action
    # w = a / 2 + v0 / 10 + v1 / 5
    there = 2 * (np.array([[0.1, 0.2]]) - 0.1 * context[0] - 0.2 * context[1])
    np.testing.assert_allclose(line, there, atol=0.1)


def test_a_weight_of_nothing_is_no_term_and_of_two_the_term_twice():
    rng = np.random.default_rng(3)
    one, two = measured(3, 9, 11), measured(2, 5, 9, 13, seed=4)
    v = rng.uniform(-1, 1, (3, 6, 2)) * -LOW
    goals = 0.4 * rng.uniform(-1, 1, (2, 6, 2)) * -LOW
    inverse = BayesianInverse(one)

    def asked(*weights):
        terms = [Term(one, (v[0],), goals[0]), *(Term(two, (v[1], v[2]), goals[1], w) for w in weights)]
        return inverse.choose(terms, rng).posterior.probability

    assert asked(0.0).tobytes() == asked().tobytes()
    np.testing.assert_allclose(asked(2.0), asked(1.0, 1.0), atol=1e-12)
    assert np.abs(asked(2.0) - asked(1.0)).max() > 0.01 < np.abs(asked(1.0) - asked()).max()
    mixed = asked(np.array([0.0, 1.0]))
    assert mixed[:, 0].tobytes() == asked()[:, 0].tobytes() and mixed[:, 1].tobytes() == asked(1.0)[:, 1].tobytes()
    beyond = Term(two, (v[1], v[2]), 9 * -LOW + 0 * goals[1], 0.0)  # off its axis, but nobody asks it
    assert not inverse.choose([Term(one, (v[0],), goals[0]), beyond], rng).uninformed.any()
    assert inverse.choose([Term(one, (v[0],), goals[0]), replace(beyond, weight=1e-3)], rng).uninformed.all()


def test_a_certain_term_decides():
    rng = np.random.default_rng(0)
    one, sure = categories(3, 5, 4), categories(5, 2)
    one.add(np.ones_like(one.counts))  # nothing is impossible
    sure.counts[:] = [10, 0]
    sure.counts[:, 3] = [0, 10]  # only action 3 ever led to outcome 1
    nought = np.zeros((1, 2))
    terms = [Term(one, (nought,), nought), Term(sure, (), nought + 1)]
    choice = BayesianInverse(one, "map").choose(terms, rng)
    assert choice.posterior.probability.tolist() == [[[0, 0, 0, 1, 0]] * 2] and choice.action.tolist() == [[3, 3]]


def test_terms_that_do_not_fit_are_refused():
    rng, one = np.random.default_rng(0), measured(3, 9, 11)
    inverse, zero = BayesianInverse(one), np.zeros((1, 2))
    good = Term(one, (zero,), zero)
    other = measured(3, 8, 11)
    single = ForwardModel([], *(Axis(name, "rad", LOW[:1], -LOW[:1], 9) for name in "aw"))
    for terms, told in (
        ([], "the first term must be of the forward model that this inverse was made of"),
        ([Term(other, (zero,), zero)], "the first term must be of the forward model"),
        (
            [good, Term(other, (zero,), zero)],
            "term 1: actions are 'a', 8 from -1 to 1, 2 factors; those of term 0, 'a', 9",
        ),
        ([good, Term(single, (), zero)], "term 1: actions are 'a', 9 from -1 to 1, 1 factors; those of term 0, 'a', 9"),
        ([Term(one, (zero, zero), zero)], r"term 0: 2 contexts; its forward model has 1 \(v0\)"),
        ([good, Term(one, (), zero)], r"term 1: 0 contexts; its forward model has 1 \(v0\)"),
        (
            [good, Term(one, (np.zeros((3, 2)),), zero)],
            r"term 1: shape \(3, 2\) beside \(1, 2\) of the sub-goal of term 0",
        ),
        ([good, replace(good, weight=-1.0)], r"term 1: weight -1\.0; it must be finite and at least 0"),
        ([good, replace(good, weight=np.array([1, np.nan]))], "term 1: weight .*nan.*; it must be finite"),
    ):
        with pytest.raises(ImitationError, match=told) as refused:
            inverse.choose(terms, rng)
        assert "\n" not in str(refused.value)


def test_a_line_answers_one_term_and_refuses_several():
    rng, one = np.random.default_rng(0), measured(3, 9, 11)
    term = Term(one, (np.zeros((1, 2)),), np.zeros((1, 2)))
    with pytest.raises(ImitationError, match="2 terms: this inverse model answers one"):
        LinearInverse(one).choose([term, term], rng)
    np.testing.assert_allclose(LinearInverse(one).choose([term], rng).action, 0, atol=0.1)


def test_where_nothing_is_known_the_line_acts_and_is_counted():
    axis = [Axis(name, "rad", np.array([-1.0]), np.array([1.0]), 9) for name in "vaw"]
    model = ForwardModel(axis[:1], axis[1], axis[2], prior_strength=5.0)
    rng = np.random.default_rng(0)
    a = rng.uniform(-1, 1, (300, 1))
    model.observe([np.zeros((300, 1))], a, 0.5 * a)
    wanted, context = np.array([[0.2], [7.0], [0.2]]), np.array([[0.0], [0.0], [-1.1]])  # 7 and -1.1: off their axes
    choice = BayesianInverse(model).choose([Term(model, (context,), wanted)], rng)
    assert choice.uninformed.tolist() == [[False], [True], [True]]
    assert choice.rung.tolist() == [[0], [Rung.LINE], [Rung.LINE]]
    line = LinearInverse(model).choose([Term(model, (context[1:],), wanted[1:])], rng)
    assert choice.action[1, 0] == line.action[0, 0] == pytest.approx(14, rel=0.01)
    assert choice.action[2, 0] == line.action[1, 0]


def test_the_ladder_is_gone_down_one_rung_at_a_time():
    likelihood = np.array([[0.2, 0.0, 0.6], [0.2, 0.0, 0.6], [0.0, 0.0, 0.0], [0.2, 0.0, 0.6]])
    prior = np.array([[0.5, 0.5, 0.0], [0.0, 1.0, 0.0], [0.2, 0.4, 0.4], [0.5, 0.5, 0.0]])
    beyond = np.array([False, False, False, True])
    alone, chance = [0.25, 0.0, 0.75], [1 / 3] * 3
    for ladder, rungs, said in (
        (CATEGORIES, [0, 1, 3, 3], [[1, 0, 0], alone, chance, chance]),
        ((Rung.INVERSE, Rung.CHANCE), [0, 3, 3, 3], [[1, 0, 0], chance, chance, chance]),
        ((Rung.INVERSE, Rung.FORWARD_ALONE, Rung.LINE), [0, 1, 2, 2], [[1, 0, 0], alone, [0, 0, 0], [1, 0, 0]]),
        (MEASURED, [0, 2, 2, 2], [[1, 0, 0], [0, 0, 0], [0, 0, 0], [1, 0, 0]]),
    ):
        posterior, rung = descend(likelihood, prior, ladder, beyond)
        assert rung.tolist() == rungs
        np.testing.assert_allclose(posterior.probability, said, atol=1e-12)
        np.testing.assert_allclose(posterior.evidence, [0.1, 0, 0, 0.1], atol=1e-12)
        assert posterior.informed.tolist() == [True, False, False, True]
    np.testing.assert_allclose(
        descend(likelihood, prior, CATEGORIES).posterior.entropy, [0, 0.811278, 1.584963, 0], atol=1e-6
    )
    assert descend(likelihood[:1], None, CATEGORIES).rung.tolist() == [0]


def test_a_state_nobody_was_ever_in_has_no_habit_and_is_left_to_chance():
    model = categories(2, 3, 4)
    model.counts[:, 1] = 0
    term = Term(model, (np.array([[0.0, 1.0]]),), np.zeros((1, 2)))
    choice = BayesianInverse(model, "map").choose([term], np.random.default_rng(0))
    assert choice.rung.tolist() == [[Rung.INVERSE, Rung.CHANCE]]
    np.testing.assert_allclose(choice.posterior.probability.sum(-1), 1)


def test_no_line_goes_through_categories():
    with pytest.raises(ImitationError, match="axis 'c0' holds categories, no line goes through them"):
        LinearInverse(categories(2, 3, 4))
