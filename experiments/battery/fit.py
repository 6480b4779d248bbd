"""Bayesian fits of behaviour: how strictly, with how much habit and how attentively an individual follows Eq. (1), (2).

theta = temperature (1 is probability matching, more is choosing the best), trust in the prior (1 is Bayes' rule, 0 is
the likelihood alone) and lapse (the share of choices that mean nothing). Posteriors are sums over a grid, in
coordinates in which they are about normal; marginals are read off splines through their logs.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy import stats
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline
from scipy.special import logsumexp, softmax

from babbling.axes import FloatArray
from experiments.battery.choices import Choices

MODELS = ("full", "likelihood only", "prior only", "chance")
TAIL, FINE, LEAST = 1e-3, 16, -600.0
"""Of the prior, beyond the grid on either side; points between two of the grid; the least log density that is told from
nothing."""
ENDS = (0.5, 0.025, 0.975)
ROUNDS = 200


@dataclass(frozen=True, eq=False)
class Parameter:
    """One of theta: its prior, and its grid."""

    name: str
    distribution: Any
    """Prior, a frozen distribution of SciPy."""
    turned: Callable[[FloatArray], FloatArray]
    """Value -> coordinate."""
    back: Callable[[FloatArray], FloatArray]
    points: int

    @cached_property
    def edges(self) -> FloatArray:
        """(points + 1,) coordinates between cells of the grid, evenly spaced; the prior ends there."""
        low, high = self.turned(np.asarray(self.distribution.ppf([TAIL, 1 - TAIL])))
        return np.linspace(low, high, self.points + 1)

    @cached_property
    def grid(self) -> FloatArray:
        """(points,) coordinates of the middle of each cell."""
        return np.asarray((self.edges[1:] + self.edges[:-1]) / 2)

    @cached_property
    def values(self) -> FloatArray:
        """(points,)."""
        return self.back(self.grid)

    @cached_property
    def mass(self) -> FloatArray:
        """(points,) prior of each cell."""
        return np.asarray(np.diff(self.distribution.cdf(self.back(self.edges))) / (1 - 2 * TAIL))

    def drawn(self, count: int | tuple[int, ...], rng: np.random.Generator) -> FloatArray:
        """Values from the prior."""
        return np.asarray(self.distribution.ppf(rng.uniform(TAIL, 1 - TAIL, count)))


Prior = tuple[Parameter, Parameter, Parameter]


def prior(spread: float = 0.75, lapse: float = 0.1, points: tuple[int, int, int] = (32, 32, 24)) -> Prior:
    """Temperature and trust are lognormal about 1, where Eq. (1) is matched; lapse is Beta(1, 1 / lapse - 1).

    Args:
        spread: standard deviation of the logarithms.
        lapse: mean.
        points: of the grid: temperature, trust, lapse.
    """
    lognormal, beta = stats.lognorm(spread), stats.beta(1, 1 / lapse - 1)
    return (
        Parameter("temperature", lognormal, np.log, np.exp, points[0]),
        Parameter("trust", lognormal, np.log, np.exp, points[1]),
        Parameter("lapse", beta, lambda value: np.arcsin(np.sqrt(value)), lambda turn: np.sin(turn) ** 2, points[2]),
    )


def exponents(model: str, temperature: FloatArray, trust: FloatArray) -> FloatArray:
    """(..., 2) exponents of likelihood and prior under one of MODELS; of `prior only` temperature is the prior's."""
    full = {"full": (1.0, trust), "likelihood only": (1.0, 0 * trust), "prior only": (0.0, 1 + 0 * trust)}
    likelihood, before = full.get(model, (0.0, 0 * trust))
    return np.stack(np.broadcast_arrays(temperature * likelihood, temperature * before), -1)


@dataclass(frozen=True, eq=False)
class Fit:
    """Of every individual, and of all together as one."""

    choices: Choices
    prior: Prior
    log_likelihood: FloatArray
    """(I, temperatures, trusts, lapses) log P(choices of each | theta)."""

    @cached_property
    def log_prior(self) -> FloatArray:
        """(temperatures, trusts, lapses)."""
        first, second, third = (np.log(one.mass) for one in self.prior)
        return np.asarray(first[:, None, None] + second[:, None] + third)

    @cached_property
    def individual(self) -> FloatArray:
        """(I, temperatures, trusts, lapses) posterior of each alone; sums to 1."""
        return posterior(self.log_likelihood + self.log_prior)

    @cached_property
    def pooled(self) -> FloatArray:
        """(1, temperatures, trusts, lapses) posterior of all, if theta is the same for all."""
        return posterior(self.log_likelihood.sum(0, keepdims=True) + self.log_prior)


