"""Reading a movement by its file's suffix."""

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from models.errors import BodyError, unknown
from models.files import checked, text
from models.hoap2.motion_file import looks_like_motion_file, parse_motion_file
from models.motion.archives import read_archive
from models.motion.tables import Unit, parse_table
from models.motion.trajectory import JointTrajectory


def read_csv(path: str | os.PathLike[str], unit: Unit | None = None) -> JointTrajectory:
    """Read comma-separated text: a table with a header, or the real HOAP-2's motion file, known by its lines."""
    content = text(path)
    if looks_like_motion_file(content):
        return parse_motion_file(content, Path(path))
    return parse_table(content, Path(path), unit)


FORMATS: dict[str, Callable[[str | os.PathLike[str], Unit | None], JointTrajectory]] = {
    ".csv": read_csv,
    ".npz": read_archive,
}
"""Suffix -> reader. A reader raises BodyError, one line, for whatever is wrong with a file."""


def read_motion(
    path: str | os.PathLike[str], ranges: Mapping[str, tuple[float, float]] | None = None, unit: Unit | None = None
) -> JointTrajectory:
    """The movement in a file.

    ranges: joint -> lowest and highest angle in radians of the body that is to do it; every joint of the file must be
    one of them and stay inside. unit: of the angles, overruling what the file declares (radians if it says nothing).
    """
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        checked(path)
        raise BodyError(f"{path}: {unknown('motion file suffix', suffix, FORMATS)}")
    trajectory = FORMATS[suffix](path, unit)
    if ranges is not None:
        trajectory.check_ranges(ranges)
    return trajectory
