"""Many tasks at once: here, in processes of this machine, or on a cluster; who does which makes no difference."""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from typing import TypeVar

from experiments.errors import ExperimentError
from experiments.shared.cluster import cluster
from experiments.shared.dealing import Failure, dealt, failure
from experiments.shared.fresh_process import processes
from experiments.shared.kept import keeper, part_of
from experiments.shared.progress import progress

Task = TypeVar("Task")
Found = TypeVar("Found")


def in_parallel(
    work: Callable[[Task], Found], tasks: Sequence[Task], workers: int, doing: str, scheduler: str | None = None
) -> list[Found]:
    """What `work` makes of every task, in order, with progress under the name `doing`; what is done is kept where a
    block asks for it (`experiments.shared.kept`). The first task that fails ends it, with what it raised."""
    found = list[Found]()
    with progress(doing) as report, closing(in_order(work, tasks, workers, scheduler)) as everything:
        for one in everything:
            found.append(one)
            report(len(found) / len(tasks))
    return found


def attempted(
    work: Callable[[Task], Found], tasks: Sequence[Task], workers: int, doing: str, scheduler: str | None = None
) -> list[Found | Failure]:
    """The same, but that a task which fails is a `Failure` in its place, and the others go on; see `succeeded`."""
    found = dict[int, Found | Failure]()
    with progress(doing) as report, closing(_ended(work, tasks, workers, scheduler)) as ended:
        for number, one in ended:
            found[number] = one
            report(len(found) / len(tasks))
    return [found[number] for number in range(len(tasks))]


def succeeded(found: Sequence[Found | Failure]) -> list[Found]:
    """What was found, if nothing failed.

    Raises:
        ExperimentError: every failure, in its own words.
    """
    failed = [str(one) for one in found if isinstance(one, Failure)]
    if failed:
        raise ExperimentError(f"{len(failed)} of {len(found)} failed: {' | '.join(failed)}")
    return [one for one in found if not isinstance(one, Failure)]


def in_order(
    work: Callable[[Task], Found], tasks: Sequence[Task], workers: int, scheduler: str | None = None
) -> Generator[Found, None, None]:
    """What `work` makes of every task, in order, as soon as it is known; raises what the first that fails raised."""
    early, following = dict[int, Found | Failure](), 0
    with closing(_ended(work, tasks, workers, scheduler)) as ended:
        for number, one in ended:
            early[number] = one
            while following in early:
                found = early.pop(following)
                if isinstance(found, Failure):
                    raise found.cause
                yield found
                following += 1


def _ended(
    work: Callable[[Task], Found], tasks: Sequence[Task], workers: int, scheduler: str | None
) -> Generator[tuple[int, Found | Failure], None, None]:
    """As they end."""
    if scheduler is not None:
        yield from _far(work, tasks, workers, scheduler)
    elif workers > 1:
        with processes(workers) as pool:
            yield from dealt(keeper(work), tasks, pool)
    else:
        for number, task in enumerate(tasks):
            try:
                found: Found | Failure = keeper(work)(task)
            except Exception as error:
                found = failure(task, error)
            yield number, found


def _far(
    work: Callable[[Task], Found], tasks: Sequence[Task], workers: int, scheduler: str
) -> Generator[tuple[int, Found | Failure], None, None]:
    """On a cluster, whose machines share no disk with this one: what is found is kept by this one."""
    with cluster(scheduler, workers) as machines:
        parts, todo = [part_of(work, task) for task in tasks], list[int]()
        for number, part in enumerate(parts):
            if part is not None and (known := part.read()) is not None:
                yield number, known[0]
            else:
                todo.append(number)
        for index, found in dealt(work, [tasks[number] for number in todo], machines):
            part = parts[todo[index]]
            yield todo[index], found if part is None or isinstance(found, Failure) else part.keep(found)
