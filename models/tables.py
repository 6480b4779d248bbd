"""Tables in text as spreadsheets, MATLAB, R and pandas write them: cells, and where each of them stands."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from io import StringIO
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models import files
from models.arrays import FloatArray, IntArray
from models.errors import BodyError

MOST_COLUMNS, MOST_ROWS, MOST_CELLS = 2000, 1_000_000, 5_000_000
"""An hour of 25 joints at 50 Hz has 4.7 million cells."""
LONGEST_LINE = 1 << 16
"""Characters; 2000 columns of 32."""
QUOTED = re.compile(r'"[^"]*"')
DECIMAL_COMMA = r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?"


@dataclass(frozen=True, eq=False)
class Table:
    """Cells (R, C), text without space around it, row by row; lines (R,): the line of the file in which each stands."""

    path: Path
    lines: IntArray
    cells: NDArray[np.object_]

    def where(self, row: int) -> str:
        """Place of a row, for errors."""
        return f"{self.path}: line {self.lines[row]}"

    def numbers(self, rows: slice, columns: Sequence[int], called: Sequence[str]) -> FloatArray:
        """The numbers in some rows and columns, `called` so in errors; with decimal commas where they have no point.

        Raises:
            BodyError: a cell that is no finite number (which, and what stands there).
        """
        import pandas  # takes a second to load

        cells = self.cells[rows][:, columns]
        flat = pandas.Series(cells.ravel(), dtype=object)
        if flat.str.fullmatch(DECIMAL_COMMA).any() and not flat.str.contains(".", regex=False).any():
            flat = flat.str.replace(",", ".")
        values = pandas.to_numeric(flat, errors="coerce").to_numpy(float).reshape(cells.shape)
        for row, column in np.argwhere(~np.isfinite(values))[:1]:
            cell = cells[row, column] if len(cells[row, column]) <= 30 else cells[row, column][:27] + "..."
            place = self.where(range(len(self.lines))[rows][row])
            raise BodyError(f"{place}, {called[column]}: {cell!r} is not a finite number")
        exact = flat.to_numpy(object).astype(float)  # to_numeric is from pandas 3 on
        return np.asarray(exact.reshape(cells.shape), float)


def table(content: str, path: Path) -> Table:
    """Rows of text whose cells are parted by tabs, semicolons, commas or, where the first line has none, by spaces.

    Blank lines, comments (#) and what is empty at the end of lines are left out. Where the first line has one name less
    than the others have cells, the first column has none (as R writes names of rows).

    Raises:
        BodyError: lines of unlike lengths, too long ones or too many columns, quotes that do not close.
    """
    import pandas

    rows = (one for one in files.lines(path, content) if not one[1].lstrip(' \t"').startswith("#"))
    kept = list(islice(rows, MOST_ROWS + 1))
    if len(kept) > MOST_ROWS:
        raise BodyError(f"{path}: has more than {MOST_ROWS} rows; cut it shorter")
    for number, line in kept:
        if len(line) > LONGEST_LINE:
            raise BodyError(f"{path}: line {number} has {len(line)} characters where at most {LONGEST_LINE} are read")
        if line.count('"') % 2:
            raise BodyError(f"{path}: line {number}: a quoted cell does not end there; take the line break out of it")
    told = re.fullmatch(r'\s*"?sep=(.)"?\s*', kept[0][1]) if kept else None  # Excel's own
    kept = kept[1:] if told else kept
    if not kept:
        return Table(path, np.zeros(0, int), np.empty((0, 0), object))
    bare = QUOTED.sub("q", kept[0][1].strip())
    sep = told[1] if told else next((one for one in "\t;," if one in bare), " " if " " in bare else ",")
    if sep == " ":
        kept = [(number, "\t".join(re.findall(r'"[^"]*"|\S+', line))) for number, line in kept]
        sep = "\t"
    counts = np.array([(QUOTED.sub("q", line) if '"' in line else line).count(sep) + 1 for _, line in kept])
    if counts.sum() > MOST_CELLS:
        raise BodyError(f"{path}: has {counts.sum()} cells where at most {MOST_CELLS} are read; cut it shorter")
    if counts.max() > MOST_COLUMNS:
        raise BodyError(
            f"{path}: line {kept[counts.argmax()][0]} has {counts.max()} cells where at most {MOST_COLUMNS} are read"
        )
    lines = [line for _, line in kept]
    lines[0] += sep * int(counts.max() - counts[0])
    try:
        frame = pandas.read_csv(
            StringIO("\n".join(lines)), sep=sep, header=None, dtype=str, na_filter=False, skip_blank_lines=False
        )
        cells = np.stack([frame[column].str.strip().to_numpy(object) for column in frame], 1)
    except (pandas.errors.ParserError, ValueError) as fault:
        raise BodyError(f"{path}: cannot be read as a table ({' '.join(str(fault).split())[:100]})") from None
    if len(cells) != len(kept):
        raise BodyError(
            f"{path}: a quote stands inside a cell, so that lines run together; put quotes around whole cells"
        )
    filled = cells != ""
    for row in np.flatnonzero((filled & (np.arange(cells.shape[1]) >= counts[:, None])).any(1)):
        raise BodyError(f"{path}: line {kept[row][0]}: a quote stands inside a cell; put quotes around whole cells")
    tally = np.bincount(counts)
    usual = int(counts[0] if tally[counts[0]] == tally.max() else tally.argmax())
    usual = min(usual, int(filled.any(0).nonzero()[0].max(initial=0)) + 1)
    nameless = counts[0] == usual - 1 and not re.match(r"[+-]?[\d.]", cells[0, 0])
    if nameless:
        cells[0, 1:usual] = cells[0, : usual - 1]
        cells[0, 0] = ""
    for row in np.flatnonzero(filled.any(1) & ((counts < usual) | filled[:, usual:].any(1)))[int(nameless) :]:
        raise BodyError(f"{path}: line {kept[row][0]} has {counts[row]} cells where most have {usual}; mend the line")
    there = filled.any(1)
    return Table(path, np.array([number for number, _ in kept])[there], cells[there, :usual])
