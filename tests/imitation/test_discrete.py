"""Imitation in discrete states: priors by counting, sub-goals that never circle, the follower, memory as a file."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.files import load, save
from babbling.loop import babble
from babbling.moves import DIRECTIONS, MOVES, Places
from babbling.states import Wanderer
from imitation.acting.follow import Follower, follow
from imitation.acting.subgoals import acyclic_subgoals
from imitation.deferred import StepMemory
from imitation.episodes import Episode
from imitation.errors import ImitationError
from imitation.inference.bayes import action_posterior
from imitation.inference.priors import ActionPriors, check_goal_prior


class Field:
    """An open field of 12 x 9 places; moves that would leave it stay; `slips` go somewhere else."""

    def __init__(self, copies: int = 1, slips: float = 0.0, seed: int = 0) -> None:
        self.copies, self.slips, self.rng = copies, slips, np.random.default_rng(seed)

    motor_low, motor_high = np.zeros(1), np.full(1, 4.0)
    sense_low, sense_high = np.array([1, 1, 0, 0, 0, 0.0]), np.array([12, 9, 1, 1, 1, 1.0])
    tick_s, fingerprint = 1.0, "field"

    def reset(self):
        self.place = np.ones((self.copies, 2), int)
        return self.feel()

    def act(self, motors):
        slip = self.rng.random(self.copies) < self.slips
        move = np.where(slip, self.rng.integers(0, 5, self.copies), motors[:, 0].astype(int))
        self.place = np.clip(self.place + DIRECTIONS[move], 1, [12, 9])
        return self.feel()

    def feel(self):
        x, y = self.place.T
        return np.column_stack([self.place, y == 9, x == 12, y == 1, x == 1]).astype(float)


STATES = 12 * 9


@st.composite
def demonstrations(draw):
    """Random walks from state 0 that are cut when they first reach a goal: full of circles and contradictions."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    episodes = []
    for _ in range(draw(st.integers(1, 4))):
        place, states, actions = np.array([1, 1]), [0], []
        while states[-1] != 40:
            action = rng.integers(0, 5)
            place = np.clip(place + DIRECTIONS[action], 1, [12, 9])
            states.append((place[1] - 1) * 12 + place[0] - 1)
            actions.append(action)
        episodes.append(Episode(0, np.array(states), np.array(actions)))
    return episodes


@settings(max_examples=40, deadline=None)
@given(demonstrations())
def test_subgoals_lead_to_the_goal_without_circling_or_staying(episodes):
    plan = acyclic_subgoals(episodes, STATES)
    assert plan.remainder[40] == 0 and plan.successor[40] == -1
    known = np.flatnonzero(plan.remainder > 0)
    assert set(known) | {40} == {int(s) for e in episodes for s in e.states}
    assert (plan.remainder[plan.successor[known]] < plan.remainder[known]).all()
    assert (plan.successor[known] != known).all()
    pairs = {(int(a), int(b)) for e in episodes for a, b in zip(e.states[:-1], e.states[1:], strict=True)}
    assert all((int(s), int(plan.successor[s])) in pairs for s in known), "each was seen"


def test_subgoals_need_one_common_end():
    one, two = Episode(0, np.array([0, 1]), np.array([1])), Episode(0, np.array([0, 2]), np.array([0]))
    for given_, told in (([], "nothing was demonstrated"), ([one, two], "end in 2 different states")):
        with pytest.raises(ImitationError, match=told):
            acyclic_subgoals(given_, STATES)


@settings(max_examples=30, deadline=None)
@given(demonstrations(), st.sampled_from([0.0, 0.1, 2.0]))
def test_priors_are_counted_one_by_one(episodes, smoothing):
    priors = ActionPriors.learned(episodes, 2, STATES, 5)
    slow = np.zeros((2, STATES, 5), int)
    for e in episodes:
        for s, a in zip(e.states[:-1], e.actions, strict=True):
            slow[e.goal, s, a] += 1
    assert (priors.counts == slow).all()
    table = priors.action(smoothing)
    seen = slow.sum(-1) > 0
    np.testing.assert_allclose(table.sum(-1), 1 if smoothing else seen, atol=1e-12)
    n = slow[seen].sum(-1, keepdims=True)
    np.testing.assert_allclose(table[seen], (slow[seen] + smoothing) / (n + 5 * smoothing), atol=1e-12)
    if not smoothing:
        assert not table[~seen].any(), "zero, not unknown"
        assert priors.state().sum(-1) == pytest.approx([1, 0])


