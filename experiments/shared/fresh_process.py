"""Processes of their own: new interpreters, that know nothing but files and arguments."""

import os
import signal
import tempfile
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from dataclasses import dataclass
from multiprocessing import active_children, get_context, parent_process, resource_tracker
from pathlib import Path
from threading import Thread
from typing import Any, TypeVar

from experiments.shared.dealing import Failure, Killed, dealt
from experiments.stopping import STOPS

Files = Mapping[str, Callable[[Path], object]]
"""Name and writer of each."""
Found = TypeVar("Found")


def in_new_process(work: Callable[..., Found], files: Files, *words: object) -> Found:
    """What `work(FOLDER, *words)` comes to in a new interpreter; `files` are written to FOLDER first."""
    with tempfile.TemporaryDirectory() as folder, processes(1) as one:
        for name, write in files.items():
            write(Path(folder) / name)
        with closing(dealt(_call, [_Call(work, (Path(folder), *words))], one)) as ended:
            _, found = next(ended)
    if isinstance(found, Failure):
        raise found.cause
    result: Found = found
    return result


@dataclass(frozen=True)
class _Call:
    work: Callable[..., Any]
    words: tuple[object, ...]


def _call(call: _Call) -> Any:
    return call.work(*call.words)


class Processes:
    """So many new interpreters of this machine: they leave signals to this one, and end when it does. Where one of them
    is killed, new ones take the place of all."""

    tries = 3

    def __init__(self, count: int) -> None:
        self.count, self._others = count, {process.pid for process in active_children()}
        self._pool = self._new()

    def _new(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(self.count, get_context("spawn"), _attend)

    def begin(self, work: Callable[[Any], Found], task: Any) -> "Future[Found]":
        """A future of `work(task)`."""
        with signals_held():
            try:
                return self._pool.submit(work, task)
            except BrokenProcessPool:
                self.end(at_once=True)
                self._pool = self._new()
                return self._pool.submit(work, task)

    def result(self, future: "Future[Found]") -> Found:
        """What it came to.

        Raises:
            Killed: one of these processes was.
        """
        try:
            return future.result()
        except BrokenProcessPool as error:
            raise Killed from error

    def attend(self) -> None:
        """A future tells whether its process is there."""

    def end(self, *, at_once: bool) -> None:
        """Once they have done what they do, or without waiting for it."""
        if at_once:
            for process in active_children():  # futures that were cancelled would make the pool's own thread complain
                if process.pid not in self._others:
                    process.kill()
        self._pool.shutdown()


@contextmanager
def processes(count: int) -> Iterator[Processes]:
    """A block that has so many; if it does not end well they do not end their work."""
    pool, well = Processes(count), False
    try:
        yield pool
        well = True
    finally:
        pool.end(at_once=not well)


@contextmanager
def signals_held() -> Iterator[None]:
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
