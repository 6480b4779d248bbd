"""Joint trajectories as text with a header: time,<joint>,<joint>,... parted by commas, semicolons, tabs or spaces.

Time is in seconds, or in what its header says: time_ms, Time [ms], t (us). Angles are radians, or degrees where a line
says `# unit: deg`; a column may say its own unit: l_knee [deg], l_knee_deg, gripper (mm). A column that only counts
the rows is left out.
"""

import re
from collections.abc import Collection, Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from models.errors import BodyError
from models.files import LARGEST
from models.motion.checks import check_clock
from models.motion.trajectory import MIN_FRAMES, JointTrajectory
from models.tables import Table

Unit = Literal["rad", "deg"]
ANGLES = {"rad": 1.0, "radian": 1.0, "radians": 1.0, **dict.fromkeys(("deg", "degree", "degrees", "°"), np.pi / 180)}
"""Radians in one of each."""
LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
"""Metres, for what slides."""
CLOCKS = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec", "millis", "millisecond", "milliseconds"), 1e-3),
    **dict.fromkeys(("us", "µs", "usec", "microseconds"), 1e-6),
    **dict.fromkeys(("ns", "nsec", "nanoseconds"), 1e-9),
    "min": 60.0,
}
LONGEST_NAME = 100
TIMES = ("time", "timestamp", "timestamps", "t")
COUNTS = ("", "index", "frame", "frames", "row", "sample", "id", "no", "nr", "#", "unnamed: 0")
"""What a column that counts rows is called."""


def in_unit(
    path: object, time: ArrayLike, joints: Sequence[str], angles: ArrayLike, units: Sequence[str], clock: str = ""
) -> JointTrajectory:
    """The trajectory that a file holds; units: of each joint; clock: that of time, "" where the file says none.

    Raises:
        BodyError: another unit, or a time that cannot be meant (`models.motion.checks`).
    """
    scale = ANGLES | LENGTHS
    for joint, unit in zip(joints, units, strict=True):
        if unit not in scale:
            raise BodyError(
                f"{path}: joint {joint!r} in unit {unit!r}; angles are in 'rad' or 'deg', what slides in 'm' or 'mm'"
            )
    if clock and clock not in CLOCKS:
        raise BodyError(f"{path}: time in unit {clock!r}; possible are {', '.join(CLOCKS)}")
    seconds, values = np.asarray(time, float), np.asarray(angles, float)
    for what, told in (("time", seconds), ("a joint", values)):
        if np.abs(told).max(initial=0) > LARGEST:
            raise BodyError(f"{path}: {what} is at {np.abs(told).max():g}; numbers of at most {LARGEST:g} are read")
    check_clock(str(path), seconds := seconds * CLOCKS[clock or "s"], declared=bool(clock))
    factors = [scale[unit] for unit in units]
    return JointTrajectory(
        str(path), seconds, tuple(joints), values * factors if values.shape[-1:] == (len(factors),) else values
    )


def parse_table(
    rows: Table, content: str, unit: Unit | None = None, joints: Collection[str] = (), slides: Collection[str] = ()
) -> JointTrajectory:
    """Read a table out of its text.

    unit: of the angles, overruling what the file declares. joints: those of the body, where known: such a name is taken
    as it stands, and `NAME_deg` is one. slides: those that slide, metres where their columns say nothing.
    """
    if not len(rows.cells):
        raise BodyError(f"{rows.path}: has no header; the first line must be time,<joint>,<joint>,...")
    header: list[str] = rows.cells[0].tolist()
    for column, cell in enumerate(header, start=1):
        if len(cell) > LONGEST_NAME:
            raise BodyError(f"{rows.where(0)}: the name of column {column} has {len(cell)} characters; name the joint")
    columns = [_column(cell, joints) for cell in header]
    clock = next((i for one in TIMES for i, (name, _) in enumerate(columns) if name.lower() == one), None)
    if clock is None:
        raise BodyError(f"{rows.where(0)}: column 'time' is missing; the header must be time,<joint>,<joint>,...")
    read = [i for i, (name, _) in enumerate(columns) if i == clock or not _counts(rows, i, name, joints)]
    if "" in [columns[i][0] for i in read]:
        raise BodyError(f"{rows.where(0)}: a column has no name; name the joint")
    values = rows.numbers(slice(1, None), read, [f"column {header[i]!r}" for i in read])
    declared = re.findall(r"^[ \t\"]*#[# \t]*unit[ \t]*:[ \t]*(.*?)[ \t\r\",;]*$", content, re.MULTILINE)
    usual = unit or (declared or ["rad"])[-1]
    place, named = read.index(clock), [columns[i] for i in read if i != clock]
    units = [
        said if said in LENGTHS or (said and not unit) else "m" if joint in slides else usual for joint, said in named
    ]
    angles = np.delete(values, place, axis=1)
    return in_unit(rows.path, values[:, place], [joint for joint, _ in named], angles, units, columns[clock][1])


def _column(header: str, joints: Collection[str]) -> tuple[str, str]:
    """Name and unit out of a column's header; "" where it says no unit."""
    if header in joints:
        return header, ""
    bracketed = re.fullmatch(r"(.*?)[\s_]*[\[(]\s*(°|[^\W\d_]+)\s*[\])]", header)
    if told := bracketed or re.fullmatch(r"(.+?)[\s_]+(°|[^\W\d_]+)_*", header):
        name, word = told[1], told[2].lower()
        if (name.lower() in TIMES and word in CLOCKS) or name in joints or (bracketed and word in ANGLES | LENGTHS):
            return name, word
    return header, ""


def _counts(rows: Table, column: int, name: str, joints: Collection[str]) -> bool:
    """Whether a column numbers (or, nameless, names) the rows."""
    if name in joints or name.lower() not in COUNTS or (name == "" and column > 0) or len(rows.cells) <= MIN_FRAMES:
        return False
    cells = rows.cells[1:, column]
    if all(re.fullmatch(r"\d{1,9}(?:\.0*)?", cell) for cell in cells):
        steps = np.diff(cells.astype(float))
        return bool((steps == 1).all() if name == "" else (steps > 0).all())
    return name == "" and not any(re.match(r"[+-]?[.,]?\d|$|nan", cell, re.I) for cell in cells)
