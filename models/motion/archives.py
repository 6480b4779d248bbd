"""Joint trajectories as NumPy archives: `time` (T,), `angles` (T, J), `joints` (J,) text, optional `unit`.

Nothing but plain numbers and text is loaded: an archive with Python objects inside is refused.
"""

import os
import zipfile
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from models.motion.files import LIMIT_BYTES, MotionError, checked, write
from models.motion.tables import UNITS, Unit
from models.motion.trajectory import JointTrajectory

KEYS = ("time", "angles", "joints")


def read_archive(path: str | os.PathLike[str], unit: Unit | None = None) -> JointTrajectory:
    """Read an archive; `unit` overrules what it declares (radians when neither says)."""
    path = checked(path)
    try:
        with zipfile.ZipFile(path) as bundle:
            unpacked = sum(entry.file_size for entry in bundle.infolist())
        if unpacked > LIMIT_BYTES:
            raise MotionError(
                f"{path}: unpacks to {unpacked / 2**20:,.0f} MB where at most {LIMIT_BYTES / 2**20:,.0f} MB are read; "
                "cut it into shorter movements"
            )
        with np.load(path, allow_pickle=False) as archive:
            present = list(archive.files)
            for key in KEYS:
                if key not in present:
                    raise MotionError(f"{path}: array {key!r} is missing; there are {', '.join(present) or 'none'}")
            time, angles, joints = (_array(archive, key, path) for key in KEYS)
            declared = unit or (str(_array(archive, "unit", path)) if "unit" in present else "rad")
    except (zipfile.BadZipFile, EOFError, OSError, NotImplementedError, RuntimeError, MemoryError):
        raise MotionError(f"{path}: is not a complete NumPy archive; write it again with numpy.savez") from None
    if declared not in UNITS:
        raise MotionError(f"{path}: unit {declared!r}; angles are in 'rad' or 'deg'")
    for key, values in (("time", time), ("angles", angles)):
        if values.dtype.kind not in "fiu":
            raise MotionError(f"{path}: array {key!r} holds {values.dtype}; it must hold real numbers")
    if joints.ndim != 1 or joints.dtype.kind != "U":
        raise MotionError(f"{path}: array 'joints' holds {joints.dtype} {joints.shape}; it must be a list of names")
    radians = np.asarray(angles, dtype=float) * UNITS[declared]
    return JointTrajectory(str(path), np.asarray(time, dtype=float), tuple(map(str, joints)), radians)


def write_archive(trajectory: JointTrajectory, path: str | os.PathLike[str]) -> None:
    """Write a trajectory in radians: reading it again gives the same numbers."""

    def fill(stream: IO[bytes]) -> None:
        np.savez(stream, time=trajectory.time, angles=trajectory.angles, joints=np.array(trajectory.joints), unit="rad")

    write(path, fill)


def _array(archive: "np.lib.npyio.NpzFile", key: str, path: Path) -> NDArray[np.generic]:
    try:
        return np.asarray(archive[key])
    except ValueError as fault:
        if "allow_pickle" in str(fault):
            raise MotionError(
                f"{path}: array {key!r} holds Python objects, which are never loaded; store plain numbers and text"
            ) from None
        raise MotionError(f"{path}: array {key!r} is damaged; write it again with numpy.savez") from None
