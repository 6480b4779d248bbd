"""Following over states that are no places: two things and a lamp, hands free or busy, against brute force."""

import numpy as np
import pytest

from babbling.forward_model import ForwardModel
from babbling.loop import babble
from babbling.states import Wanderer
from imitation.acting.follow import Follower, believed, follow
from imitation.errors import ImitationError

THINGS, HANDS = ("apart", "joined", "lit", "upset"), ("free", "busy")
ACTS = ("take", "join", "press", "drop", "wait")
SUCCESSOR = np.array([1, 2, -1, -1])  # apart, joined, lit; nobody was seen where things are upset


def dynamics():
    """[things, hands, act, things after], [act, hands after]: random, but the best act is clear and asks for hands."""
    for seed in range(10_000):
        rng = np.random.default_rng(seed)
        things, hands = rng.dirichlet(np.full(4, 0.7), (4, 2, 5)), rng.dirichlet(np.ones(2), 5)
        things = 0.94 * things + 0.015
        ordered = np.sort(things, axis=2)
        clear = (ordered[:, :, -1] - ordered[:, :, -2]).min() > 0.02
        best = things.argmax(2)
        if clear and (best[:2, 0, 1:3] != best[:2, 1, 1:3]).all():
            return things, hands
    raise AssertionError


TRUTH, GRIP = dynamics()


class Bench:
    """Senses: hands busy, things touching, light, things lying about."""

    motor_low, motor_high = np.zeros(1), np.full(1, 4.0)
    sense_low, sense_high = np.zeros(4), np.ones(4)
    tick_s, fingerprint = 1.0, "bench"

    def __init__(self, copies=1, seed=0):
        self.copies, self.rng = copies, np.random.default_rng(seed)

    def reset(self):
        self.things, self.hands = np.zeros(self.copies, int), np.zeros(self.copies, int)
        self.felt = []
        return self.feel()

    def act(self, motors):
        act = motors[:, 0].astype(int)
        chances = TRUTH[self.things, self.hands, act], GRIP[act]
        self.things, self.hands = (
            (self.rng.random((self.copies, 1)) >= np.cumsum(p, 1)[:, :-1]).sum(1) for p in chances
        )
        return self.feel()

    def feel(self):
        self.felt.append((self.things, self.hands))
        flags = self.hands == 1, (self.things == 1) | (self.things == 2), self.things == 2, self.things == 3
        return np.stack(flags, 1).astype(float)


class Things:
    """The map of the bench: what is there, and as a relation to it the hands; an outcome is the state that follows."""

    contexts, outcomes = {"things": THINGS, "hands": HANDS}, THINGS

    def number(self, senses):
        return np.where(senses[..., 3] > 0, 3, senses[..., 1] + senses[..., 2]).astype(np.int64)

    def context(self, senses):
        return self.number(senses), senses[..., 0].astype(np.int64)

    def outcome(self, here, there):
        return there

    def lawful(self, senses):
        return np.ones(senses.shape[:-1], bool)

    def name(self, number):
        return THINGS[number]


@pytest.fixture(scope="module")
def model():
    body = Bench(200)
    return babble(body, Wanderer(body, Things(), ACTS), (1500,), 0)


def follower(model, copies=1, prior=None, **how):
    return Follower(model, Things(), SUCCESSOR, 2, prior, copies=copies, **how)


def test_what_is_learned_is_what_acts_do_to_things_with_these_hands(model):
    np.testing.assert_allclose(model.predictive[0], TRUTH, atol=0.05)


def test_every_act_is_the_likeliest_to_lead_to_the_sub_goal_by_brute_force(model):
    body = Bench(60, seed=1)
    journey = follow(body, follower(model, 60), rng=np.random.default_rng(0), limit=300)
    assert journey.reached.all()
    there = np.arange(len(journey.states))[:, None] >= journey.steps
    np.testing.assert_array_equal(journey.states == 2, there)  # first there, then counted as there
    seen = set()
    for copy in range(60):
        came_from = {0: -1}
        for t in range(journey.steps[copy]):
            things, hands = (int(sense[copy]) for sense in body.felt[t])
            assert things == journey.states[t, copy]
            wanted = SUCCESSOR[things] if SUCCESSOR[things] >= 0 else came_from[things]
            assert journey.decisions.subgoal[t, copy] == wanted
            assert journey.decisions.backtracking[t, copy] == (things == 3)
            chances = [TRUTH[things, hands, act, wanted] for act in range(5)]
            assert journey.decisions.action[t, copy] == np.argmax(chances)
            came_from.setdefault(int(journey.states[t + 1, copy]), things)
            seen.add((things, hands, int(wanted)))
    assert seen >= {(0, 0, 1), (0, 1, 1), (1, 0, 2), (1, 1, 2)} and any(things == 3 for things, _, _ in seen)


