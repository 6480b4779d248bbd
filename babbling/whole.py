"""What is written appears whole under its name, or not at all, whatever ends the process that writes it.

It is made in a folder beside its place, `.NAME.imitate-XXXXXXXX`, which its process keeps locked: one that nobody keeps
was left by a dead process, and is swept by the next that writes NAME. Without locks (no `fcntl`, some network disks)
nothing is swept.
"""

import ctypes
import errno
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]

MARK, LONGEST = ".imitate-", 150
"""What marks such a folder; how much of a name stands before it (a file system's names end at 255 bytes)."""
AT_FDCWD, EXCHANGE = -100, 2
"""Of Linux's renameat2; the other is that of macOS's renamex_np too."""


@contextmanager
def whole(path: Path, *, over: bool = True) -> Iterator[Path]:
    """Where to write the file, or make the folder, that takes the place of `path` at once when the block ends well.

    Args:
        path: its name; folders above it are made, and gone again where the block fails.
        over: whether it may replace an older one.

    Raises:
        OSError: it cannot be written; FileExistsError where something is there and may not be replaced.
    """
    made = [above for above in path.parents if not above.exists()]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with folder_beside(path) as folder:
            new = folder / "new" / path.name
            new.parent.mkdir()
            yield new
            if not over:
                os.link(new, path)  # unlike a renaming, refused where something is there
            elif new.is_dir():
                _replace(new, path, folder / "old" / path.name)
            else:
                os.replace(new, path)
    except BaseException:
        for above in made:
            with suppress(OSError):
                above.rmdir()
        raise


@contextmanager
def folder_beside(path: Path) -> Iterator[Path]:
    """A new folder beside `path`, gone when the block ends; what dead processes left there is swept first.

    Raises:
        OSError: there is none to be had.
    """
    sweep(path)
    while True:
        folder = Path(tempfile.mkdtemp(prefix=f".{path.name[:LONGEST]}{MARK}", dir=path.parent))
        held = _hold(folder)
        if folder.exists():  # else somebody swept it before it was held
            break
        if held is not None:
            os.close(held)
    try:
        yield folder
    finally:
        try:
            _clear(folder, path)
        except KeyboardInterrupt:
            _clear(folder, path)
            raise
        finally:
            if held is not None:
                os.close(held)


def try_place(out: Path) -> None:
    """Make a folder where `out` would be, and remove it: permissions alone do not tell whether that will do.

    Raises:
        OSError: it cannot be written.
    """
    place = out.absolute().resolve()
    with folder_beside(next(above for above in place.parents if above.exists()) / place.name):
        pass


def sweep(path: Path) -> bool:
    """Remove what dead processes left of writing `path`; whether an older one, which one of them had put aside, is back
    under its name."""
    back, begins = False, f".{path.name[:LONGEST]}{MARK}"
    with suppress(OSError):
        for folder in [one for one in path.parent.iterdir() if one.name.startswith(begins)]:
            with suppress(OSError):
                others = any(one.name != path.name for one in folder.glob("*/*"))  # a long name's, cut as this one is
                if others or not {*os.listdir(folder)} <= {"new", "old"}:
                    continue
                if (held := _hold(folder, wait=False)) is None:
                    continue
                try:
                    back |= _clear(folder, path)
                finally:
                    os.close(held)
    return back


def _hold(folder: Path, *, wait: bool = True) -> int | None:
    """A lock on a folder; None where there are none, or a living process has it."""
    held = None
    try:
        if fcntl is not None:
            held = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
            fcntl.flock(held, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        if held is not None:
            os.close(held)
        return None
    return held


def _clear(folder: Path, path: Path) -> bool:
    """Remove a folder that was made beside `path`; whether an older one came back out of it."""
    aside = folder / "old" / path.name
    back = aside.exists() and not os.path.lexists(path)
    if back:
        os.rename(aside, path)
    shutil.rmtree(folder, ignore_errors=True)
    return back


def _replace(new: Path, path: Path, aside: Path) -> None:
    """Put a folder where another may be: exchange them, or, where the system cannot, put the older one aside for a
    moment; whoever dies then leaves it to `sweep`."""
    try:
        os.rename(new, path)
        return
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
    if not _exchanged(new, path):
        aside.parent.mkdir()
        os.rename(path, aside)
        os.rename(new, path)


def _exchanged(one: Path, other: Path) -> bool:
    """Whether two names could be exchanged at once."""
    system: Any = ctypes.CDLL(None) if os.name == "posix" else None
    names = os.fsencode(one), os.fsencode(other)
    if hasattr(system, "renameat2"):
        return bool(system.renameat2(AT_FDCWD, names[0], AT_FDCWD, names[1], EXCHANGE) == 0)
    return bool(hasattr(system, "renamex_np") and system.renamex_np(*names, EXCHANGE) == 0)