def fit(choices: Choices, prior: Prior) -> Fit:
    """The likelihood on the grid."""
    temperature, trust, lapse = (one.values for one in prior)
    found = choices.log_likelihood(exponents("full", temperature[:, None], trust[None]).reshape(-1, 2), lapse)
    return Fit(choices, prior, found.reshape(-1, *(one.points for one in prior)))


def posterior(logs: FloatArray) -> FloatArray:
    """(M, ...) normalised exp of (M, ...) logs."""
    return np.asarray(softmax(logs.reshape(len(logs), -1), axis=1).reshape(logs.shape))


def marginal(found: FloatArray, place: int) -> FloatArray:
    """(M, points) of one parameter, out of (M, temperatures, trusts, lapses)."""
    others = tuple(axis for axis in (1, 2, 3) if axis != place + 1)
    return np.asarray(found.sum(others))


def summary(found: FloatArray, prior: Prior) -> FloatArray:
    """(M, 3 parameters, 3) median and ends of the 95 % credible interval, out of (M, ...) posteriors."""
    told = np.empty((len(found), 3, len(ENDS)))
    for place, one in enumerate(prior):
        logs = np.log(np.maximum(marginal(found, place), np.exp(LEAST)))
        fine = np.linspace(one.edges[0], one.edges[-1], FINE * one.points + 1)
        shape = CubicSpline(one.grid, logs, axis=1)(fine)
        below = cumulative_trapezoid(np.exp(shape - shape.max(1, keepdims=True)), fine, axis=1, initial=0)
        for row, cumulative in enumerate(below):
            told[row, place] = one.back(np.interp(ENDS, cumulative / cumulative[-1], fine))
    return told


class Population(NamedTuple):
    """Individuals as draws from one population: normal in coordinates, parameters independent of each other."""

    mean: FloatArray
    """(3,) coordinates."""
    sd: FloatArray
    """(3,)."""
    posterior: FloatArray
    """(I, ...) of each individual, with this population as its prior."""


def population(found: Fit) -> Population:
    """Empirical Bayes: mean and spread of the population by maximum marginal likelihood (EM on the grid, from the
    prior on). What is left uncertain about them is not in the individuals' posteriors."""
    grids = [one.grid for one in found.prior]
    mean = np.array([one.mass @ grid for one, grid in zip(found.prior, grids, strict=True)])
    sd = np.array([
        np.sqrt(one.mass @ (grid - m) ** 2) for one, grid, m in zip(found.prior, grids, mean, strict=True)
    ])  # fmt: skip
    least = np.array([one.edges[1] - one.edges[0] for one in found.prior]) / 2  # finer is not seen on the grid
    likelihood = np.exp(found.log_likelihood - found.log_likelihood.max((1, 2, 3), keepdims=True))
    for _ in range(ROUNDS):
        before = mean, sd
        a, b, c = (np.exp(-0.5 * ((grid - m) / s) ** 2) for grid, m, s in zip(grids, mean, sd, strict=True))
        whole = likelihood * a[:, None, None] * b[:, None] * c
        whole /= whole.sum((1, 2, 3), keepdims=True)
        shares = [marginal(whole, place).mean(0) for place in range(3)]
        mean = np.array([share @ grid for share, grid in zip(shares, grids, strict=True)])
        wide = [share @ (grid - m) ** 2 for share, grid, m in zip(shares, grids, mean, strict=True)]
        sd = np.maximum(np.sqrt(wide), least)
        if np.allclose(before, (mean, sd), rtol=0, atol=1e-4):
            break
    return Population(mean, sd, whole)


class Evidence(NamedTuple):
    """log P(choices | model), natural; theta is summed over its prior."""

    individual: FloatArray
    """(I,) each with a theta of its own."""
    pooled: float
    """All with the same."""


def evidence(choices: Choices, prior: Prior) -> dict[str, Evidence]:
    """Of every one of MODELS, under the same prior as far as it has these parameters."""
    temperature, trust, lapse = prior
    found = {}
    for model in MODELS:
        trusts = trust if model == "full" else None
        one = np.ones(1)
        temperatures, t = (one, np.zeros(1)) if model == "chance" else (temperature.values, np.log(temperature.mass))
        values, u = (one, np.zeros(1)) if trusts is None else (trusts.values, np.log(trusts.mass))
        logs = choices.log_likelihood(
            exponents(model, temperatures[:, None], values[None]).reshape(-1, 2), lapse.values
        )
        before = ((t[:, None] + u).reshape(-1, 1) + np.log(lapse.mass)).ravel()
        logs = logs.reshape(len(logs), -1)
        alone, pooled = logsumexp(logs + before, axis=1), logsumexp(logs.sum(0) + before)
        found[model] = Evidence(np.asarray(alone), float(pooled))
    return found
