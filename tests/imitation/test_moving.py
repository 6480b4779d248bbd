"""Eq. (1) over real-valued actions: against a dense grid, the closed form on a line, and each of its factors."""

import numpy as np
import pytest

from babbling.axes import Axis
from babbling.explanations import EXPLANATIONS, Explanations
from babbling.features import Echo
from babbling.forward_model import ForwardModel
from experiments.shared.peers import inverse_line
from imitation.errors import ImitationError
from imitation.inference.inverse import Term
from imitation.inference.moving import CANDIDATES, AveragedInverse, Decided, Here
from tests.babbling.joints import bent, learned, linear, met, slack, sticky

RULES = (linear, bent, slack, sticky)
RNG = np.random.default_rng(0)


@pytest.fixture(scope="module")
def known() -> dict[object, Explanations]:
    """What is known of each world."""
    return {rule: learned(rule, 1500, seed=10) for rule in RULES}


def places(rule, seed: int = 50) -> tuple[Here, np.ndarray]:
    """Twenty places of a life that was not learned from, and what happened there."""
    posture, rate, echo, outcome = met(rule, 120, seed)
    return Here(posture, rate, echo, rate, rate), outcome


def densely(model: Explanations, here: Here, wanted, log_prior, terms=(), size: int = 20001):
    """20 001 actions far to either side, evenly: (A, B, F) actions and their posterior, worked out as it is defined."""
    outlook = model.at(here.posture, here.rate, here.echo)
    actions = np.linspace(-0.8, 0.8, size)[:, None, None] + np.zeros_like(here.posture)
    logs = -0.5 * ((wanted - outlook.expected(here.posture + actions)) / model.spread) ** 2
    logs += log_prior(outlook, actions)
    for term in terms:
        logs += np.asarray(term.weight) * np.log(np.maximum(term.likelihood(actions), 1e-300))
    density = np.exp(logs - logs.max(0))
    return actions, density / density.sum(0)


def moments(actions, density):
    mean = (density * actions).sum(0)
    return mean, np.sqrt((density * (actions - mean) ** 2).sum(0))


def trusting(model: Explanations, trust):
    return lambda outlook, actions: -0.5 * trust * ((actions - outlook.usual) / model.habit[1]) ** 2


@pytest.mark.parametrize("trust", [0.0, 0.1, 1.0])
@pytest.mark.parametrize("rule", RULES)
def test_the_mean_is_that_of_a_dense_grid(known, rule, trust: float) -> None:
    """Within a fiftieth of a standard deviation under slack and stiction, exactly on a line."""
    model, (here, wanted) = known[rule], places(rule)
    mean, spread = moments(*densely(model, here, wanted, trusting(model, trust)))
    choice = AveragedInverse(model, "mean", trust=trust).choose(here, wanted, (), RNG)
    off = np.abs(choice.action - mean) / spread
    assert off.max() < (1e-6 if rule is linear else 0.02) and np.quantile(off, 0.9) < 4e-3
    assert choice.candidates.shape == choice.posterior.probability.shape == (20, 2, CANDIDATES)
    np.testing.assert_allclose(choice.posterior.probability.sum(-1), 1)


@pytest.mark.parametrize("rule", RULES)
def test_the_most_probable_action_is_that_of_a_dense_grid(known, rule) -> None:
    """None on 20 001 actions is more probable by more than a twentieth."""
    model, (here, wanted) = known[rule], places(rule)
    actions, density = densely(model, here, wanted, trusting(model, 0.1))
    action = AveragedInverse(model).choose(here, wanted, (), RNG).action
    outlook = model.at(here.posture, here.rate, here.echo)

    def logs(one):
        likelihood = -0.5 * ((wanted - outlook.expected(here.posture + one)) / model.spread) ** 2
        return likelihood + trusting(model, 0.1)(outlook, one)

    best = np.take_along_axis(actions, density.argmax(0)[None], 0)[0]
    assert (logs(best) - logs(action)).max() < 0.05


