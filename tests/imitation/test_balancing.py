"""Offsets by Eq. (1) with two terms, in a world that is known: by brute force, one tick ahead, as dear as asked."""

from dataclasses import replace

import numpy as np
import pytest

from babbling.balance import SETTLED, Balance
from experiments.gesture.options import Config
from imitation.acting.balancing import BEGIN, LATELY, MATCH, MOST, ON, QUICK, STAYS, SWAY, WEIGHT, Balancer, Feeling
from imitation.acting.balancing import LEANS as LEANS_MOST
from tests.babbling import soles
from tests.babbling.soles import COUNT, HOME, PRESSURE, TICK

LEANS = np.array([-1.5, -0.75, -0.25, 0.0, 0.5, 1.0])
"""Grid points of lean."""


@pytest.fixture(scope="module")
def stood() -> Balance:
    return soles.stood(np.random.default_rng(3))


@pytest.fixture(scope="module")
def wiggled() -> Balance:
    return soles.learned(np.random.default_rng(3))


def held(balancer: Balancer, leans: np.ndarray) -> np.ndarray:
    """(N, 2) offsets once the same (N,) leans, both ways, have been there for long."""
    return balancer.offsets(np.tile(np.repeat(leans[:, None], 2, 1), (80, 1, 1)))[-1]


def moving(seed: int, copies: int = 3) -> np.ndarray:
    """(T, B, F) postures that somebody would like to come to."""
    return HOME + soles.moves(0.3, copies, 2.0, np.random.default_rng(seed), COUNT)


@pytest.mark.parametrize("weight", [0.02, 0.3, 1.0, 3.0])
def test_an_offset_is_the_mean_of_likelihood_to_the_w_times_the_match(stood: Balance, weight: float) -> None:
    table = stood.forward_model
    offsets = table.action.points
    balanced = np.flatnonzero(table.outcome.points[0] == 0).item()
    for lean, chosen in zip(LEANS, held(Balancer(stood, weight), LEANS), strict=True):
        cell = np.flatnonzero(table.contexts[0].points[0] == lean).item()
        joint = table.predictive[:, cell, :, balanced] ** weight * np.exp(-0.5 * (offsets / MATCH) ** 2)
        np.testing.assert_allclose(chosen, (joint * offsets).sum(1) / joint.sum(1), atol=1e-9)


def test_what_an_offset_comes_to_is_balance(stood: Balance) -> None:
    """lean + gain a = 0 to within a cell of the table, where the experience is."""
    gain = np.diag(PRESSURE @ stood.synergy.T)
    leans = np.linspace(-0.9, 0.9, 13)
    left = leans[:, None] + gain * held(Balancer(stood), leans)
    assert (np.abs(left) < stood.forward_model.contexts[0].step).all()


def test_the_more_balance_counts_the_nearer_it_comes_to_it(stood: Balance) -> None:
    targets = np.repeat(HOME + 0.2 * np.eye(COUNT)[[8]], 80, 0)[:, None]
    at = replace(stood, weights=stood.weights + np.pad([[0.6], [-0.6]], ((0, 0), (0, stood.weights.shape[1] - 1))))
    plans = [Balancer(at, weight).plan(targets) for weight in (0.0, 0.03, 1.0)]
    left = np.abs([plan.expected[-1, 0] for plan in plans])
    assert (np.diff(left, axis=0) < -0.004).all() and (left[-1] < 0.07).all() and (left[0] > 0.4).all()


def test_who_does_not_mind_falling_does_what_the_teacher_did(stood: Balance) -> None:
    targets = moving(0)
    plan = Balancer(stood, 0.0).plan(targets)
    assert not plan.offset.any()
    np.testing.assert_allclose(plan.postures, stood.safe(targets), atol=1e-12)
    np.testing.assert_array_equal(plan.planned, plan.postures)


