"""Native code kept quiet."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco

from models.errors import BodyError


@contextmanager
def unheard() -> Iterator[None]:
    """A block in which MuJoCo neither prints its warnings nor leaves a file of them."""
    told = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(told)


@contextmanager
def silence(path: Path) -> Iterator[None]:
    """A block in which nothing is heard of what native code says of a file.

    Raises:
        BodyError: there is no memory for it.
    """
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    kept = {fd: os.dup(fd) for fd in (1, 2) if _is_open(fd)}
    try:
        for fd in kept:
            os.dup2(nowhere, fd)
        with unheard():
            yield
    except (MemoryError, mujoco.FatalError) as error:
        raise BodyError(f"{path}: MuJoCo cannot compile it ({' '.join(str(error).split())})") from error
    finally:
        for fd, was in kept.items():
            os.dup2(was, fd)
        for fd in (nowhere, *kept.values()):
            os.close(fd)


def _is_open(fd: int) -> bool:
    try:
        os.fstat(fd)
    except OSError:
        return False
    return True
