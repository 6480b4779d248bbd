"""Intervals at 95 % over agents, of means and of differences between them; an agent is one number here."""

import warnings
from typing import NamedTuple

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from babbling.axes import FloatArray
from experiments.errors import ExperimentError
from experiments.shared.judging import interval_95

LEVEL, RESAMPLES, FEWEST = 0.95, 2000, 20
"""Agents below whom a bootstrap is too narrow: bounds or t are used then."""
ROUNDING = 1e-12
"""Numbers that differ by less, as a share, are alike."""


class Estimate(NamedTuple):
    """A number and its 95 % interval."""

    value: float
    low: float
    high: float
    method: str = ""


def of_mean(
    values: FloatArray, rng: np.random.Generator, bounds: tuple[float, float] | None = None, what: str = "a mean"
) -> Estimate:
    """The mean of (n,) agents' numbers, whatever their order.

    Exact where every agent is at one of the bounds; by bootstrap over agents (BCa, Efron 1987) where they are FEWEST at
    least and not all alike; or else by `interval_95` between the bounds, by t where there are none.

    Args:
        values: one number for each agent.
        rng: of the bootstrap.
        bounds: which these numbers cannot leave.
        what: it is the mean of, for errors.

    Raises:
        ExperimentError: of fewer than two agents.
    """
    values, n = np.sort(values), len(values)
    if n < 2:
        raise ExperimentError(f"{what}: {n} infant; an interval over infants needs at least 2")
    mean, spread = float(values.mean()), float(values.std(ddof=1))
    alike = bool(np.ptp(values) <= ROUNDING * (1 + abs(mean)))
    if bounds is not None:
        low, high = bounds
        mean = float(np.clip(mean, low, high))
        extreme = bool(np.isin(values, bounds).all())
        if extreme or n < FEWEST or alike:
            first, last = interval_95(n * (mean - low) / (high - low), n)
            width, method = high - low, "exact" if extreme else "bounds"
            return Estimate(mean, low + width * first, low + width * last, method)
    if n >= FEWEST and not alike:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", stats.DegenerateDataWarning)
            found = stats.bootstrap((values,), np.mean, n_resamples=RESAMPLES, rng=rng).confidence_interval
        if np.isfinite(found).all():
            return Estimate(mean, min(float(found.low), mean), max(float(found.high), mean), "bootstrap")
    half = float(stats.t.ppf((1 + LEVEL) / 2, n - 1)) * spread / np.sqrt(n)
    return Estimate(mean, mean - half, mean + half, "t")


def apart(a: Estimate, b: Estimate) -> Estimate:
    """a - b of agents that are not the same, from the interval of each (Newcombe 1998, method 10; Zou and Donner 2008):
    it stays in [-1, 1] where both stay in [0, 1]."""
    value = a.value - b.value
    low = value - np.hypot(a.value - a.low, b.high - b.value)
    return Estimate(value, float(low), float(value + np.hypot(a.high - a.value, b.value - b.low)), "square and add")


def cohens_h(a: Estimate, b: Estimate) -> Estimate:
    """2 arcsin(sqrt(p_a)) - 2 arcsin(sqrt(p_b)) of two rates (Cohen 1988), as of agents that are not the same."""

    def turned(one: Estimate) -> Estimate:
        value, low, high = (2 * float(np.arcsin(np.sqrt(end))) for end in (one.value, one.low, one.high))
        return Estimate(value, low, high)

    return apart(turned(a), turned(b))._replace(method="Cohen's h")


def hedges_g(a: FloatArray, b: FloatArray, *, paired: bool) -> Estimate:
    """Standardised mean difference, corrected for few agents (Hedges 1981), with its exact interval by the noncentral t
    distribution, as if numbers were normal: over the pooled standard deviation of agents; where paired, over that of
    agents' own differences. NaN where no agent differs from another."""
    if paired:
        difference, degrees, scale = a - b, len(a) - 1, len(a) ** -0.5
        mean, spread = difference.mean(), difference.std(ddof=1)
    else:
        degrees, scale = len(a) + len(b) - 2, float(np.sqrt(1 / len(a) + 1 / len(b)))
        mean = a.mean() - b.mean()
        spread = np.sqrt(((len(a) - 1) * a.var(ddof=1) + (len(b) - 1) * b.var(ddof=1)) / degrees)
    name = "Hedges' g"
    if not spread > ROUNDING * (1 + abs(mean)):
        return Estimate(np.nan, np.nan, np.nan, name)
    few, t = 1 - 3 / (4 * degrees - 1), mean / spread / scale
    error = np.sqrt(1 + t**2 / (2 * degrees))
    reach = 10 * error

    def shift(tail: float) -> float:
        return float(brentq(lambda one: stats.nct.cdf(t, degrees, one) - tail, t - reach, t + reach))

    try:
        low, high = shift((1 + LEVEL) / 2), shift((1 - LEVEL) / 2)
    except ValueError:  # so far away that the distribution is nothing but its normal limit (Hedges and Olkin 1985)
        low, high = t + stats.norm.ppf([(1 - LEVEL) / 2, (1 + LEVEL) / 2]) * error
    return Estimate(float(few * scale * t), few * scale * low, few * scale * high, name)
