"""Reading a movement by its file's suffix."""

import os
from collections.abc import Callable, Collection, Mapping
from pathlib import Path

from models.errors import BodyError, unknown
from models.files import checked, text
from models.hoap2.motion_file import looks_like_motion_file, parse_motion_file
from models.motion.archives import read_archive
from models.motion.checks import check_pace
from models.motion.tables import Unit, parse_table
from models.motion.trajectory import JointTrajectory
from models.tables import table


def read_text(
    path: str | os.PathLike[str], unit: Unit | None = None, joints: Collection[str] = (), slides: Collection[str] = ()
) -> JointTrajectory:
    """Read a table with a header, or the real HOAP-2's motion file, known by its lines."""
    content = text(path)
    rows = table(content, Path(path))
    if looks_like_motion_file(rows):
        return parse_motion_file(rows)
    return parse_table(rows, content, unit, joints, slides)


Reader = Callable[[str | os.PathLike[str], Unit | None, Collection[str], Collection[str]], JointTrajectory]
FORMATS: dict[str, Reader] = {".csv": read_text, ".tsv": read_text, ".txt": read_text, ".npz": read_archive}
"""Suffix -> reader of (path, unit, joints, slides): see `parse_table`. It raises BodyError, one line, for whatever is
wrong with a file."""


def read_motion(
    path: str | os.PathLike[str],
    ranges: Mapping[str, tuple[float, float]] | None = None,
    unit: Unit | None = None,
    slides: Collection[str] = (),
    joints: Collection[str] = (),
) -> JointTrajectory:
    """The movement in a file.

    ranges: joint -> lowest and highest angle in radians of the body that is to do it; every joint of the file must be
    one of them and stay inside. unit: of the angles, overruling what the file declares (radians if it says nothing).
    slides: joints whose numbers are lengths, metres unless their columns say otherwise. joints: names that there are,
    where ranges do not say.

    Raises:
        BodyError: a file that cannot be read, or a movement that cannot be meant.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        checked(path)
        raise BodyError(f"{path}: {unknown('motion file suffix', suffix, FORMATS)}")
    trajectory = FORMATS[suffix](path, unit, ranges or joints, slides)
    if ranges is not None:
        trajectory.check_ranges(ranges, slides)
    check_pace(trajectory, slides)
    return trajectory
