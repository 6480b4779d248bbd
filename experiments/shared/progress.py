"""A progress bar on a terminal, silence elsewhere."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

from babbling.axes import FloatArray
from babbling.body import Body

Report = Callable[[float], None]
"""Is told the fraction done."""


@contextmanager
def progress(label: str) -> Iterator[Report]:
    """Yields `report(fraction done)`; what was shown once is never taken back."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda done: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task, most = bar.add_task(label, total=1.0), 0.0

        def report(done: float) -> None:
            nonlocal most
            most = min(max(most, done), 1.0)
            bar.update(task, completed=most)

        yield report


def part(report: Report, start: float, end: float) -> Report:
    """A report of what is done between two fractions of the whole."""
    return lambda done: report(start + (end - start) * done)


@contextmanager
def ticking(body: Body, report: Report, ticks: float, done: float = 0) -> Iterator[None]:
    """A block in which a body's ticks are progress: `done` are before it, `ticks` are all."""
    act = body.act

    def acted(motors: FloatArray) -> FloatArray:
        nonlocal done
        done += 1
        report(min(done / ticks, 1.0))
        return act(motors)

    vars(body)["act"] = acted
    try:
        yield
    finally:
        del vars(body)["act"]
