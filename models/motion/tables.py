"""Joint trajectories as comma-separated text with a header: `time,<joint>,<joint>,...`.

Time is in seconds. Angles are radians, or degrees where a line `# unit: deg` stands before the header.
"""

import csv
import os
from pathlib import Path
from typing import IO, Literal

import numpy as np

from models.motion.files import MotionError, write
from models.motion.trajectory import JointTrajectory

Unit = Literal["rad", "deg"]
UNITS: dict[str, float] = {"rad": 1.0, "deg": np.pi / 180}
"""Radians in one of each."""


def parse_table(content: str, path: Path, unit: Unit | None = None) -> JointTrajectory:
    """Read a table from its text; `path` names it in errors."""
    header: list[str] | None = None
    rows: list[list[float]] = []
    declared: str = unit or "rad"
    for number, line in enumerate(content.splitlines(), start=1):
        if not line.strip():
            continue
        if line.lstrip().startswith("#"):
            key, _, value = line.lstrip("# \t").partition(":")
            if key.strip() == "unit" and unit is None:
                declared = value.strip()
                if declared not in UNITS:
                    raise MotionError(f"{path}: line {number}: unit {declared!r}; angles are in 'rad' or 'deg'")
            continue
        cells = [cell.strip() for cell in next(csv.reader([line]))]
        if header is None:
            header = _header(cells, path, number)
        elif len(cells) != len(header):
            raise MotionError(
                f"{path}: line {number} has {len(cells)} cells where the header has {len(header)}; give one per column"
            )
        else:
            rows.append([_number(cell, column, path, number) for cell, column in zip(cells, header, strict=True)])
    if header is None:
        raise MotionError(f"{path}: has no header; the first line must be time,<joint>,<joint>,...")
    clock = header.index("time")
    values = np.array(rows).reshape(-1, len(header))
    joints = tuple(name for name in header if name != "time")
    return JointTrajectory(str(path), values[:, clock], joints, np.delete(values, clock, axis=1) * UNITS[declared])


def write_table(trajectory: JointTrajectory, path: str | os.PathLike[str]) -> None:
    """Write a trajectory in radians with all digits: reading it again gives the same numbers."""
    lines = [",".join(("time", *trajectory.joints))]
    for moment, row in zip(trajectory.time.tolist(), trajectory.angles.tolist(), strict=True):
        lines.append(",".join(map(repr, (moment, *row))))
    content = ("\n".join(lines) + "\n").encode()

    def fill(stream: IO[bytes]) -> None:
        stream.write(content)

    write(path, fill)


def _header(cells: list[str], path: Path, number: int) -> list[str]:
    if "time" not in cells:
        raise MotionError(
            f"{path}: line {number}: column 'time' is missing; the header must be time,<joint>,<joint>,..."
        )
    for cell in cells:
        if not cell:
            raise MotionError(f"{path}: line {number}: a column has no name; name the joint")
        if cells.count(cell) > 1:
            raise MotionError(f"{path}: line {number}: column {cell!r} appears twice; name each joint once")
    return cells


def _number(cell: str, column: str, path: Path, number: int) -> float:
    try:
        value = float(cell)
    except ValueError:
        shown = cell if len(cell) <= 30 else cell[:27] + "..."
        raise MotionError(f"{path}: line {number}, column {column!r}: {shown!r} is not a number") from None
    if not np.isfinite(value):
        raise MotionError(f"{path}: line {number}, column {column!r}: {cell!r} is not a finite number")
    return value
