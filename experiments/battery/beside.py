"""Populations of agents beside infants: each published row, the agents' rate with its interval, and a verdict."""

from typing import NamedTuple

import numpy as np
import pandas as pd

from experiments.battery.effects import FEW, OTHER, SAME, Agreement, beside, sign
from experiments.battery.infants import RATES, SIGNS, Cell, Rate, Sign
from experiments.battery.intervals import FEWEST, Estimate, apart, of_mean
from experiments.battery.table import IMITATOR, WHOLE
from experiments.gaze.covered import MARGIN


class Row(NamedTuple):
    """One published row and what agents do."""

    published: Rate | Sign
    simulated: Estimate | None
    """Rate, or difference; None where no agent was shown it."""
    agents: int
    verdict: Agreement


def rows(frame: pd.DataFrame, rng: np.random.Generator) -> list[Row]:
    """Every row that there is, whole lives alone, whatever was varied."""
    whole = frame[(frame["who"] == IMITATOR) & (frame["without"] == WHOLE)]
    return [*(_rate(whole, one, rng) for one in RATES), *(_sign(whole, one, rng) for one in SIGNS)]


def of(frame: pd.DataFrame, cell: Cell) -> pd.Series:
    """Each agent's share of hits, by agent."""
    there = (frame["task"] == cell.task) & (frame["condition"] == cell.condition)
    if cell.target:
        there &= frame["target"].astype(str).str.startswith(cell.target)
    return frame[there].groupby("agent")["hit"].mean()


def _rate(frame: pd.DataFrame, one: Rate, rng: np.random.Generator) -> Row:
    shares = of(frame, one.cell).to_numpy(float)
    if len(shares) < 2:
        return Row(one, None, len(shares), Agreement("not shown"))
    found = of_mean(shares, rng, (0.0, 1.0), str(one.cell))
    return Row(one, found, len(shares), beside(found, one.share, one.n))


def _sign(frame: pd.DataFrame, one: Sign, rng: np.random.Generator) -> Row:
    pair = pd.concat([of(frame, one.more), of(frame, one.less)], axis=1, join="inner").to_numpy(float)
    if len(pair) < 2:
        return Row(one, None, len(pair), Agreement("not shown"))
    more, less = pair.T
    if len(pair) < FEWEST or np.ptp(more - less) == 0:  # too few, or too alike, to draw again from
        found = apart(*(of_mean(one, rng, (0.0, 1.0)) for one in (more, less)))
    else:
        found = of_mean(more - less, rng, (-1.0, 1.0))
    return Row(one, found, len(pair), sign(found) if one.relation == ">" else Agreement(_alike(found)))


def _alike(difference: Estimate) -> str:
    """Where no difference was published: whether agents' is within what such studies could not have told from none."""
    if not difference.low <= 0 <= difference.high:
        return OTHER
    return SAME if -MARGIN < difference.low and difference.high < MARGIN else FEW
