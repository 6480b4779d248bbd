"""What a run left, read again. Others' files are data: bounded, checked, and refused in a line."""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from babbling.errors import BabblingError
from babbling.files import opened
from babbling.kinds import Numbers
from babbling.variables import Variables
from experiments.errors import ExperimentError
from models.files import text

LARGEST_JSON, LARGEST_ARRAYS, SHORTEST_S, LONGEST_S = 1 << 24, 1 << 28, 1e-6, 1e6
LONGEST_NAME, LONGEST_VALUE, MOST_NAMES = 60, 40, 10_000
TIMINGS = ("_s", "_ms", "_factor", "_mb")
"""So end metrics that tell of the machine."""


@dataclass(frozen=True)
class Tracks:
    """Movements of joints out of a trajectories.nc, in the units of people."""

    time: FloatArray
    """(T,) s."""
    joints: tuple[str, ...]
    units: tuple[str, ...]
    demonstrated: FloatArray
    """(T, J)."""
    imitated: FloatArray
    """(T, J) in the last attempt."""

    @property
    def tick_s(self) -> float:
        """Seconds between two times."""
        return float(self.time[1] - self.time[0])

    @property
    def busiest(self) -> list[str]:
        """Joints by how much they move, most first."""
        return [self.joints[j] for j in np.argsort(-self.demonstrated.std(0), kind="stable")]

    def of(self, joints: Sequence[str]) -> "Tracks":
        """Of these joints alone, in this order."""
        which = [self.joints.index(joint) for joint in joints]
        units = tuple(self.units[j] for j in which)
        return Tracks(self.time, tuple(joints), units, self.demonstrated[:, which], self.imitated[:, which])

    @property
    def error(self) -> FloatArray:
        """(T,) root mean square over joints."""
        return np.asarray(np.sqrt(np.mean((self.imitated - self.demonstrated) ** 2, axis=1)))


@dataclass(frozen=True)
class Run:
    """One folder of results."""

    label: str
    experiment: str
    options: Mapping[str, str]
    metrics: Mapping[str, float]
    tracks: Tracks | None
    """None where there is no trajectories.nc."""


def read_run(folder: Path, label: str) -> Run:
    """A folder of results.

    Raises:
        ExperimentError: it is none, or what is in it cannot be used.
        BodyError: a file that cannot be read.
    """
    if not all(os.path.isfile(folder / name) for name in ("config.json", "metrics.json")):
        raise ExperimentError(
            f"{folder}: this is no folder that a run left (config.json and metrics.json in it); name one such as "
            "runs/gesture"
        )
    notes, metrics = (_json(folder / name) for name in ("config.json", "metrics.json"))
    experiment, options = notes.get("experiment"), notes.get("options")
    if not isinstance(experiment, str) or not isinstance(options, dict):
        raise ExperimentError(f"{folder / 'config.json'}: it does not say which experiment with which options it was")
    if len(options) > MOST_NAMES or len(metrics) > MOST_NAMES:
        raise ExperimentError(f"{folder}: it tells of more than {MOST_NAMES} options or numbers; run it again")
    said = {plain(name, LONGEST_NAME): plain(json.dumps(value), LONGEST_VALUE) for name, value in options.items()}
    path = folder / "trajectories.nc"
    return Run(
        label, plain(experiment), said, dict(_numbers(metrics)), _tracks(path) if os.path.lexists(path) else None
    )


def plain(words: str, longest: int = LONGEST_NAME) -> str:
    """Printable and short, on one line, and without what means something in a table."""
    kept = "".join(letter if letter.isprintable() and letter not in "|`*<>[]" else " " for letter in words)
    kept = " ".join(kept.split())
    return kept if len(kept) <= longest else kept[: longest - 3] + "..."


def _json(path: Path) -> dict[str, Any]:
    """An object out of a file of bounded size."""
    content = text(path, LARGEST_JSON)
    try:
        found = json.loads(content)
        json.dumps(found)  # as deep as can be read is deeper than can be written
    except (ValueError, RecursionError) as error:
        raise ExperimentError(f"{path}: this is no JSON ({plain(str(error))}); run the experiment again") from None
    if not isinstance(found, dict):
        raise ExperimentError(f"{path}: this holds no names and values; run the experiment again")
    return found


def _numbers(metrics: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, float]]:
    """Finite numbers by name, those one level down too; timings are left out."""
    for name, value in metrics.items():
        whole = before + name
        if isinstance(value, dict) and not before:
            yield from _numbers(value, f"{name}.")
        elif isinstance(value, float | int) and not isinstance(value, bool) and not name.endswith(TIMINGS):
            if abs(value) < 1e300 and isfinite(value) and plain(whole) == whole:
                yield whole, float(value)


def _tracks(path: Path) -> Tracks:
    """Of a trajectories.nc.

    Raises:
        ExperimentError: it is damaged, or holds what cannot be.
    """
    try:
        with opened(path) as file:
            held = Variables(file, LARGEST_ARRAYS)
            joints = held.words("joint")
            shown = tuple(plain(joint) for joint in joints)
            letters = held.numbers("unit", Numbers("joint letters"), "S1")
            time = held.numbers("time", Numbers("time", low=0, high=LONGEST_S), np.float64)
            demonstrated = held.numbers("demonstrated", Numbers("time joint"), np.float32)
            imitated = held.numbers("imitated", Numbers("attempt time joint"), np.float32)
            units = tuple(row.tobytes().rstrip(b"\0").decode(errors="replace") for row in letters)
            timed = len(time) > 1 and (np.diff(time) > SHORTEST_S).all()
            if not timed or not len(imitated) or not joints or len(set(shown)) < len(joints):
                raise BabblingError("time does not go on, nobody imitated, or there is no joint or a name twice")
            return Tracks(time, shown, tuple(plain(unit, 20) for unit in units), demonstrated, imitated[-1])
    except BabblingError as error:
        raise ExperimentError(f"{path}: {error}") from error
    except Exception as error:  # h5py raises many kinds on damaged files
        raise ExperimentError(f"{path}: this NetCDF-4 file is damaged; run the experiment again") from error
