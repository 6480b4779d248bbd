"""Eq. (1) and Eq. (2) against brute-force enumeration of the joint table, and the invariances they imply."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.moves import overridden
from imitation.errors import ImitationError
from imitation.inference.bayes import action_posterior, entropy, goal_posterior, joint_likelihood, unobserved_action

EXACT = 1e-12
sizes = st.integers(1, 7)


def world(seed: int, states: int, actions: int, goals: int, zeros: float = 0.0):  # type: ignore[no-untyped-def]
    """F[s, a, s'], P(a | s, g)[g, s, a], P(s | g)[g, s], P(g), with some impossible entries."""
    rng = np.random.default_rng(seed)

    def rows(*shape: int) -> np.ndarray:  # type: ignore[type-arg]
        table = rng.dirichlet(np.ones(shape[-1]) * 0.7, shape[:-1])
        table = np.where(rng.random(table.shape) < zeros, 0.0, table)
        total = table.sum(-1, keepdims=True)
        return np.where(total > 0, table / np.where(total > 0, total, 1), 1 / shape[-1])

    return rows(states, actions, states), rows(goals, states, actions), rows(goals, states), rows(1, goals)[0]


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), sizes, sizes, sizes, st.sampled_from([0.0, 0.4]))
def test_eq_1_is_the_enumerated_conditional(seed, states, actions, goals, zeros):
    forward, prior, _, _ = world(seed, states, actions, goals, zeros)
    for g in range(goals):
        for s in range(states):
            for after in range(states):
                joint = [prior[g, s, a] * forward[s, a, after] for a in range(actions)]
                found = action_posterior(forward[s, :, after], prior[g, s])
                assert found.evidence == pytest.approx(sum(joint), abs=EXACT)
                assert bool(found.informed) == (sum(joint) > 0)
                if sum(joint) > 0:
                    np.testing.assert_allclose(found.probability, np.array(joint) / sum(joint), atol=EXACT)
                else:
                    assert not found.probability.any()


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), sizes, sizes, sizes, st.sampled_from([0.0, 0.4]))
def test_eq_2_is_the_enumerated_conditional(seed, states, actions, goals, zeros):
    forward, prior, at, goal_prior = world(seed, states, actions, goals, zeros)
    rng = np.random.default_rng(seed)
    s, a, after = rng.integers(states), rng.integers(actions), rng.integers(states)
    joint = np.array([goal_prior[g] * at[g, s] * prior[g, s, a] * forward[s, a, after] for g in range(goals)])
    found = goal_posterior([forward[s, a, after]], prior[:, s, a], goal_prior, at[:, s])
    assert found.evidence == pytest.approx(joint.sum(), abs=EXACT)
    np.testing.assert_allclose(found.probability, joint / joint.sum() if joint.sum() else joint, atol=EXACT)
    hidden = np.zeros(goals)
    for g in range(goals):
        for b in range(actions):
            hidden[g] += goal_prior[g] * at[g, s] * prior[g, s, b] * forward[s, b, after]
    found = goal_posterior([1.0], unobserved_action(forward[s, :, after], prior[:, s]), goal_prior, at[:, s])
    assert found.evidence == pytest.approx(hidden.sum(), abs=EXACT)
    np.testing.assert_allclose(found.probability, hidden / hidden.sum() if hidden.sum() else hidden, atol=EXACT)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 9))
def test_relabelling_actions_relabels_the_posterior(seed, actions):
    forward, prior, _, _ = world(seed, 4, actions, 1)
    order = np.random.default_rng(seed).permutation(actions)
    plain, shuffled = (action_posterior(forward[0, o, 1], prior[0, 0, o]) for o in (np.arange(actions), order))
    np.testing.assert_allclose(shuffled.probability, plain.probability[order], atol=EXACT)
    assert shuffled.evidence == pytest.approx(plain.evidence, abs=EXACT)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), sizes, sizes)
def test_the_forward_model_cancels_when_the_action_is_observed(seed, actions, goals):
    forward, prior, at, goal_prior = world(seed, 5, actions, goals)
    other = (
        np.random.default_rng(seed + 1).random(forward.shape) + 1e-3
    )  # any positive matrix: it need not even sum to 1
    for a in range(actions):
        one = goal_posterior([forward[2, a, 3]], prior[:, 2, a], goal_prior, at[:, 2])
        two = goal_posterior([other[2, a, 3]], prior[:, 2, a], goal_prior, at[:, 2])
        np.testing.assert_allclose(one.probability, two.probability, atol=EXACT)


