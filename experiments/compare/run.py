"""Runs side by side: what was asked otherwise, what came of it, and how far off they were through time."""

import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from experiments.compare.figures import figures
from experiments.compare.found import Compared
from experiments.compare.options import Config
from experiments.compare.reading import plain, read_run
from experiments.compare.recording import record
from experiments.errors import ExperimentError
from experiments.shared.experiment import Result
from experiments.shared.tables import table

MOST_RUNS, MOST_ROWS, MOST_SAME = 12, 30, 8


def run(config: Config) -> Result:
    """Read, compare.

    Raises:
        ExperimentError, BodyError: too few or too many runs, a folder that is none, a file that cannot be used.
    """
    config.check()
    if not 2 <= len(config.runs) <= MOST_RUNS:
        raise ExperimentError(f"imitate compare RUN RUN ...: {len(config.runs)} given; 2 to {MOST_RUNS} are compared")
    done = Compared(tuple(map(read_run, config.runs, labels(config.runs))))
    summary = summarise(done)
    metrics = {
        "runs": [str(path) for path in config.runs],
        "options": done.options,
        "metrics": done.metrics,
        "joints": done.joints,
        "error": done.overall,
        "remarks": done.remarks,
    }
    return Result(metrics, summary, figures(done), partial(record, done=done, summary=summary) if done.joints else None)


def labels(folders: Sequence[Path]) -> list[str]:
    """A name for each: its own, or as much of the path as tells it apart.

    Raises:
        ExperimentError: a folder that is named twice.
    """
    whole = [Path(os.path.realpath(folder)) for folder in folders]
    if len(set(whole)) < len(whole):
        twice = next(folder for n, folder in enumerate(folders) if whole[n] in whole[:n])
        raise ExperimentError(f"{twice}: named twice; a run is the same as itself")
    for length in range(1, max(len(path.parts) for path in whole) + 1):
        found = [plain("/".join(path.parts[-length:])) for path in whole]
        if len(set(found)) == len(found):
            return found
    return [f"{number} {name}" for number, name in enumerate(found, 1)]


def summarise(done: Compared) -> str:
    """Options that differ, metrics that differ, and what is not shared: markdown."""
    names = [run.label for run in done.runs]
    parts = [f"**{' and '.join(names)}**"]
    if done.options:
        parts.append(table([(name, *told) for name, told in done.options.items()], ("option", *names)))
    rows = [(name, *(f"{value:.5g}" for value in values)) for name, values in done.different.items()]
    if done.errors:
        told = done.overall
        rows.insert(
            0,
            (
                f"error, {len(done.joints)} joints in all [{done.unit}]",
                *(f"{told[name]:.5g}" if name in told else "-" for name in names),
            ),
        )
    if rows:
        parts.append(table(rows[:MOST_ROWS], ("metric", *names)))
    if len(rows) > MOST_ROWS:
        parts.append(f"{len(rows) - MOST_ROWS} more stand in metrics.json.")
    if same := [name for name in done.metrics if name not in done.different]:
        more = f" and {len(same) - MOST_SAME} more" if len(same) > MOST_SAME else ""
        parts.append(f"The same in all: {', '.join(same[:MOST_SAME])}{more}.")
    return "\n\n".join([*parts, *done.remarks])