def test_the_prior_multiplies_and_the_posterior_is_eq_1(model):
    body, prior = Bench(10, seed=2), np.random.default_rng(3).dirichlet(np.ones(5), 4)
    journey = follow(body, follower(model, 10, prior, selection="matching"), rng=np.random.default_rng(0), limit=40)
    for t, copy in np.argwhere(journey.decisions.action >= 0):
        things, hands = (int(sense[copy]) for sense in body.felt[t])
        joint = model.predictive[0, things, hands, :, journey.decisions.subgoal[t, copy]] * prior[things]
        np.testing.assert_allclose(journey.decisions.posterior[t, copy], joint / joint.sum(), atol=1e-12)
        assert journey.decisions.evidence[t, copy] == pytest.approx(joint.sum())


def test_who_learned_alone_goes_by_what_it_learned_itself():
    body = Bench(6, seed=4)
    alone = babble(body, Wanderer(body, Things(), ACTS, alone=True), (300,), 0)
    journey = follow(body, follower(alone, 6), rng=np.random.default_rng(0), limit=30)
    for t, copy in np.argwhere(journey.decisions.action >= 0):
        things, hands = (int(sense[copy]) for sense in body.felt[t])
        wanted = journey.decisions.subgoal[t, copy]
        likely = believed(alone)[copy, things, hands, :, wanted]
        np.testing.assert_allclose(journey.decisions.posterior[t, copy], likely / likely.sum(), atol=1e-12)


def test_an_act_never_tried_with_these_hands_says_nothing_there_and_only_there(model):
    counts = model.counts.copy()
    counts[0, 0, 1, 3] = 0
    partial = ForwardModel(model.contexts, model.action, model.outcome, factors=model.factors)
    partial.add(counts)
    table = believed(partial)
    assert (table[0, 0, 1, 3] == 0.25).all()
    table[0, 0, 1, 3] = model.predictive[0, 0, 1, 3]
    np.testing.assert_array_equal(table, model.predictive)


def test_steps_by_hand_are_what_the_loop_does_and_change_no_state(model):
    journey = follow(Bench(5, 7), follower(model, 5, selection="matching"), rng=np.random.default_rng(0), limit=25)
    body, rng, one = Bench(5, 7), np.random.default_rng(0), follower(model, 5, selection="matching")
    senses = body.reset()
    state = one.start(senses)
    for t in range(len(journey.decisions.action)):
        before = [part.copy() for part in state]
        after, motors, info = one.step(state, senses, rng)
        assert all((a == b).all() for a, b in zip(before, state, strict=True))
        assert (after.here == journey.states[t]).all()
        for name, column in info._asdict().items():
            np.testing.assert_array_equal(column, getattr(journey.decisions, name)[t], err_msg=name)
        state, senses = after, body.act(motors)


def test_an_early_end_is_a_result(model):
    """So is a limit; here one stops when the things were upset for the second time."""
    short = follow(Bench(8, 1), follower(model, 8), rng=np.random.default_rng(0), limit=2)
    assert len(short.decisions.action) == 2 and (short.steps[~short.reached] == 2).all() and not short.reached.all()
    counted = []

    def upset(senses):
        counted.append(senses[:, 3].sum())
        return "upset twice" if np.sum(counted) >= 2 else None

    whole = follow(Bench(8, 1), follower(model, 8), rng=np.random.default_rng(0), limit=300)
    journey = follow(Bench(8, 1), follower(model, 8), rng=np.random.default_rng(0), limit=300, ended=upset)
    done = len(journey.decisions.action)
    assert whole.ended is None and journey.ended == "upset twice" and not journey.reached.all()
    assert 0 < done == len(counted) - 1 == len(journey.states) - 1 < len(whole.decisions.action)
    np.testing.assert_array_equal(journey.states, whole.states[: done + 1])
    np.testing.assert_array_equal(journey.steps, np.where(journey.reached, whole.steps, done))


def test_what_cannot_be_followed(model):
    lost = Follower(model, Things(), np.array([-1, 2, -1, -1]), 2)
    with pytest.raises(ImitationError, match="begins at apart, where no demonstration went"):
        follow(Bench(), lost, rng=np.random.default_rng(0), limit=10)
    with pytest.raises(ImitationError, match="a limit of 0 steps; at least 1"):
        follow(Bench(), follower(model), rng=np.random.default_rng(0), limit=0)
