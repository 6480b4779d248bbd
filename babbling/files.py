"""Whatever has been learned, as a file: NetCDF-4 that MATLAB, R, Julia and xarray open too; numbers and text, no code.

One writer and reader for every class entered in `babbling.kinds.KINDS`: it walks the annotations of the fields. A field
is a variable named by its path; several things of one class are laid end to end, field by field (contiguous ragged
arrays of the CF conventions, section 9.3.3); a forward model is its visits, moments and axes.

Strangers' files are read too. Sizes are bounded before anything is read, nothing is read but what the annotations name,
and all of it is checked against them; whatever is wrong is one line.
"""

import hashlib
import io
import os
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints

import h5netcdf
import h5py
import numpy as np

from babbling.axes import Axis, IntArray
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel
from babbling.kinds import KINDS, Kind, Numbers
from babbling.regression import SCALE
from babbling.variables import LARGEST_PIECE, Variables, letters
from babbling.whole import whole
from models import files
from models.apart import tried
from models.errors import BodyError

FORMAT, VERSION = "imitation-laboratory", 4
LARGEST_BYTES, MOST_ENTRIES, MOST_AXES, MOST_COUNTS = 1 << 30, 1 << 16, 8, 2.0**62
SEAL = b"imitation-laboratory sha256 "
"""Stands with the checksum behind the end of a file, where HDF5 does not look: some damage hangs HDF5. A file without
it (another program wrote it anew) is held to all other checks."""
LEAST_EXPERIENCE = 10
"""Transitions per factor below which no line can be fitted."""
T = TypeVar("T")


def save(thing: object, path: Path, labels: Mapping[str, Sequence[str]] | None = None, **notes: str | float) -> None:
    """Write a thing of a kind in `KINDS`.

    Args:
        thing: what to write.
        path: the file; an older one is replaced.
        labels: dimension -> names of what lies along it; like `notes` (attributes) for people alone, never read.

    Raises:
        BabblingError: the place cannot be written, or the thing holds what could not be read again.
    """
    name, kind = _kind(type(thing))
    content = io.BytesIO()  # HDF5 dies of a full disk
    try:
        with h5netcdf.File(content, "w") as file:
            file.attrs.update({"format": f"{FORMAT} {name}", "version": VERSION, **notes})
            held = Variables(file)
            _walk(held, type(thing), "", thing)
            held.finish()
            for dim, names in (labels or {}).items():
                held.put(f"{dim}_name", (dim, f"{dim}_name_letters"), letters(names))
        with whole(path) as beside:
            beside.write_bytes(sealed(content.getbuffer()))
    except BabblingError as error:
        raise kind.error(f"{path}: cannot be written: {error}") from error
    except OSError as error:
        raise kind.error(f"{path}: cannot be written ({error.strerror or error}); name a place that can") from error


def load(path: Path, holds: type[T]) -> T:
    """Read a thing of a kind in `KINDS`.

    Raises:
        BabblingError: (the kind's own) the file is missing, of another kind or version, too large or damaged, or holds
            what cannot be: one line that names file, field and what is possible.
    """
    name, kind = _kind(holds)
    try:
        with opened(path) as file:
            found, version = _attribute(file, "format"), _attribute(file, "version")
            if found != f"{FORMAT} {name}":
                raise BabblingError(f"this is not a file of kind '{FORMAT} {name}'; {kind.remedy}")
            if type(version) is not int or not 1 <= version <= VERSION:
                raise BabblingError(f"written in version {version}, this program reads up to {VERSION}; update it")
            if version < VERSION:
                raise BabblingError(f"written by an earlier version of this program; {kind.remedy}")
            held = Variables(file)
            thing: T = _walk(held, holds, "", None)
            held.finish()
            return thing
    except BabblingError as error:
        raise kind.error(f"{path}: {error}") from error
    except Exception as error:  # h5py raises many kinds on damaged files
        raise kind.error(f"{path}: this NetCDF-4 file is damaged; make it anew") from error


def is_kind(path: Path, holds: type, **notes: str | float) -> bool:
    """Whether a file is of this kind, of whatever version, and has these notes, by its header alone."""
    with suppress(Exception), opened(path) as file:
        told = {"format": f"{FORMAT} {_kind(holds)[0]}", **notes}
        return all(_attribute(file, name) == value for name, value in told.items())
    return False


def _kind(holds: type) -> tuple[str, Kind]:
    return next((name, kind) for name, kind in KINDS.items() if kind.holds is holds)


