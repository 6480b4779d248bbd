"""What a battery's table says of populations: rates and means, differences, and verdicts beside published infants.

The unit of analysis is the agent, by the mean over its trials: more trials tell more of an agent, not of more agents.
"""

from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from babbling.axes import FloatArray
from experiments.battery.intervals import Estimate, apart, cohens_h, hedges_g, of_mean
from experiments.battery.table import varied
from experiments.errors import ExperimentError
from experiments.shared.judging import interval_95
from models.errors import unknown

CELL = ("stage", "task", "condition", "who", "without")
MEASURES = {"hit": (0.0, 1.0), "value": None}
"""Columns that are measured, and their bounds."""
INSIDE, OUTSIDE, NOT_COMPARABLE = "inside", "outside", "not comparable"
SAME, OTHER, FEW = "same sign", "other sign", "too few to tell"


def by_agent(frame: pd.DataFrame) -> pd.DataFrame:
    """A row for every agent, cell (CELL and factors, as far as there are such columns) and measure: the `mean` over its
    trials, with the agent's `seed` where it is known."""
    cell, parts = cells(frame), []
    for measure in (one for one in MEASURES if one in frame):
        told = frame[frame[measure].notna()]
        more = {"unit": ("unit", "first")} if measure == "value" and "unit" in frame else {}
        more |= {"seed": ("seed", "first")} if "seed" in frame else {}
        found = told.groupby([*cell, "agent"], dropna=False, sort=True).agg(mean=(measure, "mean"), **more)
        parts.append(found.reset_index().assign(measure=measure))
    if not parts:
        raise ExperimentError("this table has neither a column hit nor a column value; one of them is needed")
    whole = pd.concat(parts, ignore_index=True)
    return whole.assign(unit=whole["unit"].fillna("") if "unit" in whole else "")


def cells(frame: pd.DataFrame) -> list[str]:
    """Columns that tell populations apart."""
    return [name for name in (*CELL, *varied(frame)) if name in frame]


def populations(frame: pd.DataFrame, *, rng: np.random.Generator) -> pd.DataFrame:
    """A row for every cell and measure: `n` agents, their `mean` (a rate of hits), its `low`, `high` and `method`.

    Args:
        frame: a tidy table.
        rng: of the bootstrap.

    Raises:
        ExperimentError: a cell of one agent, or nothing that was measured.
    """
    keys = [*cells(frame), "measure"]
    rows = []
    for key, agents in by_agent(frame).groupby(keys, dropna=False, sort=True):
        told = dict(zip(keys, key, strict=True))
        found = of_mean(agents["mean"].to_numpy(float), rng, MEASURES[told["measure"]], _named(told))
        rows.append({**told, "unit": agents["unit"].iloc[0], "n": len(agents), "mean": found.value,
                     "low": found.low, "high": found.high, "method": found.method})  # fmt: skip
    return pd.DataFrame(rows)


def differences(frame: pd.DataFrame, between: str, *, rng: np.random.Generator) -> pd.DataFrame:
    """A row for every two levels `a` and `b` of a column, all else the same: a - b of the means over agents (of rates
    the risk difference), its interval, and Cohen's h of rates, Hedges' g of values, with theirs.

    They are `paired` where the same agents (or else the same seeds, one agent each) are in both.

    Args:
        frame: a tidy table.
        between: `condition`, `who`, `without`, a factor.
        rng: of the bootstrap.

    Raises:
        ExperimentError: no such column, or a cell of one agent.
    """
    if between not in cells(frame):
        raise ExperimentError(unknown("column", between, cells(frame)))
    keys = [*(name for name in cells(frame) if name != between), "measure"]
    rows = []
    for key, agents in by_agent(frame).groupby(keys, dropna=False, sort=True):
        told = dict(zip(keys, key, strict=True))
        levels = {level: one for level, one in agents.groupby(between, sort=True)}
        for a, b in combinations(levels, 2):
            rows.append({**told, "between": between, "a": a, "b": b, **_difference(levels[a], levels[b], told, rng)})
    return pd.DataFrame(rows)


def _difference(a: pd.DataFrame, b: pd.DataFrame, told: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    rate, what, pairs = told["measure"] == "hit", _named(told), matched(a, b)
    first, second = (one["mean"].to_numpy(float) for one in (a, b)) if pairs is None else pairs
    bounds = MEASURES[told["measure"]]
    means = [of_mean(one, rng, bounds, what) for one in (first, second)]
    if pairs is None:
        found = apart(*means)
    else:
        found = of_mean(first - second, rng, (-1.0, 1.0) if rate else None, what)
    effect = cohens_h(*means) if rate else hedges_g(first, second, paired=pairs is not None)
    return {
        "n_a": len(first), "n_b": len(second), "paired": pairs is not None, "difference": found.value, "low": found.low,
        "high": found.high, "effect": effect.method, "size": effect.value, "size_low": effect.low,
        "size_high": effect.high,
    }  # fmt: skip


def matched(a: pd.DataFrame, b: pd.DataFrame) -> tuple[FloatArray, FloatArray] | None:
    """Means of the same agents in both, in order; None where they are not the same. Agents of the same seed are alike
    in all but what was varied."""
    for name in ("agent", "seed"):
        if name not in a or a[name].isna().any() or a[name].duplicated().any() or b[name].duplicated().any():
            continue
        if set(a[name]) == set(b[name]):
            first, second = (one.sort_values(name)["mean"].to_numpy(float) for one in (a, b))
            return first, second
    return None


class Agreement(NamedTuple):
    """A population beside published infants."""

    word: str
    """INSIDE, OUTSIDE or NOT_COMPARABLE; SAME, OTHER or FEW."""
    published: Estimate | None = None
    """Their rate and its interval."""


def beside(simulated: Estimate, rate: float | None, n: int | None) -> Agreement:
    """Whether a simulated rate lies in the exact 95 % interval of a published one of n infants; outside where both
    intervals have no rate in common, too few to tell where they have.

    Args:
        simulated: rate of hits of a population.
        rate: published share of infants, hits / n; None where only a sign was published.
        n: infants; None where it was not published.

    Raises:
        ExperimentError: a rate beyond [0, 1], or no infant.
    """
    if rate is None or n is None:
        return Agreement(NOT_COMPARABLE)
    if not 0 <= rate <= 1 or n < 1:
        raise ExperimentError(f"published rate {rate:g} of {n} infants: it must lie in [0, 1], of at least 1 infant")
    published = Estimate(rate, *interval_95(round(rate * n), n), "exact")
    if published.low <= simulated.value <= published.high:
        return Agreement(INSIDE, published)
    overlap = simulated.low <= published.high and published.low <= simulated.high
    return Agreement(FEW if overlap else OUTSIDE, published)


def sign(difference: Estimate) -> Agreement:
    """Whether a simulated difference a - b has the published sign, A > B."""
    if difference.low <= 0 <= difference.high:
        return Agreement(FEW)
    return Agreement(SAME if difference.low > 0 else OTHER)


def _named(told: dict[str, Any]) -> str:
    return ", ".join(str(told[name]) for name in told if name not in ("stage", "measure"))
