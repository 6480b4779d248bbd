"""The variables of a NetCDF file, one by one: the only place where they are written, read and judged."""

from collections.abc import Sequence
from typing import Any

import h5netcdf
import h5py
import numpy as np
from numpy.typing import DTypeLike, NDArray

from babbling.errors import BabblingError
from babbling.kinds import Numbers

LARGEST_UNPACKED, LARGEST_PIECE, LARGEST_TEXT, MOST_PIECES = 1 << 32, 1 << 21, 1 << 20, 1 << 16


class Variables:
    """A file that is being written (h5netcdf) or read (h5py), and every check of what may be in it."""

    def __init__(self, file: h5netcdf.File | h5py.File, largest: int = LARGEST_UNPACKED) -> None:
        self.file, self.bytes, self.largest = file, 0, largest
        self.sizes: dict[str, int] = {}
        self.indices: list[tuple[str, int, str]] = []

    def numbers(self, name: str, numbers: Numbers, dtype: DTypeLike, value: object = None, **told: Any) -> NDArray[Any]:
        """Write a value, or (None) read the one that is there; `told` become attributes.

        Raises:
            BabblingError: it is missing, has another type or shape, or holds what cannot be.
        """
        data = self.found(name, np.dtype(dtype)) if value is None else np.asarray(value, dtype)
        dims = [word.partition(":")[0] for word in numbers.dims.split()]
        for word, dim, size in zip(numbers.dims.split(), dims, data.shape, strict=False):
            self.sizes.setdefault(dim, int(word.partition(":")[2] or size))
        wanted = tuple(self.sizes.get(dim, 0) for dim in dims)
        if data.shape != wanted:
            raise BabblingError(
                f"{name} has shape {data.shape}; {wanted} is needed ({', '.join(dims) or 'one number'})"
            )
        values: NDArray[Any] = np.asarray(data[()])
        if values.size and values.dtype.kind != "S":
            self._check(name, numbers, values)
        if value is not None:
            told |= {"scale_factor": numbers.scale} if numbers.scale != 1 else {}
            self.put(name, dims, values, **({"units": numbers.unit} if numbers.unit else {}), **told)
        return values

    def found(self, name: str, dtype: np.dtype[Any]) -> h5py.Dataset:
        """A variable of bounded size that lies in this very file; not read yet."""
        data = self.file[name] if isinstance(self.file.get(name, getlink=True), h5py.HardLink) else None
        if not isinstance(data, h5py.Dataset) or data.external or data.is_virtual or data.dtype != dtype:
            raise BabblingError(f"{name} is missing, or not of type {dtype}, as of another version; make it anew")
        self.bytes += int(data.nbytes)
        if self.bytes > self.largest or (dtype.kind == "S" and data.nbytes > LARGEST_TEXT):
            raise BabblingError(f"{name} unpacks to {data.nbytes} bytes; {self.largest} are read of a file")
        if data.chunks is not None:  # a packed piece that is larger than it should be is unpacked before anyone looks
            pieces: list[int] = []
            if (count := data.id.get_num_chunks()) <= MOST_PIECES:
                data.id.chunk_iter(lambda piece: pieces.append(piece.size))
            if count > MOST_PIECES or max(pieces, default=0) > LARGEST_PIECE:
                raise BabblingError(f"{name} is {count} pieces; {MOST_PIECES} of {LARGEST_PIECE} bytes are read")
        return data

    def _check(self, name: str, numbers: Numbers, values: NDArray[Any]) -> None:
        low, high = values.min(), values.max()
        if not (numbers.low <= low and high <= numbers.high) or not (numbers.zero or values.all()):
            bad = low if high <= numbers.high else high
            but = "" if numbers.zero else " other than 0"
            raise BabblingError(f"{name} holds {bad:g}; {numbers.low:g} to {numbers.high:g}{but} is possible")
        if numbers.covariance:
            least = np.linalg.eigvalsh(values.astype(float))[..., 0]
            even = np.array_equal(values, np.swapaxes(values, -1, -2))
            if not even or (least < -1e-9 * np.abs(values).max((-1, -2))).any():
                raise BabblingError(f"{name} holds a matrix that is no covariance (symmetric, not negative)")
        if numbers.index:
            self.indices.append((name, int(high), numbers.index))

    def finish(self) -> None:
        """Check what can only be checked when everything is there.

        Raises:
            BabblingError: a number that counts beyond its dimension.
        """
        for name, largest, dim in self.indices:
            if largest >= self.sizes[dim]:
                raise BabblingError(f"{name} holds {largest}; {dim} has 0 to {self.sizes[dim] - 1}")

    def put(self, name: str, dims: Sequence[str], values: NDArray[Any], **told: Any) -> None:
        """Write a variable, unless it is there already.

        Raises:
            BabblingError: something else is there.
        """
        if name in self.file.variables:
            if not np.array_equal(self.file.variables[name][()], values):
                raise BabblingError(f"two different things are called {name}")
            return
        distinct = [dim + "_" * dims[:i].count(dim) for i, dim in enumerate(dims)]  # as NetCDF wants them
        for dim, size in zip(distinct, values.shape, strict=True):
            if dim not in self.file.dimensions:
                self.file.dimensions[dim] = size or None
        packed = {"compression": "gzip", "compression_opts": 3, "shuffle": True} if values.size > 4096 else {}
        variable = self.file.create_variable(name, distinct, values.dtype, values, **packed)
        variable.attrs.update({"_Encoding": "utf-8"} if values.dtype.kind == "S" else {}, **told)

    def words(self, name: str, value: Sequence[str] | None = None, *, single: bool = False) -> tuple[str, ...]:
        """Distinct words, as letters: names of what lies along the dimension of this name, or a `single` text.

        Raises:
            BabblingError: they are not printable, not distinct or too long.
        """
        numbers = Numbers(f"{name}_letters" if single else f"{name} {name}_letters")
        coded = None if value is None else letters(value)
        rows = np.atleast_2d(self.numbers(name, numbers, "S1", coded[0] if coded is not None and single else coded))
        words = tuple(row.tobytes().rstrip(b"\0").decode(errors="replace") for row in rows)
        if not all(word.isprintable() for word in words) or len(set(words)) < len(words):
            raise BabblingError(f"{name} is not made of distinct words that can be printed")
        return words


def letters(words: Sequence[str]) -> NDArray[np.bytes_]:
    """(N, longest) letters, at least one each."""
    coded = np.array([word.encode() for word in words] + [b"0"])[:-1]
    return coded.view("S1").reshape(len(words), -1)