def opened(path: Path) -> h5py.File:
    """A regular file of bounded size, its checksum right where it has one.

    Raises:
        BabblingError: it is not, or no NetCDF-4.
    """
    try:
        content = files.opened(path, LARGEST_BYTES)
    except BodyError as error:
        raise BabblingError(str(error).removeprefix(f"{path}: ")) from error
    left = max(content.seek(0, os.SEEK_END) - len(_seal(b"")), 0)
    content.seek(max(left - len(_seal(b"")), 0))
    near = content.read()
    end, digest = near[-len(_seal(b"")) :], hashlib.sha256()
    content.seek(0)
    alike = sum(one == other for one, other in zip(end, SEAL, strict=False))
    if alike > len(SEAL) / 2 or SEAL[: len(SEAL) // 2] in near:  # it may be damaged itself, or cut
        while part := content.read(min(left, LARGEST_PIECE)):
            digest.update(part)
            left -= len(part)
        if end != SEAL + digest.digest():
            raise BabblingError("this NetCDF-4 file is damaged; make it anew")
    else:
        try:
            tried("babbling.files:rehearse", path)
        except BodyError as error:
            raise BabblingError(str(error).removeprefix(f"{path}: ")) from error
    try:
        return h5py.File(content, "r")
    except Exception as error:
        raise BabblingError("not a readable NetCDF-4 file (truncated, or something else); make it anew") from error


def rehearse(path: Path) -> None:
    """Read all of a file that has no seal, as far as it is within bounds, to see whether HDF5 comes to an end."""
    with opened(path) as file:
        held = Variables(file)
        for name in ("format", "version"):
            _attribute(file, name)
        for name in file:
            data = file[name] if isinstance(file.get(name, getlink=True), h5py.HardLink) else None
            with suppress(BabblingError):
                if isinstance(data, h5py.Dataset):
                    held.found(name, data.dtype)[()]


def sealed(content: bytes | memoryview) -> bytes:
    """A file that is complete, its checksum behind its end."""
    return bytes(content) + _seal(content)


def _seal(content: bytes | memoryview) -> bytes:
    return SEAL + hashlib.sha256(content).digest()


def _attribute(file: h5py.File, name: str) -> object:
    """One number or text; None where there is something else."""
    if name not in file.attrs or file.attrs.get_id(name).shape not in ((), (1,)):
        return None
    value: object = np.asarray(file.attrs[name]).reshape(-1)[0]
    return value.item() if isinstance(value, np.generic) else value


def _plain(hint: Any) -> tuple[Any, Any, Numbers]:
    """A field's type, the type of its numbers, and what they may be."""
    holds, numbers = (hint.__origin__, hint.__metadata__[0]) if get_origin(hint) is Annotated else (hint, Numbers())
    return holds, get_args(get_args(holds)[1])[0] if get_origin(holds) is np.ndarray else holds, numbers


def _walk(held: Variables, hint: Any, name: str, value: Any) -> Any:
    """Write a value of this type, or (None) read one."""
    holds, dtype, numbers = _plain(hint)
    origin, inner = get_origin(holds), get_args(holds)
    if holds is str:
        return held.words(name, None if value is None else [value], single=True)[0]
    if holds in (int, float):
        return holds(held.numbers(name, numbers, holds, value))
    if origin is np.ndarray and numbers.dims:
        return held.numbers(name, numbers, dtype, value)
    if holds is Axis:
        return _axis(held, name.rpartition("_")[2], numbers.dims, value)
    if holds is ForwardModel:
        return _forward_model(held, name, numbers.dims, value)
    if origin is Mapping:
        names = held.words(numbers.dims, value and tuple(value))
        return dict(zip(names, _several(held, inner[1], name, numbers.dims, value and value.values()), strict=True))
    if origin is tuple:
        return _several(held, inner[0], name, numbers.dims, value)
    path = f"{name}_" if name else ""
    fields = get_type_hints(holds, include_extras=True)
    return holds(**{f: _walk(held, hint, path + f, getattr(value, f, None)) for f, hint in fields.items()})


def _several(held: Variables, one: type, name: str, dim: str, things: Any) -> tuple[Any, ...]:
    """Things of one class, whose fields are numbers: each field is one variable, its rows end to end."""
    columns: dict[str, Sequence[Any]] = {}
    for field, hint in get_type_hints(one, include_extras=True).items():
        _, dtype, numbers = _plain(hint)
        first, _, rest = numbers.dims.partition(" ")
        rows = None if things is None else [np.asarray(getattr(thing, field), dtype) for thing in things]
        if not first.startswith("."):
            numbers = replace(numbers, dims=f"{dim} {numbers.dims}")
            columns[field] = held.numbers(f"{name}_{field}", numbers, dtype, rows)[:MOST_ENTRIES].tolist()
            continue
        own = f"{name}_{first[1:]}"
        counts = None if rows is None else [len(row) for row in rows]
        ends = np.cumsum(held.numbers(f"{own}_count", Numbers(dim, low=0), np.int64, counts, sample_dimension=own))
        numbers = replace(numbers, dims=f"{own} {rest}")
        values = held.numbers(f"{name}_{field}", numbers, dtype, None if rows is None else np.concatenate(rows))
        if not 0 < len(ends) <= MOST_ENTRIES or len(values) != ends[-1]:
            raise BabblingError(f"{own}_count tells of {len(ends)} things and other rows than {name}_{field} has")
        columns[field] = np.split(values, ends[:-1])
    return tuple(one(**dict(zip(columns, row, strict=True))) for row in zip(*columns.values(), strict=True))


def _axis(held: Variables, name: str, factor: str, axis: Any) -> Axis:
    """An axis, by its categories or its grid points; one that several share is there once."""
    if axis is not None and axis.name != name:
        raise TypeError(f"axis {axis.name!r} is held in a field that is called {name!r}")
    if axis.is_categorical if axis is not None else f"{name}_points" not in held.file:
        return Axis.categorical(name, held.words(name, axis and axis.labels), held.sizes[factor])
    unit = held.words(f"{name}_unit", axis and [axis.unit], single=True)[0]
    points = held.numbers(f"{name}_points", Numbers(f"{factor} {name}", unit), np.float64, axis and axis.points)
    found = Axis(name, unit, points[:, 0], points[:, -1], points.shape[1])
    if (np.abs(points - found.points) > 1e-6 * found.step[:, None]).any():
        raise BabblingError(f"{name}_points are not evenly spaced")
    return found


def _forward_model(held: Variables, name: str, factor: str, model: Any) -> ForwardModel:
    """Visits and moments on their axes; for people, P(outcome | context, action) too."""
    factors = held.words(factor, model and model.factors)
    names = held.words(f"{name}_axes", model and [axis.name for axis in model.axes])
    if not 2 <= len(names) <= MOST_AXES or not all(re.fullmatch("[a-z][a-z0-9_]{0,39}", word) for word in names):
        raise BabblingError(f"{name}_axes are {', '.join(names)}; 2 to {MOST_AXES} names are needed")
    axes = [_axis(held, word, factor, model and model.axes[i]) for i, word in enumerate(names)]
    dims, term = f"{factor} {' '.join(names)}", f"{name}_term:{1 + len(names)}"
    scale = 1 / model.unit if model else 1.0
    fields = {
        "counts": Annotated[IntArray, Numbers(dims, "visits", low=0, high=MOST_COUNTS, scale=scale)],
        "outside": Annotated[IntArray, Numbers(factor, "visits", low=0)],
        "prior_strength": Annotated[float, Numbers(unit="visits", low=0, high=1e6)],
        "fingerprint": str,
    }
    counts, outside, strength, fingerprint = (
        _walk(held, hint, f"{name}_{field}", getattr(model, field, None)) for field, hint in fields.items()
    )
    products = Numbers(f"{factor} {term} {term}", low=-MOST_COUNTS, high=MOST_COUNTS, covariance=True, scale=SCALE**-2)
    told = "sums of products of 1 and the axes, each axis scaled from -1 to 1 over its range"
    found = ForwardModel(axes[:-2], *axes[-2:], factors=factors, prior_strength=strength, fingerprint=fingerprint)
    found.counts, found.outside = counts, outside
    found.moments.sums = held.numbers(
        f"{name}_moments", products, np.int64, model and model.moments.sums, long_name=told
    )
    rows, samples = counts.reshape(len(factors), -1), found.moments.samples
    if (rows.sum(1, dtype=float) > MOST_COUNTS).any() or (rows.sum(1) != samples * found.unit).any():
        raise BabblingError(f"{name}_counts and {name}_moments do not tell of the same experience")
    if strength > 0 and not found.outcome.is_categorical and (samples < LEAST_EXPERIENCE).any():
        raise BabblingError(f"{name} has next to no experience; {LEAST_EXPERIENCE} transitions per {factor} are needed")
    if model is not None:
        law = f"P({names[-1]} | {', '.join(names[:-1])}), to 6 decimals"
        where = " ".join(f"{axis.name}_points" for axis in axes if not axis.is_categorical)
        table = model.predictive.round(6).astype(np.float32)
        held.put(f"{name}_probability", dims.split(), table, long_name=law, coordinates=where)
    return found
