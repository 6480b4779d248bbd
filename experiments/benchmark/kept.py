"""Lives that were lived are kept: a benchmark that was interrupted goes on where it stopped."""

import hashlib
import json
from dataclasses import asdict, fields
from pathlib import Path

import numpy as np

from babbling.whole import whole
from experiments.benchmark.lives import Point, Task, live
from experiments.errors import ExperimentError
from experiments.shared.experiment import as_json, commit

LARGEST = 1 << 24


def lived(task: Task, folder: Path | None = None) -> list[Point]:
    """`live`, or what it left in the folder when it was the same task of the same program.

    Raises:
        ExperimentError: a folder that cannot be written, a file in it that is no life.
    """
    if folder is None:
        return live(task)
    path = folder / f"{Path(task.body).stem}-{task.seed}-{_digest(task)}.json"
    if path.exists():
        return _read(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        points = live(task)
        with whole(path) as beside:
            beside.write_text(as_json([asdict(point) for point in points]))
    except OSError as error:
        raise ExperimentError(f"--keep {folder}: cannot be written ({error.strerror}); name another folder") from error
    return points


def _read(path: Path) -> list[Point]:
    names = {one.name for one in fields(Point)}
    try:
        if path.stat().st_size > LARGEST:
            raise ValueError("too large")
        found = json.loads(path.read_text())
        if not found or any(set(point) != names for point in found):
            raise ValueError("other entries")
        return [Point(**point | {"ringing": {k: np.array(v) for k, v in point["ringing"].items()}}) for point in found]
    except (OSError, ValueError, TypeError, AttributeError, RecursionError) as error:
        raise ExperimentError(f"{path}: this is no life of a benchmark; remove it, it will be lived again") from error


def _digest(task: Task) -> str:
    told = repr((commit(), task.body, task.seed, tuple(task.models), task.stops, task.attempts, task.costs))
    digest = hashlib.sha256(told.encode())
    for name, angles in task.clips.items():
        digest.update(name.encode() + np.ascontiguousarray(angles).tobytes())
    return digest.hexdigest()[:12]
