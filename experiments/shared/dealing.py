"""Shards are dealt to whoever works: a few ahead of each worker, again where its worker was killed, despite failures.

A shard is a task that depends on nothing but what it says, so that who does it, when, and how often, makes no
difference to what it finds.
"""

from collections import Counter, deque
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import Any, Protocol, TypeVar

from experiments.errors import ExperimentError

Task = TypeVar("Task")
Found = TypeVar("Found")
AHEAD = 2
"""Shards under way for each worker: the next is there when one ends, and ten thousand are not sent at once."""
ATTENTION_S, LONGEST = 1.0, 100


class Killed(Exception):
    """Whoever did this shard, or one beside it, was killed."""


class NobodyWorks(ExperimentError):
    """Nobody can go on, whatever the shard."""


@dataclass(frozen=True)
class Failure:
    """A shard that came to nothing, in its own words: `str()` is one line."""

    task: str
    """Its `label`, or else what it is as text."""
    cause: Exception

    def __str__(self) -> str:
        why = " ".join(str(self.cause).split()) or "nothing is said"
        kind = "" if isinstance(self.cause, ExperimentError) else f"{type(self.cause).__name__}: "
        return f"{self.task}: {kind}{why}"


class Under(Protocol):
    """A shard under way: a future."""

    def add_done_callback(self, told: Callable[[Any], object], /) -> object:
        """Have it told once it has ended."""


class Workers(Protocol):
    """Who does shards: processes, a cluster."""

    tries: int
    """How often workers may be killed at a shard; the last time it is done alone, so that no other can have been it."""

    @property
    def count(self) -> int:
        """How many work at present."""

    def begin(self, work: Callable[[Any], Any], task: Any) -> Any:
        """A future of `work(task)`."""

    def result(self, future: Any) -> Any:
        """What it came to, once it has ended; raises `Killed`, `NobodyWorks`, or what it raised itself."""

    def attend(self) -> None:
        """Is called every `ATTENTION_S`; raises `NobodyWorks`."""


def dealt(
    work: Callable[[Task], Found], tasks: Sequence[Task], workers: Workers
) -> Generator[tuple[int, Found | Failure], None, None]:
    """(number, what `work` makes of that task), as they end.

    Raises:
        NobodyWorks: see `Workers`.
    """
    ended, doing, deaths = SimpleQueue[int](), dict[int, Any](), Counter[int]()
    waiting, alone = deque(range(len(tasks))), False
    while waiting or doing:
        while waiting and not alone and len(doing) < AHEAD * max(1, workers.count):
            alone = deaths[waiting[0]] == workers.tries - 1
            if alone and doing:  # only once these have ended
                break
            number = waiting.popleft()
            doing[number] = workers.begin(work, tasks[number])
            doing[number].add_done_callback(lambda _, number=number: ended.put(number))
        number = _next(ended, workers)
        future = doing.pop(number)
        alone = alone and bool(doing)
        try:
            found: Found | Failure = workers.result(future)
        except NobodyWorks:
            raise
        except Killed:
            deaths[number] += 1
            if deaths[number] < workers.tries:
                waiting.appendleft(number)
                continue
            why = "whoever did this was killed again and again, by somebody or for want of memory"
            found = failure(tasks[number], ExperimentError(f"{why}; fewer --workers need less"))
        except Exception as error:
            found = failure(tasks[number], error)
        yield number, found


def failure(task: object, error: Exception) -> Failure:
    """What is said of a task that failed."""
    told = str(getattr(task, "label", "") or task)
    return Failure(" ".join(told.split())[:LONGEST], error)


def _next(ended: "SimpleQueue[int]", workers: Workers) -> int:
    while True:
        try:
            return ended.get(timeout=ATTENTION_S)
        except Empty:
            workers.attend()
