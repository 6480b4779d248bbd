"""Eq. (2) without the action, mixed with "it just moves": brute force, limits, and what must follow from it."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imitation.inference.meaning import GIVES_UP, GOES_ON, REPEATS, Knowing, Presentation, meant, wanted

STATES, ACTS = 3, 4
MEMBERS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 1, 1]], bool)
SAME, MOVED, APART, EITHER = range(4)
seeds = st.integers(0, 2**31)


def world(seed: int) -> tuple[Knowing, np.ndarray, np.random.Generator]:
    rng = np.random.default_rng(seed)
    outcomes = rng.dirichlet(np.ones(STATES), ACTS)
    return Knowing(outcomes, rng.dirichlet(np.ones(ACTS)), MEMBERS), rng.dirichlet(np.ones(len(MEMBERS))), rng


def shown(rng: np.random.Generator, count: int = 3) -> list[Presentation]:
    return [
        Presentation(rng.dirichlet(np.ones(ACTS)), int(rng.integers(STATES)), bool(rng.integers(2)))
        for _ in range(count)
    ]


@given(seeds)
@settings(max_examples=40, deadline=None)
def test_it_is_brute_force_bayes_over_goals_and_hidden_acts(seed: int) -> None:
    knowing, prior, rng = world(seed)
    seen, somebody = shown(rng), float(rng.uniform(0.05, 0.95))
    chance = [
        [sum(knowing.outcomes[a, o] for o in range(STATES) if MEMBERS[g, o]) for a in range(ACTS)] for g in range(4)
    ]
    pursues = np.zeros(4)
    for g in range(4):
        means = np.array([chance[g][a] * knowing.habit[a] for a in range(ACTS)])
        means /= means.sum()
        for acts in product(range(ACTS), repeat=len(seen)):  # every sequence of hidden acts
            p = prior[g] * somebody
            for a, one in zip(acts, seen, strict=True):
                stops = 1 - GOES_ON if MEMBERS[g, one.state] else GIVES_UP
                p *= means[a] * one.movement[a] * knowing.outcomes[a, one.state] * (1 - stops if one.again else stops)
            pursues[g] += p
    moves = 0.0
    for a in range(ACTS):  # what a thing mostly does
        p = (1 - somebody) / ACTS
        for one in seen:
            each = [one.movement[b] * knowing.outcomes[b, one.state] / 2 for b in range(ACTS)]
            p *= REPEATS * each[a] + (1 - REPEATS) * sum(each) / ACTS
        moves += p
    found = meant(seen, knowing, prior, somebody)
    np.testing.assert_allclose(found.goal[-1], pursues / pursues.sum(), rtol=1e-9)
    assert found.somebody[-1] == pytest.approx(pursues.sum() / (pursues.sum() + moves))
    np.testing.assert_allclose(found.goal[0], prior)
    assert found.somebody[0] == pytest.approx(somebody)


def test_a_goal_that_nobody_ever_reached_is_inferred_from_trying_again() -> None:
    """Pulling mostly parts it, and moves it else; three times it only moved, and was taken up again."""
    outcomes = np.array([[0.1, 0.3, 0.6], [0.1, 0.9, 0.0], [0.9, 0.1, 0.0], [0.8, 0.2, 0.0]])
    knowing, prior = Knowing(outcomes, np.full(ACTS, 1 / ACTS), MEMBERS), np.array([0.4, 0.4, 0.2, 0.0])
    pulls = np.array([1.0, 0, 0, 0])
    tried = [Presentation(pulls, MOVED, again) for again in (True, True, False)]
    assert meant(tried, knowing, prior, 0.99).goal[-1].argmax() == APART
    content = [Presentation(pulls, MOVED, False)] * 3
    assert meant(content, knowing, prior, 0.99).goal[-1].argmax() == MOVED  # the same ends, but each was left
    assert meant(tried, knowing, prior, 0.0).somebody[-1] == 0  # a thing never comes to mean anything


def test_with_bound_hands_the_odd_means_say_less_of_the_goal() -> None:
    """Lit by hand (1) or by head (2), or either (3): who had no hands may have wanted any light."""
    free = Knowing(np.array([[0.1, 0.9, 0.0], [0.05, 0.0, 0.95], [1, 0, 0], [1, 0, 0]]), np.full(4, 0.25), MEMBERS)
    bound = Knowing(np.array([[1, 0.0, 0.0], [0.05, 0.0, 0.95], [1, 0, 0], [1, 0, 0]]), np.full(4, 0.25), MEMBERS)
    prior, head = np.array([0.1, 0.5, 0.05, 0.35]), [Presentation(np.array([0, 1.0, 0, 0]), 2, False)]
    by_head = [meant(head, one, prior, 1.0).goal[-1][2] for one in (free, bound)]
    assert by_head[0] > 1.5 * by_head[1]


@given(seeds)
@settings(max_examples=20, deadline=None)
def test_what_is_not_seen_yet_says_nothing_of_the_end(seed: int) -> None:
    """A movement whose end is unseen: sum over ends of all that might come, weighted as likely as they are."""
    knowing, prior, rng = world(seed)
    movement = rng.dirichlet(np.ones(ACTS))
    found = meant([Presentation(movement, None, False)], knowing, prior, 0.5).goal[-1]
    means = knowing.means
    expected = prior * (means @ movement)
    np.testing.assert_allclose(found, expected / expected.sum())


def test_what_nothing_explains_leaves_beliefs_as_they_were() -> None:
    knowing, prior, _ = world(1)
    found = meant([Presentation(np.zeros(ACTS), 0, False)], knowing, prior, 0.3)
    np.testing.assert_allclose(found.goal[1], found.goal[0])
    assert found.somebody[1] == pytest.approx(0.3)


def test_one_wants_what_one_s_acts_end_in_and_either_only_if_each_came_about() -> None:
    ends = np.array([0.5, 0.3, 0.2])
    both, one = (wanted(ends, np.array(came), MEMBERS) for came in ([True, True, True], [True, True, False]))
    np.testing.assert_allclose(both, np.array([0.5, 0.3, 0.2, 0.5]) / 1.5)
    np.testing.assert_allclose(one, [0.5, 0.3, 0.2, 0])
