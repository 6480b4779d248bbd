"""Opening what strangers send: looked at before it is read; tables as numbered rows of text."""

import csv
import os
from pathlib import Path

import numpy as np

from models.errors import BodyError

LIMIT_BYTES = 64 * 2**20
"""Largest file that is read; an hour of 25 joints at 50 Hz as text is about 40 MB."""


def checked(path: str | os.PathLike[str], limit_bytes: int = LIMIT_BYTES) -> Path:
    """The path of a readable, non-empty regular file of at most `limit_bytes`; looked up, not yet opened."""
    path = Path(path)
    try:
        status = path.stat()
    except FileNotFoundError:
        raise BodyError(f"{path}: there is no such file; give the path of an existing one") from None
    except (OSError, ValueError) as fault:
        raise BodyError(f"{str(path)!r}: cannot be looked up ({_reason(fault)})") from None
    if path.is_dir():
        raise BodyError(f"{path}: this is a directory; name one file in it")
    if not path.is_file():
        raise BodyError(f"{path}: this is no regular file; give the path of one")
    if status.st_size == 0:
        raise BodyError(f"{path}: is empty; make or download it again")
    if status.st_size > limit_bytes:
        raise BodyError(
            f"{path}: has {status.st_size / 2**20:,.0f} MB where at most {limit_bytes / 2**20:,.0f} MB are read; "
            "give a smaller one"
        )
    return path


def text(path: str | os.PathLike[str], limit_bytes: int = LIMIT_BYTES) -> str:
    """Whole text of a checked file (UTF-8, a byte order mark is allowed)."""
    path = checked(path, limit_bytes)
    try:
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        raise BodyError(f"{path}: is not text (byte {fault.start} is not UTF-8); give a text file") from None
    except OSError as fault:
        raise BodyError(f"{path}: cannot be read ({_reason(fault)})") from None


def table(content: str, path: Path) -> list[tuple[str, list[str]]]:
    """Rows of comma-separated text: each line's place for errors ("PATH: line 3") and its cells, stripped.

    Blank lines and comments (#) are left out. All rows have as many cells as the first, otherwise BodyError.
    """
    rows: list[tuple[str, list[str]]] = []
    for number, line in enumerate(content.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            cells = [cell.strip() for cell in next(csv.reader([line]))]
        except csv.Error as fault:
            raise BodyError(f"{path}: line {number} cannot be read ({fault})") from None
        if rows and len(cells) != len(rows[0][1]):
            width = len(rows[0][1])
            raise BodyError(f"{path}: line {number} has {len(cells)} cells where the first has {width}; mend the line")
        rows.append((f"{path}: line {number}", cells))
    return rows


def finite(cell: str, where: str) -> float:
    """The number in a cell; BodyError says `where` there is none."""
    try:
        value = float(cell)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        shown = cell if len(cell) <= 30 else cell[:27] + "..."
        raise BodyError(f"{where}: {shown!r} is not a finite number")
    return value


def _reason(fault: Exception) -> str:
    return getattr(fault, "strerror", None) or str(fault)
