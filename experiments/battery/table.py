"""The tidy table of a battery: one row per agent, task, condition and trial; R, JASP and pandas read it.

What an agent chose among stands beside its choice, so that Eq. (1) and (2) can be fitted to it: `options`, the
`likelihood` P(outcome | state, action) or P(seen | goal) of each, and the `prior` P(action | state) or P(goal).
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import pandas as pd

from babbling.axes import FloatArray

IMITATOR = "imitator"
"""Who did it, where it was no peer."""
WHOLE = "nothing"
"""Left out of who went through all stages."""
BETWEEN = "|"
"""Between the options, likelihoods and priors of a choice."""


@dataclass(frozen=True)
class Trial:
    """One row; what does not apply is empty, NaN in numbers."""

    agent: int
    """Number of the agent, from 0; its design and seed follow from it."""
    seed: int
    """The agent's own."""
    without: str
    """What was left out of its life, an ablation; `nothing` for a whole one."""
    who: str
    """`imitator`, or the peer that has the same body and saw the same."""
    stage: int
    """Of the chapter's four: 1 body babbling, 2 movements, 3 acts on objects, 4 intentions."""
    task: str
    """What it was given to do."""
    condition: str
    """How it was shown."""
    trial: int
    """Number within agent, task and condition, from 0."""
    response: str
    """What was done or chosen, in a word; one of `options` where there are some."""
    target: str
    """Response that counts."""
    hit: float
    """1 where it counts, 0 where not; NaN where `value` measures it."""
    value: float = math.nan
    """A measure, e.g. an error."""
    unit: str = ""
    """Of the value."""
    options: str = ""
    """Responses that were possible, joined by `|`."""
    likelihood: str = ""
    """Of each of them, what it would lead to or what would be seen: P(s' | s, a) of Eq. (1), P(seen | g) of Eq. (2)."""
    prior: str = ""
    """Of each of them: P(a | s) of Eq. (1), P(g) of Eq. (2)."""


MEANING = {one.name: one.type for one in fields(Trial)}
"""Columns in order; factors of the design stand between `without` and `who`."""


def joined(values: Sequence[Any] | FloatArray) -> str:
    """Names or numbers in one cell; numbers of six digits."""
    return BETWEEN.join(one if isinstance(one, str) else f"{float(one):.6g}" for one in values)


def parted(cell: str) -> FloatArray:
    """Numbers out of a cell.

    Raises:
        ValueError: what is no number.
    """
    return np.array([float(one) for one in cell.split(BETWEEN)]) if cell else np.zeros(0)


def tidy(trials: Iterable[Trial], factors: dict[int, dict[str, float | str]] | None = None) -> pd.DataFrame:
    """Rows in order of agent, task, condition, who and trial, whoever finished first.

    Args:
        trials: all of them.
        factors: by agent, the values of what was varied.
    """
    rows = pd.DataFrame([vars(one) for one in trials], columns=list(MEANING))
    varied = list(next(iter(factors.values()))) if factors else []
    place = list(MEANING).index("who")
    for number, name in enumerate(varied):
        assert factors is not None
        rows.insert(place + number, name, [factors[int(agent)][name] for agent in rows["agent"]])
    return rows.sort_values(["agent", "stage", "task", "condition", "who", "trial"], kind="stable", ignore_index=True)
