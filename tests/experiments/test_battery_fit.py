"""Fits of behaviour: the law of a choice by enumeration, its limits, and what posteriors owe to each other."""

from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from experiments.battery.choices import choices
from experiments.battery.fit import MODELS, evidence, exponents, fit, marginal, population, prior, summary
from experiments.battery.recovery import check, recover, response_chances, simulate
from experiments.battery.table import joined, parted
from experiments.errors import ExperimentError

SMALL = (7, 6, 5)


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def row(
    agent: Any, trial: int, response: str, likelihood: str = "0.6|0.1|0.3", prior: str = "0.2|0.5|0.3", **more: Any
):
    told = {"agent": agent, "task": "cup", "condition": "shown", "trial": trial, "response": response}
    return told | {"options": "lift|push|wait", "likelihood": likelihood, "prior": prior} | more


def tiny() -> pd.DataFrame:
    return pd.DataFrame([
        row("a", 0, "lift"), row("a", 1, "push"), row("a", 2, "lift", "0|0.5|0.5"), row("b", 0, "wait", prior=""),
        row("b", 1, "lift", "1|1", "0.1|0.9", options="lift|push", task="box"), row("b", 2, "lift"),
    ])  # fmt: skip


def world(infants: int, trials: int, seed: int = 0) -> pd.DataFrame:
    """Sets of two to four options, told apart by both likelihood and prior."""
    draw, rows = rng(seed), []
    for agent, trial in product(range(infants), range(trials)):
        count = int(draw.integers(2, 5))
        names = [f"act {n}" for n in range(count)]
        told = {"options": "|".join(names), "likelihood": joined(draw.dirichlet(np.full(count, 0.7))),
                "prior": joined(draw.dirichlet(np.ones(count)))}  # fmt: skip
        place = {"task": ("cup", "box")[trial % 2], "condition": "shown", "trial": trial}
        rows.append({"agent": agent, **place, "response": str(draw.choice(names)), **told})
    return pd.DataFrame(rows)


def by_hand(one: dict[str, Any], temperature: float, trust: float, lapse: float) -> float:
    """Chance of what was chosen in a row, as it is written in books."""
    names, likelihood = one["options"].split("|"), parted(one["likelihood"])
    before = parted(one["prior"]) if one["prior"] else np.ones(len(names))
    weights = [(p * q**trust) ** temperature for p, q in zip(likelihood, before, strict=True)]
    chosen = weights[names.index(one["response"])] / sum(weights)
    return lapse / len(names) + (1 - lapse) * float(chosen)


def test_the_posterior_is_bayes_rule_by_enumeration() -> None:
    frame, before = tiny(), prior(points=SMALL)
    found = fit(choices(frame), before)
    weight = np.zeros(SMALL)
    for place in np.ndindex(*SMALL):
        theta = [float(one.values[n]) for one, n in zip(before, place, strict=True)]
        weight[place] = np.prod([one.mass[n] for one, n in zip(before, place, strict=True)])
        for one in frame[frame["agent"] == "a"].to_dict("records"):
            weight[place] *= by_hand(one, *theta)
    np.testing.assert_allclose(found.individual[0], weight / weight.sum(), rtol=1e-10)
    assert found.choices.individuals == ("a", "b")
    assert evidence(found.choices, before)["full"].individual[0] == pytest.approx(np.log(weight.sum()))


@pytest.mark.parametrize("model", MODELS)
def test_evidence_of_every_model_by_enumeration(model: str) -> None:
    frame, before = tiny(), prior(points=SMALL)
    total = 0.0
    for place in np.ndindex(*SMALL):
        temperature, trust, lapse = (float(one.values[n]) for one, n in zip(before, place, strict=True))
        share = np.prod([one.mass[n] for one, n in zip(before, place, strict=True)])
        for one in frame.to_dict("records"):
            flat = joined(np.ones(len(one["options"].split("|"))))
            if model == "prior only":
                share *= by_hand(one | {"likelihood": flat}, temperature, 1, lapse)
            elif model == "full":
                share *= by_hand(one, temperature, trust, lapse)
            else:
                share *= by_hand(one, temperature, 0, 1 if model == "chance" else lapse)
        total += share
    assert evidence(choices(frame), before)[model].pooled == pytest.approx(np.log(total), abs=1e-9)


def theta(*values: float) -> np.ndarray:
    return np.array([values])


