"""Joint trajectories as comma-separated text with a header: `time,<joint>,<joint>,...`.

Time is in seconds. Angles are radians, or degrees where a line says `# unit: deg`.
"""

import re
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from models.errors import BodyError
from models.files import finite, table
from models.motion.trajectory import JointTrajectory

Unit = Literal["rad", "deg"]
UNITS: dict[str, float] = {"rad": 1.0, "deg": np.pi / 180}
"""Radians in one of each."""


def in_unit(path: Path, time: ArrayLike, joints: list[str], angles: ArrayLike, unit: str) -> JointTrajectory:
    """The trajectory that a file holds, its angles in `unit`."""
    if unit not in UNITS:
        raise BodyError(f"{path}: unit {unit!r}; angles are in 'rad' or 'deg'")
    radians = np.asarray(angles, float) * UNITS[unit]
    return JointTrajectory(str(path), np.asarray(time, float), tuple(joints), radians)


def parse_table(content: str, path: Path, unit: Unit | None = None) -> JointTrajectory:
    """Read a table from its text; `path` names it in errors, `unit` overrules what it declares."""
    rows = table(content, path)
    if not rows:
        raise BodyError(f"{path}: has no header; the first line must be time,<joint>,<joint>,...")
    (where, header), *rows = rows
    if "time" not in header:
        raise BodyError(f"{where}: column 'time' is missing; the header must be time,<joint>,<joint>,...")
    if "" in header:
        raise BodyError(f"{where}: a column has no name; name the joint")
    numbers = [
        [finite(cell, f"{place}, column {column!r}") for cell, column in zip(cells, header, strict=True)]
        for place, cells in rows
    ]
    values, clock = np.array(numbers).reshape(-1, len(header)), header.index("time")
    declared = re.findall(r"^[ \t]*#[# \t]*unit[ \t]*:[ \t]*(.*?)[ \t\r]*$", content, re.MULTILINE)
    joints = header[:clock] + header[clock + 1 :]
    angles = np.delete(values, clock, axis=1)
    return in_unit(path, values[:, clock], joints, angles, unit or (declared or ["rad"])[-1])
