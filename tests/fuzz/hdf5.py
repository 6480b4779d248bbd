"""NetCDF files as strangers write them: any valid HDF5 in which something is not what it should be."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np

from babbling.files import sealed
from tests.fuzz.mutations import Rng

NUMBERS = (np.nan, np.inf, -np.inf, 1e308, -1e308, 1e30, 1e9, -1.0, -0.0, 0.0, 1.0, 5e-324)
INTEGERS = (-(2**63), 2**63 - 1, 2**62, -1, 0, 1, 2**31, 2**53)
LONG = 100_000


def values(rng: Rng) -> object:
    """Something of any type and shape."""
    made: tuple[Callable[[], object], ...] = (
        lambda: int(rng.choice(INTEGERS)),
        lambda: float(rng.choice(NUMBERS)),
        lambda: np.float32(rng.choice(NUMBERS[:3])),
        lambda: np.full((3,), rng.choice(NUMBERS)),
        lambda: np.zeros((2, 2, 2)),
        lambda: np.zeros((0,)),
        lambda: np.zeros((0, 3)),
        lambda: "a\x1b[31m\n\u202e",
        lambda: "x" * LONG,
        lambda: b"\xff\xfe",
        lambda: np.array([b"x", b"y"]),
        lambda: np.array(["x", "é" * 50], dtype=h5py.string_dtype()),
        lambda: np.array([b"\xff"] * 3, dtype=h5py.string_dtype("ascii")),
        lambda: np.array(["x" * 300], dtype=h5py.string_dtype("utf-8", 300)),
        lambda: h5py.Empty("f8"),
        lambda: np.array([True, False]),
        lambda: np.array([1 + 2j]),
        lambda: np.zeros(2, [("a", "f8"), ("b", "S3")]),
        lambda: np.zeros(3, ">f8"),
        lambda: np.zeros(3, "f2"),
        lambda: np.zeros(3, np.uint64) + np.uint64(2**64 - 1),
        lambda: np.array(np.void(b"\1\2\3")),
    )
    return made[int(rng.integers(len(made)))]()


def attribute(file: h5py.File, name: str, rng: Rng) -> None:
    """`format`, `version` or another attribute, of the file or of a variable, is something else."""
    of = file if rng.random() < 0.8 else file[name]
    named = str(rng.choice(["format", "version", "version", "_NCProperties", "scale_factor", "DIMENSION_LIST"]))
    of.attrs[named] = file.ref if rng.random() < 0.1 else values(rng)


def many_attributes(file: h5py.File, name: str, rng: Rng) -> None:
    for number in range(300):
        file.attrs[f"a{number}"] = number


def other_value(file: h5py.File, name: str, rng: Rng) -> None:
    """A variable of another type or shape."""
    del file[name]
    file[name] = values(rng)


def other_numbers(file: h5py.File, name: str, rng: Rng) -> None:
    """Some of its numbers are others: they may be possible."""
    held = np.array(file[name][()])
    flat = held.reshape(-1)
    if not flat.size or held.dtype.kind not in "iufS":
        return other_value(file, name, rng)
    for place in rng.integers(flat.size, size=int(rng.choice([1, 2, flat.size]))):
        if held.dtype.kind == "f":
            flat[place] = rng.choice(NUMBERS) if rng.random() < 0.6 else flat[place] * 2.0 ** rng.integers(-9, 9)
        elif held.dtype.kind == "S":
            flat[place] = bytes([int(rng.integers(256))])
        else:
            flat[place] = rng.choice(INTEGERS) if rng.random() < 0.5 else flat[place] + rng.integers(-2, 3)
    file[name][...] = held


def other_shape(file: h5py.File, name: str, rng: Rng) -> None:
    """Longer, shorter or turned along one dimension."""
    held = np.array(file[name][()])
    if not held.ndim:
        return other_value(file, name, rng)
    axis, size = int(rng.integers(held.ndim)), int(rng.choice([0, 1, 2, 7]))
    ways = (held[None], held.T, np.take(held, range(0), axis), np.resize(held, (*held.shape[:-1], size)), held.ravel())
    del file[name]
    file[name] = ways[int(rng.integers(len(ways)))] if axis else np.repeat(held, 2, axis)


def longer_everywhere(file: h5py.File, name: str, rng: Rng) -> None:
    """Whatever has this variable's first size has another: every shape still fits every other."""
    size = file[name].shape[0] if file[name].shape else 1
    wanted = int(rng.choice([0, 1, size + 1, 2 * size, 400]))
    for other in [one for one in file if plain(file, one)]:
        held = np.array(file[other][()])
        shape = [wanted if side == size else side for side in held.shape]
        if held.dtype.kind in "iufS" and np.prod(shape, dtype=float) < 1e6:
            del file[other]
            file[other] = np.resize(held, shape) if held.size else np.zeros(shape, held.dtype)