def test_with_more_candidates_it_is_the_dense_grid(known) -> None:
    for rule in (slack, sticky):
        model, (here, wanted) = known[rule], places(rule)
        mean, spread = moments(*densely(model, here, wanted, trusting(model, 0.1)))
        choice = AveragedInverse(model, "mean", trust=0.1, candidates=401).choose(here, wanted, (), RNG)
        assert (np.abs(choice.action - mean) / spread).max() < 1e-3


def test_both_humps_of_stick_or_slip_are_in_it(known) -> None:
    """Held fast, or just let go: what is wanted may come of either; the posterior says with what probability."""
    model, (here, _) = known[sticky], places(sticky)
    here = Here(here.posture, 0 * here.rate, model.features.start(here.posture), here.pace, here.ahead)
    wanted = np.full_like(here.posture, 2e-3)
    actions, density = densely(model, here, wanted, trusting(model, 0.1))
    choice = AveragedInverse(model, "mean", trust=0.1).choose(here, wanted, (), RNG)
    for quarter in (0.25, 0.5, 0.75):
        edge = choice.candidates[..., 0] + quarter * np.ptp(choice.candidates, axis=-1)
        mine = (choice.posterior.probability * (choice.candidates < edge[..., None])).sum(-1)
        np.testing.assert_allclose(mine, (density * (actions < edge)).sum(0), atol=0.08)
    outside = (actions < choice.candidates[..., 0]) | (actions > choice.candidates[..., -1])
    assert (density * outside).sum(0).max() < 1e-5, "nothing that matters lies beyond its ends"


@pytest.mark.parametrize("trust", [0.0, 0.1, 1.0, np.array([0.0, 2.0])])
def test_on_a_line_it_is_eq_1_in_closed_form(known, trust) -> None:
    """Two Gaussians multiply; the evidence is their overlap, the prior summing to one over what is weighed."""
    model, (here, wanted) = learned(linear, 1500, seed=10), places(linear)
    model.evidence[:] = np.where(np.array(EXPLANATIONS) == "line", 0, -1e3)
    model._forget()
    stay, coast, pull = model.fit("line").coefficients[:, 0].T
    rest = wanted - stay - coast * here.rate
    usual = model.at(here.posture, here.rate, here.echo).usual
    sure, used = (pull / model.spread) ** 2, trust / model.habit[1] ** 2
    mean = (sure * rest / pull + used * usual) / (sure + used)
    choice = AveragedInverse(model, "mean", trust=trust).choose(here, wanted, (), RNG)
    np.testing.assert_allclose(choice.action, mean, atol=1e-8)
    spread = np.sqrt((choice.posterior.probability * (choice.candidates - mean[..., None]) ** 2).sum(-1))
    np.testing.assert_allclose(spread, np.broadcast_to(1 / np.sqrt(sure + used), spread.shape), rtol=1e-5)
    step = choice.candidates[..., 1] - choice.candidates[..., 0]
    line = -0.5 * sure[:, None] * (choice.candidates - (rest / pull)[..., None]) ** 2
    habit = -0.5 * np.broadcast_to(used, (2,))[:, None] * (choice.candidates - usual[..., None]) ** 2
    habit = np.exp(habit - habit.max(-1, keepdims=True))
    overlap = (np.exp(line) * habit).sum(-1) / habit.sum(-1)
    np.testing.assert_allclose(choice.posterior.evidence, overlap, rtol=1e-8)
    assert (step > 0).all() and (choice.posterior.evidence <= 1).all()


def test_a_prior_of_ones_own_replaces_the_habit(known) -> None:
    model, (here, wanted) = known[slack], places(slack)

    def here_or_there(outlook, actions):
        """Two humps, one to either side of what is usual here, the left one half as likely."""
        away = (actions - outlook.usual) / 0.01
        return np.logaddexp(-0.5 * (away - 2) ** 2, np.log(0.5) - 0.5 * (away + 2) ** 2)

    mean, spread = moments(*densely(model, here, wanted, here_or_there))
    choice = AveragedInverse(model, "mean", trust=5.0, prior=here_or_there).choose(here, wanted, (), RNG)
    assert (np.abs(choice.action - mean) / spread).max() < 0.02
    plain = AveragedInverse(model, "mean", trust=0.1).choose(here, wanted, (), RNG).action
    assert np.abs(choice.action - plain).max() > 0.1 * spread.max()


