"""Opening what strangers send: looked at before it is read."""

import codecs
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
    """Whole text of a checked file: UTF-8, UTF-16 that begins with its byte order mark, or else cp1252 (Latin-1)."""
    path = checked(path, limit_bytes)
    try:
        raw = path.read_bytes()
    except OSError as fault:
        raise BodyError(f"{path}: cannot be read ({_reason(fault)})") from None
    wide = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    for encoding in ("utf-16",) if wide else ("utf-8-sig", "cp1252"):
        try:
            content = raw.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in content:
            return content
    raise BodyError(f"{path}: is not text (UTF-8, UTF-16 with its mark, or Latin-1); give a text file, best in UTF-8")


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
