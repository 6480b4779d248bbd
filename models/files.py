"""The door: every file that a user names is opened here, and nowhere else; looked at before it is read."""

import codecs
import os
import re
import stat
from collections.abc import Iterator
from io import FileIO
from pathlib import Path

from models.errors import BodyError

LIMIT_BYTES = 64 * 2**20
"""Largest file that is read; an hour of 25 joints at 50 Hz as text is about 40 MB."""
MOST_LINES = 4_000_000
"""100 000 frames of 31 lines, as motion capture has them, are fewer."""
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
LARGEST = 1e9
"""No number that means anything in a movement is larger."""
_FLAGS = os.O_RDONLY | sum(getattr(os, flag, 0) for flag in ("O_NONBLOCK", "O_CLOEXEC", "O_BINARY", "O_NOCTTY"))


def checked(path: str | os.PathLike[str], limit_bytes: int = LIMIT_BYTES) -> Path:
    """The path of a readable, non-empty regular file of at most `limit_bytes`; looked up, not yet opened."""
    path = Path(path)
    try:
        _check(path, path.stat(), limit_bytes)
    except FileNotFoundError:
        raise BodyError(f"{path}: there is no such file; give the path of an existing one") from None
    except (OSError, ValueError) as fault:
        if isinstance(fault, BodyError):
            raise
        raise BodyError(f"{path}: cannot be read ({_reason(fault)})") from None
    return path


def opened(path: str | os.PathLike[str], limit_bytes: int = LIMIT_BYTES) -> FileIO:
    """A checked file, open for reading bytes; nothing that was put in its place meanwhile is waited for.

    Raises:
        BodyError: it is missing, no regular file, empty, too large, or may not be read.
    """
    path = checked(path, limit_bytes)
    try:
        file = FileIO(os.open(path, _FLAGS))
        _check(path, os.fstat(file.fileno()), limit_bytes)
    except OSError as fault:
        raise BodyError(f"{path}: cannot be read ({_reason(fault)})") from None
    return file


def raw(path: str | os.PathLike[str], limit_bytes: int = LIMIT_BYTES) -> bytes:
    """Whole content of a checked file, even if it grows meanwhile.

    Raises:
        BodyError: see `opened`.
    """
    parts, left = list[bytes](), limit_bytes
    try:
        with opened(path, limit_bytes) as file:
            while left and (part := file.read(min(left, 1 << 20))):
                parts.append(part)
                left -= len(part)
    except OSError as fault:
        raise BodyError(f"{path}: cannot be read ({_reason(fault)})") from None
    return b"".join(parts)


def text(path: str | os.PathLike[str], limit_bytes: int = LIMIT_BYTES) -> str:
    """Whole text of a checked file: UTF-8, UTF-16 that begins with its byte order mark, or else cp1252 (Latin-1)."""
    content = raw(path, limit_bytes)
    wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    for encoding in ("utf-16",) if wide else ("utf-8-sig", "cp1252"):
        try:
            found = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in found:
            return found
    raise BodyError(f"{path}: is not text (UTF-8, UTF-16 with its mark, or Latin-1); give a text file, best in UTF-8")


def lines(path: str | os.PathLike[str], content: str) -> Iterator[tuple[int, str]]:
    """Lines of a file's text that are not blank, and their numbers from 1.

    Raises:
        BodyError: more than MOST_LINES.
    """
    parted = "\n" if "\n" in content else "\r"
    if (count := content.count(parted)) > MOST_LINES:
        raise BodyError(f"{path}: has {count} lines where at most {MOST_LINES} are read; cut it into shorter files")
    start = 0
    for number in range(1, count + 2):
        end = content.find(parted, start)
        line = (content[start:] if end < 0 else content[start:end]).removesuffix("\r")
        start = end + 1
        if line.strip():
            yield number, line


def finite(cell: str, where: str) -> float:
    """The number in a cell, plainly written and at most LARGEST; BodyError says `where` there is none."""
    if not NUMBER.fullmatch(cell) or not abs(value := float(cell)) <= LARGEST:
        shown = cell if len(cell) <= 30 else cell[:27] + "..."
        raise BodyError(f"{where}: {shown!r} is not a finite number of at most {LARGEST:g}")
    return value


def _check(path: Path, status: os.stat_result, limit_bytes: int) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise BodyError(f"{path}: this is a directory; name one file in it")
    if not stat.S_ISREG(status.st_mode):
        raise BodyError(f"{path}: this is no regular file; give the path of one")
    if status.st_size == 0:
        raise BodyError(f"{path}: is empty; make or download it again")
    if status.st_size > limit_bytes:
        raise BodyError(
            f"{path}: has {status.st_size / 2**20:,.0f} MB where at most {limit_bytes / 2**20:,.0f} MB are read; "
            "give a smaller one"
        )


def _reason(fault: Exception) -> str:
    return getattr(fault, "strerror", None) or str(fault)