def test_a_plan_says_what_it_was_made_of(stood: Balance) -> None:
    targets, balancer = moving(1), Balancer(stood)
    plan = balancer.plan(targets)
    np.testing.assert_allclose(plan.planned, stood.safe(targets), atol=1e-12)
    np.testing.assert_array_equal(plan.lean, stood.leaning(plan.planned))
    np.testing.assert_allclose(plan.offset, balancer.offsets(plan.lean))
    np.testing.assert_allclose(plan.postures, plan.planned + plan.offset @ stood.synergy)
    np.testing.assert_allclose(plan.expected, stood.forward_model.expected((plan.lean,), plan.offset))
    alone = balancer.plan(targets[:, 1:2])
    for one, all_of_them in zip(alone, plan, strict=True):
        np.testing.assert_allclose(one[:, 0], all_of_them[:, 1], atol=1e-12)
    more = np.random.default_rng(0).uniform(-0.1, 0.1, plan.offset.shape)
    explored = balancer.plan(targets, more)
    np.testing.assert_allclose(explored.offset, plan.offset + more)
    np.testing.assert_array_equal(explored.planned, plan.planned)


def test_legs_follow_only_as_far_as_an_offset_can_mend(stood: Balance) -> None:
    """The first pair leans 3 a radian: beyond `LEANS` less of it is followed; what does not carry, as ever."""
    far = np.repeat((HOME + 0.6 * np.eye(COUNT)[[0, 1]].sum(0) + 0.3 * np.eye(COUNT)[9])[None, None], 80, 0)
    free = replace(stood, following=np.eye(COUNT))
    planned = Balancer(free).follow(far)
    assert LEANS_MOST - 0.4 < np.abs(free.leaning(planned)).max() <= LEANS_MOST < np.abs(free.leaning(far)).max()
    np.testing.assert_allclose(planned[..., 8:], far[..., 8:])
    near = HOME + 0.2 * (far - HOME)
    np.testing.assert_allclose(Balancer(free).follow(near), near, atol=1e-12)


def test_before_any_table_the_line_of_the_wiggles_balances(wiggled: Balance) -> None:
    balancer = Balancer(wiggled)
    lean = np.random.default_rng(0).uniform(-1, 1, (1, 4, 2)).repeat(80, 0)
    np.testing.assert_allclose(lean[-1] + balancer.offsets(lean)[-1] @ balancer.gains.T, 0, atol=1e-9)
    plan = balancer.plan(moving(2))
    np.testing.assert_allclose(plan.expected, plan.lean + plan.offset @ balancer.gains.T)


def test_the_peer_is_the_least_squares_line_of_the_same_experience(wiggled: Balance, stood: Balance) -> None:
    """Where offsets were drawn without regard to lean, the regression of offset on lean and pressure is known."""
    rng = np.random.default_rng(8)
    lean, offset = rng.uniform(-0.4, 0.4, (20_000, 2)), rng.uniform(-0.1, 0.1, (20_000, 2))
    table = soles.stood(rng).forward_model
    table.counts[:], table.outside[:], table.moments.sums[:] = 0, 0, 0
    table.observe((lean,), offset, lean + 4 * offset)
    peer = Balancer(replace(stood, forward_model=table), linear=True)
    np.testing.assert_allclose(held(peer, LEANS), np.repeat(-LEANS[:, None] / 4, 2, 1), atol=2e-3)
    ours, theirs = held(Balancer(stood), LEANS), held(Balancer(stood, linear=True), LEANS)
    np.testing.assert_allclose(ours, theirs, atol=0.01)  # this world is a line
    assert (ours != theirs).all() and np.array_equal(theirs, held(Balancer(stood, 0.01, linear=True), LEANS))


@pytest.mark.parametrize("linear", [False, True])
def test_what_was_planned_is_read_one_tick_ahead(stood: Balance, wiggled: Balance, linear: bool) -> None:
    """A lean that comes and goes is answered by an offset whose middle is one tick before it, and nothing later."""
    for balance in (stood, wiggled):
        lean = np.zeros((120, 1, 2))
        lean[70] = 0.3
        balancer = Balancer(balance, linear=linear)
        answer = np.abs(balancer.offsets(lean) - balancer.offsets(0 * lean))[..., 0, :]
        middle = (answer * np.arange(120)[:, None]).sum(0) / answer.sum(0)
        np.testing.assert_allclose(middle, 69, atol=1e-6)
        late = np.zeros((120, 1, 2))
        late[-1] = 0.3
        answer = np.abs(balancer.offsets(late) - balancer.offsets(0 * late))[-2:, 0]
        assert (answer > 0).all(), "the last one stays"


