"""The tidy table of a battery: one row per agent, task, condition and trial; R, JASP and pandas read it.

What an agent chose among stands beside its choice, so that Eq. (1) and (2) can be fitted to it: `options`, the
`likelihood` P(outcome | state, action) or P(seen | goal) of each, and the `prior` P(action | state) or P(goal).
"""

import ast
import inspect
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from pandas.api.types import is_integer_dtype, is_numeric_dtype

from babbling.axes import FloatArray

IMITATOR = "imitator"
"""Who did it, where it was no peer."""
WHOLE = "nothing"
"""Left out of who went through all stages."""
BETWEEN = "|"
"""Between the options, likelihoods and priors of a choice."""
MOST_LISTED = 8
"""Values that a dictionary lists of a column."""


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
    """What counts: a response, or what comes of it."""
    hit: float
    """1 where it came about within the acts there is time for, 0 where not; NaN where `value` measures it."""
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


def varied(frame: pd.DataFrame) -> list[str]:
    """Columns that are no field of `Trial`: factors of the design, or whatever a stranger's table has more."""
    return [name for name in frame.columns if name not in MEANING]


def files(frame: pd.DataFrame, factors: Mapping[str, str] | None = None) -> dict[str, Callable[[Path], None]]:
    """Name -> writer of `trials.parquet`, `trials.csv` (UTF-8, RFC 4180, NaN as empty) and `dictionary.csv`.

    Args:
        frame: a tidy table.
        factors: what the columns mean that are no field of `Trial`.
    """
    return {
        "trials.parquet": lambda path: frame.to_parquet(path, index=False),
        "trials.csv": lambda path: comma(frame, path),
        "dictionary.csv": lambda path: comma(dictionary(frame, factors), path),
    }


def comma(frame: pd.DataFrame, path: Path) -> None:
    """Write a table as UTF-8 by RFC 4180, NaN as empty."""
    frame.to_csv(path, index=False, encoding="utf-8", lineterminator="\r\n", na_rep="")


def dictionary(frame: pd.DataFrame, factors: Mapping[str, str] | None = None) -> pd.DataFrame:
    """A row for every column of a table: its type, unit and meaning, and the values it has, numbers from least to
    greatest."""
    told = _meanings() | dict.fromkeys(varied(frame), "Factor of the design.") | dict(factors or {})
    rows = []
    for name in frame.columns:
        there = frame[name][frame[name].notna()]
        number, values = is_numeric_dtype(there), sorted(there.unique().tolist())
        kind = "whole number" if is_integer_dtype(there) else "number" if number else "text"
        if number and len(values) > MOST_LISTED:
            shown = f"{values[0]:g} to {values[-1]:g}"
        else:
            shown = ", ".join(map(str, values[:MOST_LISTED])) + (", ..." if len(values) > MOST_LISTED else "")
        rows.append((name, kind, "see unit" if name == "value" else "", told[name], shown))
    return pd.DataFrame(rows, columns=["column", "type", "unit", "meaning", "values"])


@cache
def _meanings() -> dict[str, str]:
    """The line under each field of `Trial`."""
    [one] = ast.parse(inspect.getsource(Trial)).body
    assert isinstance(one, ast.ClassDef)
    return {
        ast.unparse(field.target): str(line.value.value)
        for field, line in zip(one.body, one.body[1:], strict=False)
        if isinstance(field, ast.AnnAssign) and isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant)
    }