@pytest.mark.parametrize("weight", [0.0, 1.0, 2.0, np.array([0.0, 1.5])])
def test_terms_are_multiplied_in_by_their_weights(known, weight) -> None:
    """Another forward model of the same actions: a pull that is to be so much."""
    model, (here, wanted) = known[slack], places(slack)
    axes = [Axis(name, "rad", np.full(2, -0.2), np.full(2, 0.2), 81) for name in ("rate", "action", "pull")]
    other, rng = ForwardModel(axes[:1], *axes[1:], factors=("0", "1"), prior_strength=1.0), np.random.default_rng(1)
    v, a = rng.uniform(-0.2, 0.2, (2, 3000, 2))
    other.observe((v,), a, (0.5 * a + 0.2 * v + 0.01 * rng.standard_normal(a.shape)).clip(-0.2, 0.2))
    there = rng.uniform(-0.1, 0.1, (2, 20, 2))
    term = Term(other, (there[0],), 0.5 * (wanted / 0.3) + 0.02 * there[1] + 0.2 * there[0], weight)
    mean, spread = moments(*densely(model, here, wanted, trusting(model, 0.1), [term]))
    inverse = AveragedInverse(model, "mean", trust=0.1)
    choice = inverse.choose(here, wanted, [term], RNG)
    assert (np.abs(choice.action - mean) / spread).max() < 0.05
    alone = inverse.choose(here, wanted, (), RNG)
    heard = np.broadcast_to(np.asarray(weight) > 0, (2,))
    assert (np.abs(choice.action - alone.action) > 1e-5).any(0).tolist() == heard.tolist()
    if np.ndim(weight) == 0 and weight == 2.0:
        once = Term(other, term.context, term.outcome)
        np.testing.assert_allclose(inverse.choose(here, wanted, [once, once], RNG).action, choice.action, atol=1e-12)


def test_map_is_where_the_density_is_greatest(known) -> None:
    for rule in (linear, slack):
        model, (here, wanted) = known[rule], places(rule)
        actions, density = densely(model, here, wanted, trusting(model, 1.0))
        choice = AveragedInverse(model, "map", trust=1.0).choose(here, wanted, (), RNG)
        step = choice.candidates[..., 1] - choice.candidates[..., 0]
        there = np.take_along_axis(density, np.abs(actions - choice.action).argmin(0)[None], 0)[0]
        assert (there > 0.9 * density.max(0)).all()
        if rule is linear:
            _, spread = moments(actions, density)
            best = np.take_along_axis(actions, density.argmax(0)[None], 0)[0]
            np.testing.assert_allclose(choice.action, best, atol=1e-4)
            assert (step < spread).all()


def test_matching_draws_from_it(known) -> None:
    """Four hundred draws at each of twenty places: their ranks in the dense posterior are uniform."""
    model, (here, wanted) = known[sticky], places(sticky)
    density = densely(model, here, wanted, trusting(model, 0.1))[1]
    below, rng = np.cumsum(density, axis=0), np.random.default_rng(4)
    inverse, ranks = AveragedInverse(model, "matching", trust=0.1), []
    for _ in range(400):
        drawn = inverse.choose(here, wanted, (), rng).action
        index = np.clip(np.rint((drawn + 0.8) / 1.6 * 20000), 0, 20000).astype(int)
        ranks.append(np.take_along_axis(below, index[None], 0)[0])
    shares = np.histogram(ranks, 10, (0, 1))[0] / np.size(ranks)
    np.testing.assert_allclose(shares, 0.1, atol=0.012)
    per_place = np.mean(ranks, axis=0)
    assert np.abs(per_place - 0.5).max() < 6 * np.sqrt(1 / 12 / 400)


def test_what_it_expects_is_the_forward_model(known) -> None:
    model, (here, _) = known[slack], places(slack)
    command = here.posture + 0.05
    told = AveragedInverse(model).expect(here, command)
    np.testing.assert_array_equal(told, model.at(here.posture, here.rate, here.echo).expected(command))


