"""Is theta found again? Infants of known theta choose on the sets of a table, and are fitted; and would a fitted
population choose as the real one did (posterior predictive check)?"""

from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import pandas as pd
from scipy.sparse import csr_array

from babbling.axes import FloatArray, IntArray
from experiments.battery.choices import Choices
from experiments.battery.fit import Fit, Prior, exponents, fit, summary
from experiments.shared.judging import interval_95

DRAWS, COARSE = 400, (20, 20, 16)
"""Replications; points of the grid for infants alone, whose few trials tell no more."""


@dataclass(frozen=True, eq=False)
class Recovery:
    """True theta and what was found of it, [..., 3 parameters]."""

    prior: Prior
    truth: FloatArray
    """(B, I, 3) of every infant of every recovery, each with a theta of its own."""
    found: FloatArray
    """(B, I, 3, 3) median and ends of the 95 % interval from its choices alone."""
    shared: FloatArray
    """(B, 3) of groups of infants with the same theta."""
    pooled: FloatArray
    """(B, 3, 3) from all of a group's choices."""
    trials: int

    def coverage(self) -> dict[str, dict[str, dict[str, Any]]]:
        """individual, pooled -> parameter -> share of intervals that hold the truth, its exact 95 % interval, and the
        correlation of medians with the truth, in the parameter's coordinate."""
        told: dict[str, dict[str, dict[str, Any]]] = {}
        for name, truth, found in (
            ("individual", self.truth.reshape(-1, 3), self.found.reshape(-1, 3, 3)),
            ("pooled", self.shared, self.pooled),
        ):
            told[name] = {}
            for place, one in enumerate(self.prior):
                real, (middle, low, high) = truth[:, place], found[:, place].T
                held = int(((low <= real) & (real <= high)).sum())
                told[name][one.name] = {
                    "coverage": held / len(real),
                    "interval": list(interval_95(held, len(real))),
                    "correlation": float(np.corrcoef(one.turned(real), one.turned(middle))[0, 1]),
                }
        return told


def recover(
    choices: Choices,
    prior: Prior,
    recoveries: int = 200,
    infants: int = 20,
    trials: int = 40,
    *,
    rng: np.random.Generator,
) -> Recovery:
    """Infants of theta drawn from the prior, on situations drawn from a table's rows, with replacement."""
    own = np.stack([one.drawn((recoveries, infants), rng) for one in prior], -1)
    same = np.stack([one.drawn(recoveries, rng) for one in prior], -1)
    coarse = cast(Prior, tuple(replace(one, points=at) for one, at in zip(prior, COARSE, strict=True)))
    alone = fit(simulate(choices, own.reshape(-1, 3), trials, rng=rng), coarse)
    found = np.concatenate([
        summary(replace(alone, log_likelihood=part).individual, coarse)
        for part in np.array_split(alone.log_likelihood, recoveries)
    ])  # fmt: skip
    together = fit(simulate(choices, same, infants * trials, rng=rng), prior)
    return Recovery(
        prior, own, found.reshape(recoveries, infants, 3, 3), same, summary(together.individual, prior), trials
    )


def simulate(choices: Choices, theta: FloatArray, trials: int, *, rng: np.random.Generator) -> Choices:
    """Individuals of (I, 3) theta, each in situations drawn from the rows of a table, choosing by its theta."""
    situations, first = np.unique(choices.situation, return_index=True)
    often = np.bincount(choices.situation, np.asarray(choices.counts.sum(0)).ravel())
    where = rng.choice(len(situations), (len(theta), trials), p=often / often.sum())
    chances = response_chances(choices, theta)
    begins = np.append(first, len(choices.situation))
    below = np.concatenate([np.zeros((1, len(theta))), np.cumsum(chances, 0)])  # each situation adds 1
    who = np.arange(len(theta))[:, None]
    start, end = begins[where], begins[where + 1]
    threshold = below[start, who] + rng.random(where.shape) * (below[end, who] - below[start, who])
    chosen = np.array([
        np.searchsorted(below[1:, one], threshold[one], side="right") for one in range(len(theta))
    ])  # fmt: skip
    return replace(
        choices, individuals=tuple(range(len(theta))), counts=_counted(np.clip(chosen, start, end - 1), choices)
    )


def response_chances(choices: Choices, theta: FloatArray) -> FloatArray:
    """(C, D) chance of every response in its situation, for (D, 3) theta."""
    temperature, trust, lapse = theta.T
    return np.asarray(
        lapse * choices.weight[:, None] + (1 - lapse) * choices.chances(exponents("full", temperature, trust))
    )


def _counted(chosen: IntArray, choices: Choices) -> csr_array:
    """(I, C) counts of (I, T) cells."""
    who = np.repeat(np.arange(len(chosen)), chosen.shape[1])
    return csr_array((np.ones(chosen.size), (who, chosen.ravel())), (len(chosen), len(choices.names)))


def check(
    found: Fit, posteriors: FloatArray | None = None, draws: int = DRAWS, *, rng: np.random.Generator
) -> pd.DataFrame:
    """A row for every task, condition and response: its share among all choices `observed`, and what individuals with
    theta from their `posteriors` (of a `population`; else of each alone) would do in the same situations: mean and 95 %
    of `draws` replications."""
    choices, names = (
        found.choices,
        pd.MultiIndex.from_tuples(found.choices.names, names=["task", "condition", "response"]),
    )
    groups = pd.factorize(names)
    seen = np.bincount(groups[0], np.asarray(choices.counts.sum(0)).ravel())
    again = np.zeros((draws, len(groups[1])))
    values = [one.values for one in found.prior]
    total = choices.situation.max() + 1
    for number, posterior in enumerate(found.individual if posteriors is None else posteriors):
        drawn = rng.choice(posterior.size, draws, p=posterior.ravel())
        theta = np.stack(
            [value[at] for value, at in zip(values, np.unravel_index(drawn, posterior.shape), strict=True)], -1
        )
        visits = np.bincount(choices.situation, choices.counts[[number]].toarray().ravel(), total).astype(int)
        for situation in np.flatnonzero(visits):
            cells = np.flatnonzero(choices.situation == situation)
            whole = replace(choices, cells=choices.cells[cells], situation=choices.situation[cells])
            chance = response_chances(whole, theta)
            told = rng.multinomial(visits[situation], (chance / chance.sum(0)).T)
            again[:, groups[0][cells]] += told  # the responses of a situation are different ones
    rows = pd.DataFrame(groups[1].tolist(), columns=["task", "condition", "response"])
    size = rows.assign(seen=seen).groupby(["task", "condition"])["seen"].transform("sum").to_numpy()
    low, high = np.quantile(again / size, [0.025, 0.975], axis=0)
    return rows.assign(observed=seen / size, expected=again.mean(0) / size, low=low, high=high)