def test_offsets_are_taken_up_gradually_and_stay_on_the_axis(stood: Balance, wiggled: Balance) -> None:
    lean = np.full((80, 1, 2), 0.6)
    for balance in (stood, wiggled):
        taken = Balancer(balance).offsets(lean)[:, 0]
        np.testing.assert_allclose(taken / taken[-1], np.minimum(np.arange(80) / BEGIN, 1)[:, None].repeat(2, 1))
        far = Balancer(balance).offsets(100 * lean)
        axis = balance.forward_model.action
        assert (np.abs(far) <= axis.high + 1e-12).all() and np.isfinite(far).all()
    assert TICK * BEGIN == pytest.approx(0.5)


def felt(balance: Balance, pressure: np.ndarray) -> np.ndarray:
    """(..., L) loads of pressures (..., 2): as at rest, and so much more."""
    usual = np.full(balance.pressing.shape[1], 1 / balance.pressing.shape[1])
    split = usual + (pressure - balance.pressing @ usual) @ np.linalg.pinv(balance.pressing).T
    return balance.weight * split


def test_what_stays_of_pressure_is_found_whatever_is_done_about_it(stood: Balance) -> None:
    """A constant push on the pressure, in a world as foretold but for it: what stays comes to it with time constant
    STAYS, and pressure to 0."""
    balancer, pushed = Balancer(stood), np.array([[0.3, -0.2], [0.0, 0.0]])
    plan = balancer.plan(np.repeat(HOME[None], 5000, 0)[:, None])
    feeling, coming, gone = Feeling(balancer, plan, 2), [np.zeros((2, 2))] * SETTLED, []
    for _ in range(900):
        feeling(felt(stood, coming[-SETTLED]))
        coming.append(feeling.expected[-1] - feeling.stays + pushed)  # what was foretold counts what stays
        gone.append(feeling.stays.copy())
    away = pushed[0] - np.array(gone)[:, 0]
    lasted = away[SETTLED + BEGIN + round(STAYS) + 3] / pushed[0]
    np.testing.assert_allclose(lasted, np.exp(-1), atol=0.05)
    np.testing.assert_allclose(gone[-1], pushed, atol=0.01)
    np.testing.assert_allclose(coming[-1], 0, atol=0.03)


def test_in_the_air_nothing_is_felt_and_nothing_stays_beyond_the_soles(stood: Balance) -> None:
    balancer = Balancer(stood)
    plan = balancer.plan(np.repeat(HOME[None], 400, 0)[:, None])
    feeling = Feeling(balancer, plan, 2)
    for _ in range(390):
        feeling(felt(stood, np.array([[0.9, 0.9], [0.9, 0.9]])) * np.array([[1.0], [0.4]]))
    assert (feeling.stays[0] > 0.5).all() and (feeling.stays <= MOST).all() and not feeling.stays[1].any()


def test_of_a_quick_movement_and_of_the_edge_less_is_heeded(stood: Balance) -> None:
    balancer = Balancer(stood)
    plan = balancer.plan(np.repeat(HOME[None], 60, 0)[:, None])
    ramp = np.arange(60)[:, None, None] * np.array([QUICK / LATELY, 0.0])
    after = []
    for lean, pushed in ((0 * ramp, 0.2), (ramp, 0.2), (0 * ramp, 0.2 - QUICK)):
        feeling = Feeling(balancer, plan._replace(lean=lean), 1)
        for _ in range(SETTLED + BEGIN):
            feeling(felt(stood, plan.expected[0] + pushed))
        feeling.expected[-SETTLED] = plan.expected[0]
        feeling(felt(stood, plan.expected[0] + 0.2))
        after.append(feeling.stays[0])
        feeling(felt(stood, np.array([[1.0, 0.2]])))
        assert feeling.stays[0, 0] == after[-1][0] and feeling.stays[0, 1] != after[-1][1], "at the edge: that way not"
    np.testing.assert_allclose(after[0], 0.2 / STAYS)
    np.testing.assert_allclose(after[1], [0.1 / STAYS, 0.2 / STAYS])
    np.testing.assert_allclose(after[2], 0.1 / STAYS)


