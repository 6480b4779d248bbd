"""Processes of their own: new interpreters, that know nothing but files and arguments."""

import os
import signal
import tempfile
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from multiprocessing import active_children, get_context, parent_process, resource_tracker
from pathlib import Path
from threading import Thread
from typing import Any, TypeVar

from experiments.errors import ExperimentError
from experiments.stopping import STOPS

Files = Mapping[str, Callable[[Path], object]]
"""Name and writer of each."""
Found = TypeVar("Found")


def in_new_process(work: Callable[..., Found], files: Files, *words: object) -> Found:
    """What `work(FOLDER, *words)` comes to in a new interpreter; `files` are written to FOLDER first."""
    with tempfile.TemporaryDirectory() as folder:
        for name, write in files.items():
            write(Path(folder) / name)
        with closing(elsewhere(work, 1, [Path(folder)], *([word] for word in words))) as found:
            return next(found)


def elsewhere(work: Callable[..., Found], count: int, *arguments: Sequence[Any]) -> Generator[Found, None, None]:
    """`map(work, *arguments)` in so many new interpreters: they leave signals to this one, and end when it does, or
    when this iterator is closed.

    Raises:
        ExperimentError: one of them was killed.
    """
    others = {process.pid for process in active_children()}
    with ProcessPoolExecutor(count, get_context("spawn"), _attend) as pool:
        try:
            with _signals_held():
                futures = [pool.submit(work, *one) for one in zip(*arguments, strict=True)]
            yield from (future.result() for future in futures)
        except BrokenProcessPool as error:
            raise ExperimentError(
                "a process that worked was killed, by somebody or for want of memory; fewer --workers need less"
            ) from error
        except BaseException:
            for process in active_children():  # futures that were cancelled would make the pool's own thread complain
                if process.pid not in others:
                    process.kill()
            raise


@contextmanager
def _signals_held() -> Iterator[None]:
    """A block that is not interrupted; processes that begin in it are never told to stop by signals."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # it would let signals through when it begins
    before = signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _attend() -> None:
    """End when the process that began this one ends, however it does."""

    def wait() -> None:
        if parent := parent_process():
            parent.join()
            os._exit(1)

    Thread(target=wait, daemon=True).start()
