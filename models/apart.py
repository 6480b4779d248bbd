"""Strangers' files are tried in a process of its own first: what native readers die of, print and leave stays there."""

import math
import os
import signal
import subprocess
import sys
import time
from functools import lru_cache
from pathlib import Path
from pkgutil import resolve_name

from models.errors import BodyError, Told

INSIDE = "IMITATION_TRIAL"
"""Stands in the environment of a trial, which tries nothing itself."""
CPU_S, BYTES_PER_S, WALL_S = 3, 4 << 20, 30.0
"""s of computing that a trial may take, more by bytes of what belongs to it; s by the clock, for what only waits."""
MEMORY, RESERVED = 768 << 20, 8 << 30
"""Bytes that a trial may use; that it may ask for, which MuJoCo does generously."""
PAGE = 4096
REFUSED = 3
LONGEST_SAID = 2000
"""Bytes; a pipe takes them without a reader."""


def tried(work: str, path: Path, size: int = 0) -> None:
    """Do `work` ("module:function", of a path) to a stranger's file where it can do no harm, once for each version of
    the file; `size` is bytes of all that belongs to it.

    Raises:
        BodyError: what it raises there; or it dies, does not end, or needs too much.
    """
    if INSIDE not in os.environ:
        status = path.stat()
        apart(work, str(path), CPU_S + size // BYTES_PER_S, (status.st_mtime_ns, status.st_size))


@lru_cache(maxsize=64)
def apart(work: str, path: str, seconds: int, version: tuple[int, ...]) -> None:
    """`tried`, once in this process for a main file of this version."""
    code = f"import sys; sys.path[:] = {sys.path!r}; from models.apart import _here; _here()"
    words = [sys.executable, "-c", code, work, path, str(seconds)]
    env = os.environ | {INSIDE: "1", "OPENBLAS_NUM_THREADS": "1", "MUJOCO_GL": "disabled"}
    none, read, end = subprocess.DEVNULL, subprocess.PIPE, time.monotonic() + WALL_S + seconds
    with subprocess.Popen(words, env=env, stdin=none, stdout=read, stderr=none) as child:
        why = ""
        try:
            while not why and child.poll() is None:
                time.sleep(0.01)
                if time.monotonic() > end:
                    why = "it does not end; is what it names a file?"
                elif _resident(child.pid) > MEMORY:
                    why = f"it needs more than {MEMORY >> 20} MB"
        finally:
            child.kill()
        said = child.communicate()[0].decode(errors="replace")
    if not why and child.returncode == REFUSED:
        raise BodyError(said)
    if child.returncode and not why:
        died = signal.Signals(-child.returncode).name if child.returncode < 0 else f"exit {child.returncode}"
        slow = died in ("SIGXCPU", "SIGKILL")
        why = (
            f"it takes more than {seconds} s of computing, or too much memory"
            if slow
            else f"its reader dies of it, {died}"
        )
    if why:
        raise BodyError(f"{path}: cannot be loaded ({why}); make it simpler, or anew")


def _here() -> None:
    """The process of a trial: says in a line, on what was standard output, why it fails, and ends."""
    out, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    work, path, seconds = sys.argv[1:]
    do, said = resolve_name(work), ""
    _bound(int(seconds) + math.ceil(time.process_time()))  # what loading took is not the file's affair
    try:
        do(Path(path))
    except Told as error:
        said = str(error)
    except MemoryError:
        said = f"{path}: needs more than {MEMORY >> 20} MB; make it simpler"
    except Exception as error:  # whatever a stranger's file makes go wrong
        said = f"{path}: cannot be used ({type(error).__name__}: {error})"
    os.write(out, said.encode(errors="replace")[:LONGEST_SAID])
    os._exit(REFUSED if said else 0)


def _resident(process: int) -> int:
    """Bytes of memory that it uses, where the system tells as Linux does."""
    try:
        return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * PAGE
    except (OSError, IndexError):
        return 0


def _bound(seconds: int) -> None:
    try:
        import resource
    except ImportError:  # Windows has only the clock
        return
    for kind, most in ((resource.RLIMIT_CPU, seconds), (resource.RLIMIT_DATA, RESERVED), (resource.RLIMIT_CORE, 0)):
        resource.setrlimit(kind, (most, most))