def test_as_foretold_nothing_is_added(stood: Balance) -> None:
    balancer = Balancer(stood)
    plan = balancer.plan(moving(5, 1))
    feeling = Feeling(balancer, plan, 3)
    for tick in range(len(plan.lean) - 1):
        then = plan.expected[max(0, tick - SETTLED + 1)]
        more = feeling(felt(stood, np.repeat(then, 3, 0)))
        np.testing.assert_allclose(more, 0, atol=1e-9)


def test_the_option_and_the_law_agree_on_how_much_balance_counts() -> None:
    assert Config().balance_weight == WEIGHT


@pytest.fixture(scope="module")
def on_one(stood: Balance) -> Balance:
    """Joints 2, 3, 6, 7 sway; on either sole one of 0 and 1, and of 4 and 5, is free."""
    sway = np.array([0, 0, 1, -1, 0, 0, 1, -1.0, 0, 0])
    free = np.array([[1, 0, 0, 0, 1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 1, 0, 0, 0, 0.0]])
    return replace(
        stood, synergy=np.stack([stood.synergy[0], sway]), there=np.array([[0.05, -0.6], [-0.05, 0.7]]), free=free
    )


def swayed(rad: float, lift: float = 0.0) -> np.ndarray:
    """(T, 1, F) the legs sway, one joint is lifted meanwhile, and back."""
    second = np.arange(400) * TICK
    share, up = (np.interp(second, [a, b, 8 - b, 8 - a], [0, 1, 1, 0])[:, None, None] for a, b in ((1, 2), (2, 3)))
    return np.asarray(HOME + share * rad * np.array([0, 0, 1, -1, 0, 0, 1, -1.0, 0, 0]) + up * lift * np.eye(COUNT)[0])


def test_pressure_goes_where_the_teachers_legs_shift_the_weight(on_one: Balance) -> None:
    """And not where but one of them goes aside; nor for a squat, or for who cannot stand on one leg."""
    balancer = Balancer(on_one)
    gain = balancer.gains[1, 1]
    for side, there in zip((-1, 1), on_one.there, strict=True):
        np.testing.assert_allclose(balancer.plan(swayed(side * 0.5 / gain)).goal[200, 0], there)
        np.testing.assert_allclose(balancer.plan(swayed(side * SWAY / 2 / gain)).goal[200, 0], there / 2)
        far = balancer.plan(swayed(side * 0.6 / gain))
        np.testing.assert_allclose(far.planned[200], HOME[None], atol=1e-9)
        assert np.abs(far.expected[200, 0] - there).max() < 0.1
    aside = swayed(0.5 / gain)
    aside[..., 3] = HOME[3]
    crouch = HOME + 0.3 * np.eye(COUNT)[[0, 1]].sum(0)[None, None].repeat(80, 0)
    for still in (aside, crouch):
        plan = balancer.plan(still)
        assert not plan.goal.any()
        np.testing.assert_array_equal(plan.offset, Balancer(replace(on_one, free=0 * on_one.free)).plan(still).offset)
    both = Balancer(replace(on_one, free=0 * on_one.free)).plan(swayed(0.5 / gain))
    assert not both.goal.any() and np.abs(both.expected[BEGIN:]).max() < 0.1


def test_a_leg_is_free_while_the_weight_is_beside_it_and_only_then(on_one: Balance) -> None:
    balancer = Balancer(on_one)
    gain = balancer.gains[1, 1]
    targets = swayed(-0.5 / gain, 0.8)
    lifted = balancer.plan(targets).planned[:, 0, 0] - HOME[0]
    wanted = targets[:, 0, 0] - HOME[0]
    np.testing.assert_allclose(lifted[150:250], wanted[150:250])
    other = balancer.plan(swayed(0.5 / gain, 0.8)).planned[:, 0, 0] - HOME[0]
    assert np.abs(other).max() < 0.4, "that leg carries: what pairs can do of it at most"
    early = swayed(-0.5 / gain, 0.8)
    early[:, :, 0] = HOME[0] + 0.8
    lifted = balancer.plan(early).planned[:, 0, 0] - HOME[0]
    onto = balancer.sway(early)[0][:, 0, 0]
    assert np.abs(lifted[onto < ON]).max() < 0.41 < 0.79 < lifted[200]