def test_off_the_tables_ends_is_said_and_nothing_is_made_up(known) -> None:
    model, (here, wanted) = known[sticky], places(sticky)
    inverse = AveragedInverse(model)
    assert inverse.choose(here, wanted, (), RNG).beyond.mean() < 0.02
    wild = inverse.choose(here._replace(rate=here.rate + 1e3), wanted, (), RNG)
    assert wild.beyond.all() and np.isfinite(wild.action).all() and np.isfinite(wild.posterior.evidence).all()
    assert not AveragedInverse(known[linear]).choose(here._replace(rate=here.rate + 1e3), wanted, (), RNG).beyond.any()
    assert not Decided.bare(wanted).beyond.any() and Decided.bare(wanted).candidates.shape == (20, 2, 0)


def test_copies_and_factors_do_not_mix(known) -> None:
    model, (here, wanted) = known[sticky], places(sticky)
    inverse = AveragedInverse(model, "mean", trust=np.array([0.1, 1.0]))
    whole = inverse.choose(here, wanted, (), RNG).action
    some = [3, 17]
    posture, rate, echo, *rest = here
    part = Here(posture[some], rate[some], Echo(*(one[some] for one in echo)), *(one[some] for one in rest))
    np.testing.assert_allclose(inverse.choose(part, wanted[some], (), RNG).action, whole[some], atol=1e-12)
    other = inverse.choose(here, wanted + np.array([0, 0.01]), (), RNG).action
    np.testing.assert_array_equal(other[:, 0], whole[:, 0])
    assert (other[:, 1] != whole[:, 1]).all()


def test_an_unknown_rule_is_refused(known) -> None:
    with pytest.raises(ImitationError, match="unknown selection 'men'"):
        AveragedInverse(known[linear], "men")


# ------------------------------------------------------------------ the line alone


@pytest.mark.parametrize("rule", RULES)
def test_the_line_alone_with_its_whole_prior_is_the_inverse_line(rule) -> None:
    """Gaussian Eq. (1) of a line w = b0 + b1 v + k a and of the habit a = h0 + h1 v is the regression of a on v and w,
    for errors as they are in hindsight; what was foretold missed by hardly more."""
    model, (here, wanted) = learned(rule, 3000, seed=10), places(rule)
    line = model.by_line(np.array([True, True]))
    assert (line.weights == np.eye(1, len(EXPLANATIONS))).all()
    answer = inverse_line(model).choose(here, wanted, (), RNG).action
    mine = AveragedInverse(line, "mean", trust=1.0).choose(here, wanted, (), RNG).action
    assert np.abs(mine - answer).max() < 0.15 * line.habit[1].min()
    hindsight = np.zeros((2, len(EXPLANATIONS))) + np.sqrt(model.fit("line").covariance[:, :1, 0])
    line.__dict__["errors"] = hindsight  # as if foretelling had missed by what the fit leaves
    line.__dict__.pop("spread", None)
    exact = AveragedInverse(line, "mean", trust=1.0).choose(here, wanted, (), RNG).action
    assert np.abs(exact - answer).max() < 5e-3 * line.habit[1].min()
    other = AveragedInverse(line, "mean", trust=0.0).choose(here, wanted, (), RNG).action
    assert np.abs(other - answer).max() > 10 * np.abs(exact - answer).max()


def test_some_factors_ask_the_line_alone_and_the_others_everything(known) -> None:
    model, (here, wanted) = known[slack], places(slack)
    before = model.evidence.copy()
    assert model.by_line(np.array([False, False])) is model
    some = model.by_line(np.array([False, True]))
    np.testing.assert_array_equal(some.weights, [model.weights[0], np.eye(len(EXPLANATIONS))[0]])
    everything, line, both = (
        AveragedInverse(one, "mean").choose(here, wanted, (), RNG).action
        for one in (model, model.by_line(np.array([True, True])), some)
    )
    np.testing.assert_allclose(both, np.stack([everything[:, 0], line[:, 1]], 1), atol=1e-12)
    assert np.abs(everything - line).max(0).min() > 1e-3
    np.testing.assert_array_equal(model.evidence, before)  # nothing is forgotten
    assert some.moments is model.moments
