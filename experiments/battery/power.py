"""How many infants a study of two groups needs: studies are drawn from simulated agents, each an infant once a draw."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from scipy import stats

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.errors import ExperimentError
from experiments.shared.figures import STYLES, captioned
from experiments.shared.palette import PLAIN

ALPHA, ENOUGH = 0.05, 0.8
NS = tuple(range(8, 129, 8))
"""Infants of each group."""


@dataclass(frozen=True, eq=False)
class Power:
    """Share of studies that were significant, two-sided at ALPHA."""

    name: str
    """What is compared."""
    test: str
    ns: tuple[int, ...]
    hits: IntArray
    """(N,) of `repeats` studies of n infants a group."""
    repeats: int

    @property
    def share(self) -> FloatArray:
        """(N,) power."""
        return np.asarray(self.hits / self.repeats)

    @property
    def interval(self) -> FloatArray:
        """(N, 2) Monte Carlo, 95 % (Wilson 1927): how well the power is known for these agents, not for others."""
        found = [stats.binomtest(int(one), self.repeats).proportion_ci(0.95, "wilson") for one in self.hits]
        return np.array([[one.low, one.high] for one in found])

    @property
    def enough(self) -> int | None:
        """The least n from which on power is at least ENOUGH for all n looked at; None where there is none."""
        short = np.flatnonzero(self.share < ENOUGH)
        after = 0 if not len(short) else int(short[-1]) + 1
        return self.ns[after] if after < len(self.ns) else None


def power(
    a: FloatArray,
    b: FloatArray,
    ns: Sequence[int] = NS,
    repeats: int = 1000,
    *,
    name: str = "",
    rng: np.random.Generator,
) -> Power:
    """Draw studies of n infants a group from two groups of agents, with replacement.

    Fisher's exact test where every agent is 0 or 1, a rate of single trials; Welch's t test of agents' means else.

    Args:
        a: a number for each agent of one condition.
        b: of the other; groups are different infants even where these are the same agents.
        ns: infants a group.
        repeats: studies of each n.
        name: of the comparison.
        rng: draws them.

    Raises:
        ExperimentError: fewer than two agents, or a study of fewer than two infants a group.
    """
    for agents in (len(a), len(b), *ns):
        if agents < 2:
            raise ExperimentError(f"power{f' of {name}' * bool(name)}: {agents} in a group; at least 2 are needed")
    rate = bool(np.isin(np.concatenate([a, b]), (0, 1)).all())
    hits = []
    for n in ns:
        first, second = (np.asarray(one)[rng.integers(0, len(one), (repeats, n))] for one in (a, b))
        hits.append(fisher(first.sum(1).astype(int), second.sum(1).astype(int), n) if rate else welch(first, second))
    test = "Fisher's exact test" if rate else "Welch's t test"
    return Power(name, test, tuple(ns), np.array([one.sum() for one in hits]), repeats)


def fisher(a: IntArray, b: IntArray, n: int) -> BoolArray:
    """(B,) whether hits a and b, of n each, differ significantly."""
    pairs, which = np.unique(np.sort(np.stack([a, b], -1), -1), axis=0, return_inverse=True)
    sure = [stats.fisher_exact([[k, n - k], [m, n - m]]).pvalue < ALPHA for k, m in pairs]
    return np.asarray(sure)[which.reshape(-1)]


def welch(a: FloatArray, b: FloatArray) -> BoolArray:
    """(B,) whether means of (B, n) numbers differ significantly; where nobody differs within either group, whether the
    groups do."""
    alike = (np.ptp(a, axis=1) == 0) & (np.ptp(b, axis=1) == 0)
    sure = np.zeros(len(a), bool)
    sure[alike] = a[alike, 0] != b[alike, 0]
    if not alike.all():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # SciPy's, where agents hardly differ
            sure[~alike] = stats.ttest_ind(a[~alike], b[~alike], axis=1, equal_var=False).pvalue < ALPHA
    return sure


@captioned(
    "How often a study of so many infants a group would find the difference between two conditions, if infants were "
    "these agents. Bands are 95 % Monte Carlo intervals over studies; marks at the foot: the infants that are enough."
)
def power_figure(found: Sequence[Power]) -> Figure:
    """Power against infants a group, a line a comparison."""
    figure = Figure(figsize=(6.5, 4.4), layout="constrained")
    axes = figure.subplots()
    for number, one in enumerate(found):
        mark, ink = STYLES[number % len(STYLES)]
        need = f"{one.enough} infants a group" if one.enough else f"more than {one.ns[-1]} a group"
        axes.plot(one.ns, one.share, mark, color=ink, ms=4, label=f"{one.name}: {need} ({one.test})")
        axes.fill_between(one.ns, *one.interval.T, color=ink, alpha=0.2, lw=0)
        if one.enough:
            axes.plot([one.enough] * 2, [0, ENOUGH], color=ink, lw=1, ls=":")
    axes.axhline(ENOUGH, color=PLAIN, lw=1, ls="--")
    axes.axhline(ALPHA, color=PLAIN, lw=0.8, ls=":")
    axes.set(xlabel="infants a group", ylabel=f"share significant at {ALPHA:g}", ylim=(0, 1.03))
    axes.set_title(f"Power; {ENOUGH:.0%} is enough", loc="left", fontsize=11)
    axes.grid(alpha=0.25)
    figure.legend(loc="outside lower center", frameon=False, fontsize=9)
    return figure
