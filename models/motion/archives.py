"""Joint trajectories as NumPy archives: `time` (T,) or `time_ms`, `angles` (T, J), `joints` (J,) text, `unit` or none.

Nothing but plain numbers and text is loaded: an archive with Python objects inside is refused.
"""

import os
import zipfile
from collections.abc import Collection
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.errors import BodyError
from models.files import LIMIT_BYTES, checked
from models.motion.tables import Unit, in_unit
from models.motion.trajectory import JointTrajectory

KINDS = {"time": "fiu", "angles": "fiu", "joints": "U"}
"""Array -> kinds of NumPy's types that it may have: real numbers, text."""


def read_archive(
    path: str | os.PathLike[str], unit: Unit | None = None, joints: Collection[str] = (), slides: Collection[str] = ()
) -> JointTrajectory:
    """Read an archive; `unit` overrules what it declares (radians when neither says), `slides` are in metres."""
    path = checked(path)
    try:
        with zipfile.ZipFile(path) as bundle:
            unpacked = sum(entry.file_size for entry in bundle.infolist())
        if unpacked > LIMIT_BYTES:
            raise BodyError(
                f"{path}: unpacks to {unpacked / 2**20:,.0f} MB where at most {LIMIT_BYTES / 2**20:,.0f} MB are read; "
                "cut it into shorter movements"
            )
        with np.load(path, allow_pickle=False) as archive:
            arrays = {key: _array(archive, key, path) for key in (*KINDS, "time_ms", "unit") if key in archive}
            present = ", ".join(archive) or "none"
    except (zipfile.BadZipFile, EOFError, OSError, NotImplementedError, RuntimeError, MemoryError):
        raise BodyError(f"{path}: is not a complete NumPy archive; write it again with numpy.savez") from None
    clock = "ms" if "time_ms" in arrays and "time" not in arrays else ""
    if clock:
        arrays["time"] = arrays["time_ms"]
    for key, kinds in KINDS.items():
        if key not in arrays:
            raise BodyError(f"{path}: array {key!r} is missing; there are {present}")
        if arrays[key].dtype.kind not in kinds:
            right = "names" if kinds == "U" else "real numbers"
            raise BodyError(f"{path}: array {key!r} holds {arrays[key].dtype}; it must hold {right}")
    names = [str(name) for name in np.atleast_1d(arrays["joints"]).flat]
    usual = unit or str(arrays.get("unit", "rad"))
    units = ["m" if name in slides else usual for name in names]
    return in_unit(path, arrays["time"], names, arrays["angles"], units, clock)


def _array(archive: "np.lib.npyio.NpzFile", key: str, path: Path) -> NDArray[np.generic]:
    try:
        return np.asarray(archive[key])
    except ValueError as fault:
        if "allow_pickle" in str(fault):
            raise BodyError(
                f"{path}: array {key!r} holds Python objects, which are never loaded; store plain numbers and text"
            ) from None
        raise BodyError(f"{path}: array {key!r} is damaged; write it again with numpy.savez") from None
