"""A battery's table read again, or a stranger's of the same columns: bounded, checked, and refused in a line."""

import math
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from experiments.battery.table import MEANING
from experiments.errors import ExperimentError
from models.apart import tried
from models.errors import BodyError
from models.files import LIMIT_BYTES, raw, text
from models.tables import MOST_CELLS, MOST_COLUMNS, Table, table

NEEDED = ("agent", "task", "condition", "trial", "response")
"""Columns without which a table says nothing of choices."""
NOTHING = ("", "NA", "NaN", "nan")
"""So programs write that there is no number."""
LONGEST_NAME = 60
"""Letters."""


def read(path: Path) -> pd.DataFrame:
    """A stranger's table, `.csv` (or what else parts cells: tabs, semicolons) or `.parquet`; only NEEDED columns are.

    Columns of `Trial` have its types, but agents may be named; others are numbers if all of their cells are.

    Raises:
        BodyError: a file that cannot be read, or a cell that is no number where one belongs.
        ExperimentError: columns are missing, or a trial stands there twice.
    """
    if Path(path).suffix.lower() != ".parquet":
        return _checked(_typed(table(text(path), Path(path))), path)
    tried("experiments.battery.reading:read_parquet", Path(path), LIMIT_BYTES)  # small files may hold long columns
    return _checked(read_parquet(Path(path)), path)


def read_parquet(path: Path) -> pd.DataFrame:
    """Columns of numbers and text out of a Parquet file, nothing else that might be in it.

    Raises:
        BodyError: there is anything else, or the file is damaged.
    """
    try:
        file = pq.ParquetFile(BytesIO(raw(path)))
        rows, count = file.metadata.num_rows, file.metadata.num_columns
        if count > MOST_COLUMNS or rows * count > MOST_CELLS:
            raise BodyError(
                f"{path}: has {rows} rows of {count} cells where {MOST_CELLS} cells are read; cut it shorter"
            )
        whole = file.read(use_threads=False).replace_schema_metadata(None)
        whole.validate(full=True)
    except (pa.ArrowException, OSError, ValueError, KeyError, TypeError) as fault:
        if isinstance(fault, BodyError):
            raise
        raise BodyError(f"{path}: this is no Parquet file, or damaged ({_short(str(fault))}); make it anew") from None
    names = [str(name) for name in whole.column_names]
    if len({*names}) < len(names):
        raise BodyError(f"{path}: two columns have the same name; give each its own")
    columns: dict[str, Any] = {}
    for name, column in zip(names, whole.columns, strict=True):
        kind = column.type.value_type if pa.types.is_dictionary(column.type) else column.type
        number = pa.types.is_integer(kind) or pa.types.is_floating(kind)
        if not (number or pa.types.is_boolean(kind) or pa.types.is_string(kind) or pa.types.is_large_string(kind)):
            raise BodyError(f"{path}, {_short(name)}: holds {_short(str(kind))}; only numbers and text are read")
        columns[name] = [None if one is None else str(one) for one in column.to_pylist()]
    cells = np.array([[one or "" for one in column] for column in columns.values()], object).reshape(count, rows).T
    head = np.array(names, object).reshape(1, -1)
    return _typed(Table(path, np.arange(rows + 1), np.concatenate([head, cells])))


def _typed(found: Table) -> pd.DataFrame:
    """Cells under their names, numbers where these belong."""
    names = [_short(str(name)) for name in found.cells[0]] if len(found.cells) else []
    if missing := [name for name in NEEDED if name not in names]:
        raise ExperimentError(
            f"{found.path}: columns missing: {', '.join(missing)}; needed are {', '.join(NEEDED)}; "
            f"there are {', '.join(names[:12])}"
        )
    columns: dict[str, Any] = {}
    for place, name in enumerate(names):
        if not name or name in columns:
            if name:
                raise ExperimentError(f"{found.path}: two columns are called {name}; give each its own name")
            continue  # R's names of rows
        kind = MEANING.get(name)
        if kind is str:
            columns[name] = pd.Series(found.cells[1:, place], dtype="str")
            continue
        try:
            columns[name] = _numbers(found, place, name, whole=kind is int)
        except BodyError:
            if kind is not None and name != "agent":
                raise
            columns[name] = pd.Series(found.cells[1:, place], dtype="str")
    return pd.DataFrame(columns)


def _numbers(found: Table, place: int, name: str, *, whole: bool) -> pd.Series:
    """Of one column, NaN where it is empty."""
    there = np.concatenate([[False], ~np.isin(found.cells[1:, place], NOTHING)])
    values = np.full(len(there), math.nan)
    held = replace(found, lines=found.lines[there], cells=found.cells[there])
    if there.any():
        values[there] = held.numbers(slice(None), [place], [name])[:, 0]
    if not whole:
        return pd.Series(values[1:])
    for row in np.flatnonzero(~((values[1:] == np.rint(values[1:])) & (abs(values[1:]) < 2**53))) + 1:
        raise BodyError(f"{found.where(int(row))}, {name}: {found.cells[row, place][:30]!r} is no whole number")
    return pd.Series(values[1:].astype(np.int64))


def _checked(frame: pd.DataFrame, path: Path) -> pd.DataFrame:
    """The table, if every trial is in it once."""
    if not len(frame):
        raise ExperimentError(f"{path}: there is no row under the names of the columns; a row is a trial")
    one = [name for name in ("agent", "without", "who", "task", "condition", "trial") if name in frame]
    for row in np.flatnonzero(frame.duplicated(one))[:1]:
        told = ", ".join(f"{name} {_short(str(frame[name].iloc[row]))}" for name in one)
        raise ExperimentError(f"{path}: {told} stands there twice; number each agent's trials of a condition")
    if "hit" in frame and not frame["hit"].dropna().isin([0, 1]).all():
        raise ExperimentError(f"{path}, hit: only 0, 1 and nothing are possible")
    return frame


def _short(words: str) -> str:
    return words if len(words) <= LONGEST_NAME else words[: LONGEST_NAME - 3] + "..."