def test_doubt_is_the_average_over_both_hypotheses_by_brute_force():
    """Enumerate the evidence of counts as a product of predictive probabilities, in the order of experience."""
    rng = np.random.default_rng(0)
    counts, k = rng.integers(0, 4, (3, 20, 4)), 0.3

    def evidence(rows: list[np.ndarray]) -> float:  # type: ignore[type-arg]
        chance = 1.0
        for row in rows:
            seen = np.zeros(4)
            for action in np.repeat(np.arange(4), row):
                chance *= (seen[action] + k) / (seen.sum() + 4 * k)
                seen[action] += 1
        return chance

    doubtful = ActionPriors(counts).doubtful(k)
    np.testing.assert_allclose(doubtful.sum(-1), 1, atol=1e-12)
    for s in range(20):
        pooled = counts[:, s].sum(0)
        common, each = evidence([pooled]), evidence(list(counts[:, s]))
        w = common / (common + each)
        for g in range(3):
            own = (counts[g, s] + k) / (counts[g, s].sum() + 4 * k)
            expected = w * (pooled + k) / (pooled.sum() + 4 * k) + (1 - w) * own
            np.testing.assert_allclose(doubtful[g, s], expected, rtol=1e-10)
    with pytest.raises(ImitationError, match="doubt about counts needs pseudo-counts above 0"):
        ActionPriors(counts).doubtful(0.0)


def test_what_is_no_goal_prior_is_refused():
    assert check_goal_prior([0.5, 0.25, 0.25], 3).tolist() == [0.5, 0.25, 0.25]
    for given_, told in (
        ([0.5, 0.5], "of 2 numbers; there are 3 goals"),
        ([0.5, 0.4, 0.4], r"sums to 1\.3, not to 1"),
        ([1.5, -0.25, -0.25], "at least 0"),
        ([np.nan, 0.5, 0.5], "at least 0"),
    ):
        with pytest.raises(ImitationError, match=told):
            check_goal_prior(given_, 3)


def wanderer(body, **how):
    return Wanderer(body, Places.of(body), MOVES, **how)


def learned(body, steps=4000, alone=False):
    return babble(body, wanderer(body, alone=alone), (steps,), 0)


def journeys(body, model, plan, prior=None, *, goal=52, seed=0, limit, selection="map"):
    places, copies = Places.of(body), body.copies
    follower = Follower(model, places, plan.successor, goal, prior, copies=copies, selection=selection)
    return follow(body, follower, rng=np.random.default_rng(seed), limit=limit)


def diagonal():
    """A staircase from (1, 1) to (5, 5)."""
    actions = np.tile([0, 1], 4)
    places = np.vstack([[1, 1], np.array([1, 1]) + np.cumsum(DIRECTIONS[actions], 0)])
    return Episode(0, (places[:, 1] - 1) * 12 + places[:, 0] - 1, actions)


@pytest.mark.parametrize("selection", ["map", "matching"])
@pytest.mark.parametrize("alone", [False, True])
def test_the_follower_arrives_in_a_noisy_world(selection, alone):
    body, episode = Field(40, slips=0.3), diagonal()
    model = learned(body, 2000, alone)
    prior = ActionPriors.learned([episode], 1, STATES, 5).action()[0]
    plan = acyclic_subgoals([episode], STATES)
    journey = journeys(body, model, plan, prior, selection=selection, limit=400)
    assert journey.reached.all() and journey.steps.min() >= 8
    steps, decisions = journey.steps, journey.decisions
    assert (journey.states[steps, np.arange(40)] == 52).all()
    during = np.arange(len(decisions.action))[:, None] < steps
    assert ((decisions.action >= 0) == during).all()
    np.testing.assert_allclose(decisions.posterior.sum(-1), during, atol=1e-12)
    off = (plan.successor[journey.states[:-1]] < 0) & during
    assert (decisions.backtracking == off).all() and off.any()
    assert decisions.forward_alone[off].all(), "the prior is zero where nobody was watched"
    assert not decisions.chance.any()