def test_the_forward_model_matters_when_the_action_is_hidden():
    prior = np.array([[0.9, 0.1], [0.1, 0.9]])
    sharp = goal_posterior([1.0], unobserved_action([0.9, 0.1], prior), [0.5, 0.5])
    blunt = goal_posterior([1.0], unobserved_action([0.5, 0.5], prior), [0.5, 0.5])
    assert sharp.probability[0] > 0.8
    np.testing.assert_allclose(blunt.probability, 0.5, atol=EXACT)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 15))
def test_hidden_actions_beside_walls_are_judged_by_the_overridden_model(seed, walls):
    """Enumerate (action, what it would do without walls): the same posterior over goals."""
    rng = np.random.default_rng(seed)
    table, prior, goal_prior = rng.dirichlet(np.ones(5), 5), rng.dirichlet(np.ones(5), 3), rng.dirichlet(np.ones(3))
    touch = np.array([bool(walls >> k & 1) for k in range(4)])
    aware = overridden(table, touch)
    np.testing.assert_allclose(aware.sum(-1), 1, atol=EXACT)
    for seen in range(5):
        joint = np.zeros(3)
        for g in range(3):
            for a in range(5):
                for wanted in range(5):
                    happens = 4 if wanted < 4 and touch[wanted] else wanted
                    joint[g] += (happens == seen) * goal_prior[g] * prior[g, a] * table[a, wanted]
        found = goal_posterior([1.0], unobserved_action(aware[:, seen], prior), goal_prior)
        assert bool(found.informed) == (joint.sum() > 0)
        if joint.sum() > 0:
            np.testing.assert_allclose(found.probability, joint / joint.sum(), atol=EXACT)


def test_without_a_prior_all_actions_are_alike_and_the_evidence_is_their_mean():
    likelihood = np.random.default_rng(0).random((4, 7))
    found, uniform = action_posterior(likelihood), action_posterior(likelihood, np.full(7, 1 / 7))
    np.testing.assert_allclose(found.evidence, likelihood.mean(-1), atol=EXACT)
    assert (found.evidence == uniform.evidence).all() and (found.probability == uniform.probability).all()


def test_entropy_counts_the_bits_that_are_missing():
    told = entropy(np.array([[0.5, 0.25, 0.25, 0.0], [1, 0, 0, 0], [0.25, 0.25, 0.25, 0.25], [0, 0, 0, 0]]))
    np.testing.assert_allclose(told, [1.5, 0, 2, 0], atol=EXACT)
    assert action_posterior([0.2, 0.2, 0.2, 0.2]).entropy == pytest.approx(2)


def test_zero_over_zero_is_said_and_never_a_number():
    found = action_posterior([[0.0, 0.5], [0.2, 0.3]], [[1.0, 0.0], [1.0, 0.0]])
    assert found.informed.tolist() == [False, True]
    assert found.probability.tolist() == [[0, 0], [1, 0]]
    assert np.isfinite(found.entropy).all()


@pytest.mark.parametrize("bad", [-0.1, np.nan, np.inf])
def test_what_is_no_probability_is_refused(bad):
    with pytest.raises(ImitationError, match="is not a probability"):
        action_posterior([0.5, bad])
    with pytest.raises(ImitationError, match=r"likelihood: -0.25 is not a probability"):  # the first of them
        action_posterior([0.0, -0.25, bad])


def test_a_weight_of_two_is_the_likelihood_given_twice_and_of_zero_leaves_it_out():
    one, other = np.random.default_rng(0).random((2, 4, 7))
    np.testing.assert_allclose(joint_likelihood([one, other], [2, 1]), one * one * other, rtol=EXACT)
    np.testing.assert_array_equal(joint_likelihood([one, other], [1, 0]), one)
    each = np.array([0.0, 1.0, 2.0, 0.5])
    np.testing.assert_allclose(joint_likelihood([one], [each]), one ** each[:, None], rtol=EXACT)


@pytest.mark.parametrize("bad", [-0.5, -1e-9, np.nan, np.inf, [1.0, -0.5]])
def test_what_is_no_weight_is_refused_by_the_number_of_its_term(bad):
    likely = np.ones((2, 3))
    with pytest.raises(ImitationError, match=r"term 1: weight .*must be finite and at least 0"):
        joint_likelihood([likely, likely], [1, bad])
    with pytest.raises(ValueError, match="shorter"):
        joint_likelihood([likely, likely], [1])
