"""Joint trajectories as NumPy archives: `time` (T,) or `time_ms`, `angles` (T, J), `joints` (J,) text, `unit` or none.

Nothing but plain numbers and text is loaded: an archive with Python objects inside is refused.
"""

import os
import zipfile
from collections.abc import Collection
from io import BytesIO
from math import prod
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.errors import BodyError
from models.files import LIMIT_BYTES, raw
from models.motion.tables import LONGEST_NAME, Unit, in_unit
from models.motion.trajectory import JointTrajectory
from models.tables import MOST_COLUMNS

MOST_ARRAYS, LONGEST_HEADER = 100, 10_000
KINDS = {"time": "fiu", "angles": "fiu", "joints": "U"}
"""Array -> kinds of NumPy's types that it may have: real numbers, text."""


def read_archive(
    path: str | os.PathLike[str], unit: Unit | None = None, joints: Collection[str] = (), slides: Collection[str] = ()
) -> JointTrajectory:
    """Read an archive; `unit` overrules what it declares (radians when neither says), `slides` are in metres."""
    path, arrays = Path(path), dict[str, NDArray[np.generic]]()
    try:
        content = raw(path)
        if content.count(b"PK\1\2") > MOST_ARRAYS:
            raise BodyError(f"{path}: holds more than {MOST_ARRAYS} arrays; leave others out")
        with zipfile.ZipFile(BytesIO(content)) as bundle:
            entries = bundle.infolist()
            unpacked = sum(entry.file_size for entry in entries)
            if unpacked > LIMIT_BYTES:
                raise BodyError(
                    f"{path}: unpacks to {unpacked / 2**20:,.0f} MB where at most {LIMIT_BYTES / 2**20:,.0f} MB are "
                    "read; cut it into shorter movements"
                )
            held = {entry.filename.removesuffix(".npy"): entry for entry in entries}
            for key in (*KINDS, "time_ms", "unit"):
                if key in held:
                    arrays[key] = _array(bundle, held[key], f"{path}: array {key!r}")
            present = ", ".join(held) or "none"
    except BodyError:
        raise
    except Exception:  # zipfile, zlib and NumPy raise many kinds on damaged files
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
    named, said = np.atleast_1d(arrays["joints"]), arrays.get("unit", np.array("rad"))
    if named.size > MOST_COLUMNS or said.size != 1 or max(named.itemsize, said.itemsize) > 4 * LONGEST_NAME:
        raise BodyError(
            f"{path}: {named.size} joints, {said.size} units; at most {MOST_COLUMNS} joints and one unit, with "
            f"names of at most {LONGEST_NAME} letters, are read"
        )
    names, usual = [str(name) for name in named.flat], unit or str(said.flat[0])
    units = ["m" if name in slides else usual for name in names]
    return in_unit(path, arrays["time"], names, arrays["angles"], units, clock)


def _array(bundle: zipfile.ZipFile, entry: zipfile.ZipInfo, said: str) -> NDArray[np.generic]:
    """An array of plain numbers or text, as large as its header says."""
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise BodyError(f"{said} is packed in a way that NumPy does not; write it again with numpy.savez")
    content = bundle.read(entry)
    stream = BytesIO(content)
    try:
        version = np.lib.format.read_magic(stream)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, fortran, dtype = header(stream, max_header_size=LONGEST_HEADER)
        if dtype.hasobject:
            raise BodyError(f"{said} holds Python objects, which are never loaded; store plain numbers and text")
        if prod(shape) * dtype.itemsize != len(content) - stream.tell():
            raise ValueError
        return np.frombuffer(content, dtype, offset=stream.tell()).reshape(shape, order="F" if fortran else "C")
    except BodyError:
        raise
    except Exception:  # NumPy evaluates headers: many kinds
        raise BodyError(f"{said} is damaged; write it again with numpy.savez") from None