def test_limits() -> None:
    table = choices(tiny())
    chance = response_chances(table, theta(1e-9, 1, 0))[:, 0]
    np.testing.assert_allclose(chance[:3], 1 / 3, atol=1e-8)  # no temperature, no preference
    np.testing.assert_allclose(response_chances(table, theta(3, 2, 1))[:, 0], table.weight)  # a lapse is chance
    told, bare = choices(tiny()[:1]), choices(tiny()[:1].assign(prior=""))  # no trust, no prior
    np.testing.assert_allclose(response_chances(told, theta(2, 1e-9, 0.1)), response_chances(bare, theta(2, 1, 0.1)))
    best = response_chances(choices(tiny()[:1]), theta(200, 0, 0))[:, 0]
    np.testing.assert_allclose(best, [1, 0, 0], atol=1e-12)
    rule = response_chances(choices(tiny()[:1]), theta(1, 1, 0))[:, 0]
    np.testing.assert_allclose(rule, np.array([12, 5, 9]) / 26)  # Bayes' rule
    none = choices(pd.DataFrame([row(0, 0, "lift", "0|0|0")]))
    np.testing.assert_allclose(response_chances(none, theta(1, 1, 0)), 1 / 3)  # nothing is possible: anything is
    assert exponents("prior only", np.array(2.0), np.array(0.5)).tolist() == [0, 2]


def test_chances_of_a_situation_sum_to_one() -> None:
    table = choices(world(3, 20))
    told = response_chances(table, np.stack([one.drawn(50, rng()) for one in prior()], -1))
    sums = np.array([told[table.situation == one].sum(0) for one in np.unique(table.situation)])
    np.testing.assert_allclose(sums, 1)


def test_all_together_are_the_product_of_each_in_any_order() -> None:
    frame, before = world(5, 12), prior(points=SMALL)
    found = fit(choices(frame), before)
    product_ = np.exp((np.log(found.individual) - found.log_prior).sum(0) + found.log_prior)
    np.testing.assert_allclose(found.pooled[0], product_ / product_.sum(), rtol=1e-8)
    mixed = fit(choices(frame.sample(frac=1, random_state=1)), before)
    np.testing.assert_allclose(mixed.pooled, found.pooled, rtol=1e-9)
    order = [mixed.choices.individuals.index(one) for one in found.choices.individuals]
    np.testing.assert_allclose(mixed.individual[order], found.individual, rtol=1e-9)


def test_intervals_are_quantiles_of_the_posterior_however_coarse_the_grid() -> None:
    frame = world(6, 30, seed=3)
    coarse, fine = (fit(choices(frame), prior(points=points)) for points in ((16, 16, 12), (36, 36, 27)))
    one, two = (summary(found.pooled, found.prior)[0] for found in (coarse, fine))
    turned = [parameter.turned for parameter in fine.prior]
    for place in range(3):
        width = np.ptp(turned[place](two[place]))
        assert np.abs(turned[place](one[place]) - turned[place](two[place])).max() < 0.03 * width
    middle, low, high = two.T
    assert (low < middle).all() and (middle < high).all() and 0 <= low[2] and high[2] <= 1
    share = marginal(fine.pooled, 0)[0]
    inside = (fine.prior[0].values > low[0]) & (fine.prior[0].values < high[0])
    assert share[inside].sum() == pytest.approx(0.95, abs=0.04)


def test_without_choices_that_tell_anything_the_prior_stays() -> None:
    told = pd.DataFrame([row(0, trial, "lift", "1|1|1", "1|1|1") for trial in range(9)])
    before = prior(spread=0.5, lapse=0.2)
    for place, (middle, low, high) in enumerate(summary(fit(choices(told), before).individual, before)[0]):
        expected = before[place].distribution.ppf([0.5, 0.025, 0.975])
        assert [middle, low, high] == pytest.approx(list(expected), rel=0.03, abs=0.001)
    assert before[2].mass.sum() == pytest.approx(1) and stats.beta(1, 4).mean() == 0.2


def test_a_strangers_choice_is_averaged_over_the_sets_of_simulated_agents() -> None:
    reference = tiny()
    stranger = pd.DataFrame([{"agent": "P1", "task": "cup", "condition": "shown", "trial": 0, "response": "lift"}])
    more = pd.concat([stranger, stranger.assign(trial=1, task="nothing of the kind")])
    table = choices(more, reference)
    assert table.left_out == 1 and table.individuals == ("P1",)
    sets = reference[reference["task"] == "cup"].assign(response="lift").to_dict("records")
    for values in ((1.0, 1.0, 0.0), (2.0, 0.5, 0.1), (0.3, 2.0, 0.3)):
        expected = np.mean([by_hand(one, *values) for one in sets])
        chance = response_chances(table, theta(*values))
        assert chance[table.names.index(("cup", "shown", "lift")), 0] == pytest.approx(expected)
    peers = pd.concat([reference.assign(who="imitator"), reference.assign(who="peer", likelihood="", options="")])
    own = choices(stranger, peers, who="imitator")
    np.testing.assert_allclose(response_chances(own, theta(2, 1, 0)), response_chances(table, theta(2, 1, 0)))