def test_each_decision_is_eq_1():
    body, episode = Field(slips=0.2), diagonal()
    model = learned(body)
    prior = ActionPriors.learned([episode], 1, STATES, 5).action(0.5)[0]
    plan = acyclic_subgoals([episode], STATES)
    journey = journeys(body, model, plan, prior, limit=400)
    for t in range(journey.steps[0]):
        here, target = journey.states[t, 0], journey.decisions.subgoal[t, 0]
        outcome = next(
            k
            for k, (dx, dy) in enumerate(DIRECTIONS)
            if here % 12 + dx == target % 12 and here // 12 + dy == target // 12
        )
        expected = action_posterior(model.predictive[0, :, outcome], prior[here])
        np.testing.assert_allclose(journey.decisions.posterior[t, 0], expected.probability, atol=1e-12)
        assert journey.decisions.action[t, 0] == expected.probability.argmax()


def test_with_nothing_learned_the_prior_alone_decides_and_without_it_chance():
    body, episode = Field(), diagonal()
    empty, plan = wanderer(body).forward_model(), acyclic_subgoals([episode], STATES)
    prior = ActionPriors.learned([episode], 1, STATES, 5).action()[0]
    journey = journeys(body, empty, plan, prior, limit=100)
    assert journey.reached.all() and journey.steps[0] == 8, "a sure body repeats what it saw"
    stuck = wanderer(body).forward_model()  # has only ever seen itself stay, so no action explains a move
    stuck.observe([], np.arange(5)[:, None], np.full((5, 1), 4))
    journey = journeys(body, stuck, plan, prior, limit=50)
    assert journey.decisions.chance.sum() == journey.steps[0]
    np.testing.assert_allclose(journey.decisions.posterior.sum(-1), 1, atol=1e-12)


def test_the_same_seed_gives_the_same_journey_and_ties_are_broken_by_it():
    def way(seed):
        body, episode = Field(30, slips=0.2, seed=1), diagonal()
        plan = acyclic_subgoals([episode], STATES)
        empty = wanderer(body).forward_model()
        return journeys(body, empty, plan, seed=seed, limit=60).states

    assert np.array_equal(way(0), way(0))
    assert not np.array_equal(way(0), way(1)), "a uniform posterior is all ties"


def test_a_start_that_was_never_shown_is_refused():
    body = Field()
    plan = acyclic_subgoals([Episode(0, np.array([30, 31]), np.array([1]))], STATES)
    with pytest.raises(ImitationError, match=r"begins at \(1, 1\), where no demonstration went"):
        journeys(body, learned(body, 50), plan, goal=31, limit=10)
    here = journeys(body, learned(body, 50), plan, goal=0, limit=10)
    assert here.reached.all() and here.steps.tolist() == [0] and here.decisions.action.shape == (0, 1)


@pytest.mark.parametrize(
    "states,actions,told",
    [([0, 1], [1, 1], "2 states has 2 actions"), ([0, -1], [1], "whole numbers"), ([0, 0.5], [1], "whole numbers")],
)
def test_what_is_no_episode_is_refused(states, actions, told):
    with pytest.raises(ImitationError, match=told):
        Episode(0, np.array(states), np.array(actions))


def test_a_memory_survives_its_file_and_belongs_to_one_world(tmp_path):
    body = Field(slips=0.2)
    model, episodes = learned(body), (diagonal(), diagonal())
    save(StepMemory(model, episodes), tmp_path / "memory.nc")
    memory, empty = load(tmp_path / "memory.nc", StepMemory), wanderer(body).forward_model()
    memory.check(empty)
    assert (memory.forward_model.predictive == model.predictive).all()
    for one, two in zip(episodes, memory.episodes, strict=True):
        assert one.goal == two.goal and (one.states == two.states).all() and (one.actions == two.actions).all()
    with pytest.raises(ImitationError, match="state 52; there are 50"):
        ActionPriors.learned(memory.episodes, 1, 50, 5)
    with pytest.raises(ImitationError, match="goal 0; there are 0"):
        ActionPriors.learned(memory.episodes, 0, STATES, 5)
    other = Field()
    other.fingerprint = "another"
    with pytest.raises(ImitationError, match="belongs to body field, not to another"):
        memory.check(wanderer(other).forward_model())
