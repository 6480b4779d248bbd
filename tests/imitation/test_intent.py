"""Intent over time: the filter is the posterior given everything seen, by enumeration; nothing is counted twice."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imitation.errors import ImitationError
from imitation.inference.intent import in_blocks, intent_by_step, intent_filter, step_evidence

seeds = st.integers(0, 2**32 - 1)


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(1, 12), st.integers(1, 5))
def test_the_filter_is_the_posterior_of_the_whole_past(seed, steps, goals):
    rng = np.random.default_rng(seed)
    seen, prior, start = rng.random((steps, goals)) + 1e-3, rng.dirichlet(np.ones(goals)), rng.random(goals) + 1e-3
    for first in (np.ones(goals), start):  # P(s_1 | g), once
        found = intent_filter(seen, prior * first / (prior @ first))
        for t in range(steps):
            joint = prior * np.prod(seen[: t + 1], axis=0) * first
            np.testing.assert_allclose(found.probability[t], joint / joint.sum(), atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(1, 12), st.integers(1, 5))
def test_step_by_step_each_step_stands_alone(seed, steps, goals):
    rng = np.random.default_rng(seed)
    seen, here = rng.random((2, steps, goals)) + 1e-3
    prior = rng.dirichlet(np.ones(goals))
    joint = seen * here * prior
    found = intent_by_step(seen, prior, here)
    np.testing.assert_allclose(found.probability, joint / joint.sum(1, keepdims=True), atol=1e-12)
    order = rng.permutation(steps)
    np.testing.assert_allclose(intent_by_step(seen[order], prior, here[order]).probability, found.probability[order])


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(1, 5), st.integers(1, 4), st.integers(1, 4))
def test_unseen_actions_are_summed_over_as_enumerating_every_sequence_does(seed, steps, goals, actions):
    """P(g | s_1 .. s_T+1) over all A^T action sequences that could have been behind the states."""
    rng = np.random.default_rng(seed)
    forward, prior = rng.dirichlet(np.ones(4), (4, actions)), rng.dirichlet(np.ones(actions), (goals, 4))
    states, goal_prior = rng.integers(4, size=steps + 1), rng.dirichlet(np.ones(goals))
    here, after = states[:-1], states[1:]
    joint = np.zeros(goals)
    for sequence in product(range(actions), repeat=steps):
        did = np.array(sequence)
        joint += goal_prior * np.prod(prior[:, here, did] * forward[here, did, after], axis=1)
    likelihood = forward[here, :, after]
    evidence = step_evidence(prior, here, None, likelihood)
    found = intent_filter(evidence, goal_prior).probability[-1]
    np.testing.assert_allclose(found, joint / joint.sum(), atol=1e-12)
    certain = rng.integers(actions, size=steps)  # a forward model that leaves no doubt which action it was
    told = np.eye(actions)[certain] * rng.uniform(0.1, 1, (steps, 1))
    seen, guessed = (
        intent_by_step(step_evidence(prior, here, certain, None), goal_prior),
        intent_by_step(step_evidence(prior, here, None, told), goal_prior),
    )
    np.testing.assert_allclose(guessed.probability, seen.probability, atol=1e-12)
    with pytest.raises(ImitationError, match="no actions were seen"):
        step_evidence(prior, here, None)


def test_a_step_no_goal_explains_says_nothing_and_is_counted():
    seen = np.array([[0.9, 0.1], [0.0, 0.0], [0.9, 0.1]])
    prior = np.array([0.5, 0.5])
    found = intent_filter(seen, prior)
    assert found.uninformed_steps == 1 and found.informed.tolist() == [True, False, True]
    assert found.probability[1].tolist() == found.probability[0].tolist()
    assert found.probability[2, 0] > found.probability[1, 0]
    alone = intent_by_step(seen, prior)
    assert alone.uninformed_steps == 1 and alone.probability[1].tolist() == [0.5, 0.5]
    assert np.isfinite(alone.entropy).all() and alone.entropy[1] == pytest.approx(1.0)


def test_blocks_of_eight_end_with_five():
    means = in_blocks(np.arange(85.0), 8)
    assert len(means) == 11 and means[0] == 3.5 and means[-1] == pytest.approx(np.mean([80, 81, 82, 83, 84]))
    table = np.random.default_rng(0).random((20, 3))
    np.testing.assert_allclose(in_blocks(table, 8)[1], table[8:16].mean(0))
    with pytest.raises(ImitationError):
        in_blocks(table, 0)
