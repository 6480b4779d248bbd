"""Many tasks at once, each in a process of its own; which process does which makes no difference."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from typing import TypeVar

from experiments.shared.fresh_process import elsewhere
from experiments.shared.kept import keeper
from experiments.shared.progress import progress

Task = TypeVar("Task")
Found = TypeVar("Found")


def in_parallel(work: Callable[[Task], Found], tasks: Sequence[Task], workers: int, doing: str) -> list[Found]:
    """What `work` makes of every task, in order, with progress under the name `doing`; what is done is kept where a
    block asks for it (`experiments.shared.kept`)."""
    work = keeper(work)
    if workers <= 1:
        return _gathered(map(work, tasks), len(tasks), doing)
    with closing(elsewhere(work, workers, tasks)) as found:
        return _gathered(found, len(tasks), doing)


def _gathered(found: Iterator[Found], count: int, doing: str) -> list[Found]:
    everything = list[Found]()
    with progress(doing) as report:
        for one in found:
            everything.append(one)
            report(len(everything) / count)
    return everything
