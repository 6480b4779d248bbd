"""What came of it: errors against body time and risk, and ratios that may only be bounds."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from models.risk import Risks

RESAMPLES = 2000


class Point(NamedTuple):
    """A learner after all that it risked so far."""

    risks: Risks
    error: float
    """Root mean square of what its joints miss of the movement, degrees (mm)."""


class Reached(NamedTuple):
    """What it took one learner to be as good as somebody."""

    risks: Risks
    enough: bool
    """Whether it was; otherwise all that it had was not enough."""


def reached(points: Sequence[Point], level: float) -> Reached:
    """At the first point that is at most `level` off, or at the last."""
    for point in points:
        if point.error <= level * (1 + 1e-9):
            return Reached(point.risks, True)
    return Reached(points[-1].risks, False)


class Ratio(NamedTuple):
    """Their mean over ours, with a 95 % interval over seeds."""

    value: float | None
    """None where ours is nothing, or was not enough."""
    low: float | None
    high: float | None
    """None where there is no bound."""
    at_least: bool
    """Whether some of theirs were not enough: `value` and `low` are then least ones."""

    def __str__(self) -> str:
        if self.value is None or self.low is None:
            return "none"
        if self.high is None:
            return f"≥ {self.value:.3g} (≥ {self.low:.3g})"
        return f"{self.value:.3g} ({self.low:.3g} to {self.high:.3g})"


NONE = Ratio(None, None, None, False)


def ratio(theirs: Sequence[float], ours: Sequence[float], enough: Sequence[bool]) -> Ratio:
    """What each of some learners took over what each of ours took; seeds drawn again (theirs and ours apart) make the
    interval. A learner for whom its budget was not `enough` took at least that: then there is no upper bound."""
    mine, others, rng = np.array(ours, float), np.array(theirs, float), np.random.default_rng(0)
    drawn = [one[rng.integers(0, len(one), (RESAMPLES, len(one)))].mean(1) for one in (others, mine)]
    if not (drawn[1] > 0).all():
        return NONE
    low, high = np.quantile(drawn[0] / drawn[1], (0.025, 0.975))
    whole = all(enough)
    return Ratio(float(others.mean() / mine.mean()), float(low), float(high) if whole else None, not whole)