def huge(file: h5py.File, name: str, rng: Rng) -> None:
    """Far more is declared than is there."""
    dims, dtype = max(1, len(file[name].shape or ())), file[name].dtype
    sides = [int(side) for side in rng.choice([1, 3, 1000, 10**5, 10**9, 2**40], dims)]
    sides = [side if np.prod(sides[:at], dtype=float) < 2**30 else 1 for at, side in enumerate(sides)]
    chunks = tuple(min(side, 1 << 10 if dims == 1 else 16) for side in sides)
    del file[name]
    made = file.create_dataset(name, sides, dtype, chunks=chunks, compression=rng.choice(["gzip", "lzf"]))
    if rng.random() < 0.5:
        made.id.write_direct_chunk((0,) * dims, rng.bytes(int(rng.choice([0, 5, 5000]))))


def packed(file: h5py.File, name: str, rng: Rng) -> None:
    """The same numbers, stored otherwise."""
    held, ways = np.array(file[name][()]), ({"fletcher32": True}, {"shuffle": True}, {"compression": "lzf"})
    if not held.size or not held.ndim or held.dtype.kind not in "iufS":
        return other_value(file, name, rng)
    del file[name]
    chunks = tuple(int(rng.integers(1, side + 1)) for side in held.shape)
    file.create_dataset(name, data=held, chunks=chunks, maxshape=(None,) * held.ndim, **ways[int(rng.integers(3))])


def linked(file: h5py.File, name: str, rng: Rng) -> None:
    """Something that is not in this file, or elsewhere in it, or a group, or a type."""
    shape, dtype = file[name].shape, file[name].dtype
    del file[name]
    way = int(rng.integers(8))
    if way == 0:
        file[name] = h5py.SoftLink(str(rng.choice(["/", f"/{name}", "/nowhere", "."])))
    elif way == 1:
        file[name] = h5py.ExternalLink(str(rng.choice(["/dev/zero", "/dev/stdin", "case.nc", "/etc/passwd"])), "/x")
    elif way == 2:
        file[name] = file["/"]
    elif way == 3:
        file.create_group(name).create_group("below")
    elif way == 4:
        file[name] = np.dtype("f8")
    elif way == 5:
        file[name] = np.array([file.ref] * 3, dtype=h5py.ref_dtype)
    elif way == 6:
        file.create_dataset(name, shape or (1,), dtype, external=[("/dev/zero", 0, h5py.h5f.UNLIMITED)])
    else:
        layout = h5py.VirtualLayout(shape or (1,), dtype)
        layout[...] = h5py.VirtualSource("case.nc", name, shape or (1,))
        file.create_virtual_dataset(name, layout)


def extra(file: h5py.File, name: str, rng: Rng) -> None:
    """More than is asked for."""
    for number in range(int(rng.choice([1, 5, 200]))):
        file[f"more{number}/{'x' * int(rng.choice([1, 200]))}"] = values(rng)


def exchanged(file: h5py.File, name: str, rng: Rng) -> None:
    """Two variables change names."""
    other = str(rng.choice([one for one in file if plain(file, one)]))
    if other != name:
        file.move(other, "aside")
        file.move(name, other)
        file.move("aside", name)


def missing(file: h5py.File, name: str, rng: Rng) -> None:
    del file[name]


WAYS = (
    *(attribute, attribute, many_attributes, other_value, other_numbers, other_numbers, other_numbers, other_shape),
    *(longer_everywhere, huge, packed, linked, linked, extra, exchanged, missing),
)


def plain(file: h5py.File, name: str) -> bool:
    """Whether it is a variable that can still be spoiled."""
    one = file[name] if isinstance(file.get(name, getlink=True), h5py.HardLink) else None
    return isinstance(one, h5py.Dataset) and one.nbytes < 1 << 22 and not one.external and not one.is_virtual


def spoil(path: Path, rng: Rng) -> None:
    """Change a valid file in place, once to three times; half of all files have a right checksum again."""
    with h5py.File(path, "r+") as file:
        for _ in range(int(rng.integers(1, 4))):
            if names := [one for one in file if plain(file, one)]:
                with suppress(OSError, ValueError, TypeError):  # what cannot be done to it
                    WAYS[int(rng.integers(len(WAYS)))](file, str(rng.choice(names)), rng)
    if rng.random() < 0.5:
        path.write_bytes(sealed(path.read_bytes()))
