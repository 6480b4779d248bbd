"""Opening what strangers send: looked at before it is read, and written beside before it is put in place."""

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

from models.errors import BodyError

LIMIT_BYTES = 64 * 2**20
"""Largest motion file that is read; an hour of 25 joints at 50 Hz as text is about 40 MB."""


class MotionError(BodyError):
    """A motion file or a trajectory that the user can mend."""


def checked(path: str | os.PathLike[str], limit_bytes: int = LIMIT_BYTES) -> Path:
    """The path of a readable, non-empty regular file of at most `limit_bytes`; looked up, not yet opened."""
    path = Path(path)
    try:
        status = path.stat()
    except FileNotFoundError:
        raise MotionError(f"{path}: no such file; give the path of an existing one") from None
    except (OSError, ValueError) as fault:
        raise MotionError(f"{str(path)!r}: cannot be looked up ({_reason(fault)})") from None
    if path.is_dir():
        raise MotionError(f"{path}: is a directory; name one file in it")
    if not path.is_file():
        raise MotionError(f"{path}: is not a regular file; give the path of one")
    if status.st_size == 0:
        raise MotionError(f"{path}: is empty; record or download it again")
    if status.st_size > limit_bytes:
        raise MotionError(
            f"{path}: has {status.st_size / 2**20:,.0f} MB where at most {limit_bytes / 2**20:,.0f} MB are read; "
            "cut it into shorter movements"
        )
    return path


def text(path: str | os.PathLike[str], limit_bytes: int = LIMIT_BYTES) -> str:
    """Whole text of a checked file (UTF-8, a byte order mark is allowed)."""
    path = checked(path, limit_bytes)
    try:
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        raise MotionError(f"{path}: is not text (byte {fault.start} is not UTF-8); give a text file") from None
    except OSError as fault:
        raise MotionError(f"{path}: cannot be read ({_reason(fault)})") from None


def write(path: str | os.PathLike[str], content: Callable[[IO[bytes]], Any]) -> None:
    """Let `content` fill a temporary file beside `path`, then rename it: there is never half a file."""
    path = Path(path)
    try:
        handle, beside = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    except OSError as fault:
        raise MotionError(f"{path}: cannot be written ({_reason(fault)})") from None
    try:
        with os.fdopen(handle, "wb") as stream:
            content(stream)
        os.replace(beside, path)
    except BaseException as fault:
        os.unlink(beside)
        if isinstance(fault, OSError):
            raise MotionError(f"{path}: cannot be written ({_reason(fault)})") from None
        raise


def _reason(fault: Exception) -> str:
    return getattr(fault, "strerror", None) or str(fault)