HOSTILE = {
    "no options": ({"options": "", "likelihood": ""}, "no row has options and likelihoods"),
    "one option": ({"options": "lift", "likelihood": "1"}, "1 options; 2 to 1000"),
    "twice": ({"options": "lift|push|lift"}, "of different names"),
    "words": ({"likelihood": "much|little|0"}, "likelihood 'much|little|0': it must be 3 numbers"),
    "too few": ({"prior": "0.5|0.5"}, "prior '0.5|0.5': it must be 3 numbers"),
    "negative": ({"likelihood": "1|-1|0"}, "numbers of 0 or more"),
    "endless": ({"likelihood": "1|inf|0"}, "numbers of 0 or more"),
    "none": ({"likelihood": "1|nan|0"}, "numbers of 0 or more"),
    "response": ({"response": "lifts"}, "unknown response 'lifts'; there are lift, push, wait; did you mean 'lift'"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_no_choice_is_a_line(name: str) -> None:
    changed, said = HOSTILE[name]
    with pytest.raises(ExperimentError) as caught:
        choices(pd.DataFrame([row("P1", 0, "lift") | changed]))
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_a_population_is_found_and_draws_its_individuals_to_itself() -> None:
    table, before = choices(world(2, 30)), prior(points=(24, 16, 12))
    truth = np.stack([np.exp(rng(1).normal(0.7, 0.15, 60)), np.full(60, 1.0), np.full(60, 0.05)], -1)
    found = fit(simulate(table, truth, 40, rng=rng(2)), before)
    told = population(found)
    assert told.mean[0] == pytest.approx(0.7, abs=0.15) and told.sd[0] < 0.35
    alone, drawn = (summary(one, before)[:, 0] for one in (found.individual, told.posterior))
    assert np.ptp(drawn[:, 0]) < 0.7 * np.ptp(alone[:, 0])
    assert np.mean((np.log(drawn[:, 0]) - np.log(truth[:, 0])) ** 2) < np.mean(
        (np.log(alone[:, 0]) - np.log(truth[:, 0])) ** 2
    )


def test_theta_is_found_again_as_often_as_intervals_say() -> None:
    found = recover(choices(world(5, 40)), prior(), 100, infants=20, trials=40, rng=rng(4))
    told = found.coverage()
    for name, each in told["individual"].items():
        assert 0.93 <= each["coverage"] <= 0.97, name
    for name, each in told["pooled"].items():
        assert each["interval"][0] <= 0.95 <= each["interval"][1], name
        assert each["correlation"] > 0.75
    assert found.truth.shape == (100, 20, 3) and told["pooled"]["temperature"]["correlation"] > 0.97


def test_what_is_simulated_is_chosen_as_often_as_it_should_be() -> None:
    table, values = choices(tiny()), np.array([[1.5, 0.8, 0.1]])
    many = simulate(table, values, 60_000, rng=rng(5))
    visits = np.bincount(table.situation, np.asarray(table.counts.sum(0)).ravel())
    share = visits[table.situation] / visits.sum() * response_chances(table, values)[:, 0]
    np.testing.assert_allclose(np.asarray(many.counts.sum(0)).ravel() / 60_000, share, atol=0.006)


def test_a_population_that_the_law_describes_passes_the_check_and_another_does_not() -> None:
    table, before = choices(world(2, 10)), prior(points=(20, 16, 12))
    lawful = simulate(table, np.tile([[1.5, 1.0, 0.05]], (30, 1)), 40, rng=rng(6))
    rows = check(fit(lawful, before), draws=200, rng=rng(7))
    assert ((rows["low"] <= rows["observed"]) & (rows["observed"] <= rows["high"])).all()
    assert rows.groupby("task")[["observed", "expected"]].sum().to_numpy() == pytest.approx(1)
    stubborn = world(30, 20).assign(response="act 0")
    rows = check(fit(choices(stubborn), before), draws=200, rng=rng(8))
    assert not ((rows["low"] <= rows["observed"]) & (rows["observed"] <= rows["high"])).all()
