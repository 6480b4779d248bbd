"""Lives that were lived are kept: a benchmark that was interrupted goes on where it stopped."""

import hashlib
import json
import os
from dataclasses import asdict, fields
from pathlib import Path

import numpy as np

from experiments.benchmark.lives import Point, Task, live
from experiments.errors import ExperimentError
from experiments.shared.experiment import as_json, commit
from models.files import text

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
        points, beside = live(task), path.with_suffix(f".{os.getpid()}")
        beside.write_text(as_json([asdict(point) for point in points]))
        os.replace(beside, path)
    except OSError as error:
        raise ExperimentError(f"--keep {folder}: cannot be written ({error.strerror}); name another folder") from error
    return points


def _read(path: Path) -> list[Point]:
    names = {one.name for one in fields(Point)}
    try:
        found = json.loads(text(path, LARGEST))
        if not found or any(set(point) != names for point in found):
            raise ValueError("other entries")
        return [
            Point(
                float(point["minutes"]),
                {name: [float(one) for one in values] for name, values in point["errors"].items()},
                {name: np.array(values, float) for name, values in point["ringing"].items()},
                [[float(one) for one in values] for values in point["last"]],
                {name: float(one) for name, one in point["costs"].items()},
            )
            for point in found
        ]
    except (OSError, ValueError, TypeError, AttributeError, RecursionError) as error:
        raise ExperimentError(f"{path}: this is no life of a benchmark; remove it, it will be lived again") from error


def _digest(task: Task) -> str:
    told = repr((commit(), task.body, task.seed, tuple(task.models), task.stops, task.attempts, task.costs))
    digest = hashlib.sha256(told.encode())
    for name, angles in task.clips.items():
        digest.update(name.encode() + np.ascontiguousarray(angles).tobytes())
    return digest.hexdigest()[:12]
