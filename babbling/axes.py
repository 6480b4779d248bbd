"""Axes: discretised quantities, one grid per factor, with hard and soft assignment; reading tables laid on them.

The chapter (section 3.2) assumes discrete states and actions; bodies are continuous. An axis owns the way from the one
to the other. *Soft* (linear) assignment shares a value between its two neighbouring grid points so that the mean is
kept: it is the belief over discrete states that a sense leaves behind.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babbling.errors import BabblingError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
Number = TypeVar("Number", bound=np.generic)

UNIT = 1 << 12
"""Soft weights are integers, multiples of 1 / UNIT: their sums are exact, so counts merge exactly in any order."""


def fixed(values: NDArray[Number]) -> NDArray[Number]:
    """The same array, read-only from now on."""
    values.flags.writeable = False
    return values


class Soft(NamedTuple):
    """A value between two grid points: `weight / UNIT` of it belongs to `lower + 1`, the rest to `lower`."""

    lower: IntArray
    """(..., F) lower grid point, 0 .. size - 2 (0 where the axis has one point)."""
    weight: IntArray
    """(..., F) share of the upper grid point, 0 .. UNIT."""
    inside: BoolArray
    """(..., F) False where the value fell off the axis (its assignment is then the nearest end)."""


@dataclass(frozen=True)
class Axis:
    """A discretised quantity: `size` evenly spaced grid points from `low` to `high`, for each of F factors.

    A categorical axis (`Axis.categorical`) has labels, points 0, 1, 2, ... and only ever hard assignment.
    """

    name: str
    unit: str
    low: FloatArray
    """(F,) first grid point of each factor."""
    high: FloatArray
    """(F,) last grid point of each factor."""
    size: int
    labels: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        low = np.atleast_1d(np.asarray(self.low, float)).copy()
        high = np.atleast_1d(np.asarray(self.high, float)).copy()
        if low.shape != high.shape or low.ndim != 1:
            raise BabblingError(
                f"axis {self.name!r}: low has shape {low.shape}, high {high.shape}; give one per factor"
            )
        if self.size < 2 and not self.labels:
            raise BabblingError(f"axis {self.name!r}: {self.size} grid points; at least 2 are needed")
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            raise BabblingError(f"axis {self.name!r}: its range is not finite")
        if not self.labels and not (high > low).all():
            worst = int(np.argmin(high - low))
            raise BabblingError(
                f"axis {self.name!r}: factor {worst} has no extent ({low[worst]:g} to {high[worst]:g}); "
                "low must lie below high"
            )
        for name, value in (("low", low), ("high", high)):
            object.__setattr__(self, name, fixed(value))

    @classmethod
    def categorical(cls, name: str, labels: tuple[str, ...], factors: int = 1) -> "Axis":
        """Axis of named categories, the same for every factor."""
        if len(set(labels)) != len(labels) or not labels:
            raise BabblingError(f"axis {name!r}: categories must be distinct and at least one, got {labels}")
        return cls(name, "category", np.zeros(factors), np.full(factors, len(labels) - 1.0), len(labels), labels)

    @property
    def factors(self) -> int:
        """F, how many factors have a grid here."""
        return int(self.low.size)

    def of(self, factors: int | IntArray) -> "Axis":
        """The grids of one factor alone, or of some."""
        return Axis(self.name, self.unit, self.low[factors], self.high[factors], self.size, self.labels)

    @property
    def is_categorical(self) -> bool:
        """Whether values are category numbers and assignment is hard."""
        return bool(self.labels)

    @cached_property
    def points(self) -> FloatArray:
        """(F, size) grid points, in the axis' unit."""
        return fixed(np.linspace(self.low, self.high, self.size, axis=-1))

    @cached_property
    def step(self) -> FloatArray:
        """(F,) distance between grid points, in the axis' unit (1 for categories)."""
        return fixed(np.ones(self.factors) if self.is_categorical else (self.high - self.low) / (self.size - 1))

    def same(self, other: "Axis") -> bool:
        """Whether both are the very same grid."""
        return self is other or (
            (self.name, self.size, self.labels) == (other.name, other.size, other.labels)
            and np.array_equal(self.low, other.low)
            and np.array_equal(self.high, other.high)
        )

    def hard(self, values: ArrayLike) -> IntArray:
        """(..., F) nearest grid point of (..., F) values; off the axis, the nearest end.

        Raises:
            BabblingError: a category that does not exist.
        """
        x = np.asarray(values, float)
        index = np.rint((x - self.low) / self.step)
        if self.is_categorical and not ((index >= 0) & (index < self.size) & (index == x)).all():
            bad = x[(index < 0) | (index >= self.size) | (index != x)].flat[0]
            raise BabblingError(
                f"axis {self.name!r} has no category {bad:g}; it has 0 to {self.size - 1} {self.labels}"
            )
        return np.asarray(np.clip(index, 0, self.size - 1).astype(np.int64))

    def codes(self, values: NDArray[np.generic]) -> IntArray:
        """`hard` for category numbers, without copying those that are whole numbers already.

        Raises:
            BabblingError: a category that does not exist.
        """
        codes: IntArray = values.astype(np.int64, copy=False)
        whole = codes is values or bool((codes == values).all())
        if not whole or (codes.size and int(codes.view(np.uint64).max()) >= self.size):  # a negative one is huge
            return self.hard(values.ravel()[:, None])  # says which
        return codes

    def soft(self, values: ArrayLike) -> Soft:
        """Linear assignment of (..., F) values: mean-preserving inside the axis, the nearest end beyond it."""
        position = (np.asarray(values, float) - self.low) / self.step
        clipped = np.minimum(np.maximum(position, 0), self.size - 1)
        scaled = np.rint(clipped * UNIT).astype(np.int64)
        index = np.minimum(scaled // UNIT, self.size - 2)
        return Soft(index, scaled - index * UNIT, position == clipped)


class Cells(NamedTuple):
    """Where values lie on grids: the corners around each value, on n measured axes and any number of categorical ones.

    Made from nothing by `located`, read as often as one likes.
    """

    corner: IntArray
    """(2 x n, ..., F) row of each corner in a table `[factor, axes...]` laid flat."""
    shares: tuple[FloatArray, ...]
    """(2, ..., F) for each measured axis: shares of its lower and upper grid point. A corner's is their product."""
    inside: BoolArray
    """(..., F) False where a value fell off its axis (it is then taken at the nearest end)."""
    axes: int
    """How many axes there are."""

    def on(self, axis: Axis, values: ArrayLike) -> "Cells":
        """The same places with one more axis and (..., F) values on it."""
        if axis.is_categorical:
            return self.onto(axis, axis.hard(values))
        soft, corner, measured = axis.soft(values), self.corner, len(self.shares)
        upper = soft.weight / UNIT
        if measured:
            corner = corner.reshape(*corner.shape[:measured], 1, *corner.shape[measured:])
        return Cells(
            corner * axis.size + np.array([soft.lower, soft.lower + 1]),
            (*self.shares, np.array([1 - upper, upper])),
            self.inside & soft.inside,
            self.axes + 1,
        )

    def onto(self, axis: Axis, points: IntArray) -> "Cells":
        """`on` for (..., F) grid points of the axis: nothing lies between them."""
        return self._replace(corner=self.corner * axis.size + points, axes=self.axes + 1)

    def ahead(self, more: int) -> "Cells":
        """The same places, with room before them (so many dimensions) for values on a further axis, many at each."""
        new = (1,) * more
        shares = tuple(share.reshape(2, *new, *share.shape[1:]) for share in self.shares)
        return Cells(self.corner.reshape(-1, *new, *self.corner.shape[1:]), shares, self.inside, self.axes)

    def read(self, table: FloatArray) -> FloatArray:
        """Multilinear interpolation of `[factor, axes..., rest...]`: (..., F, rest...)."""
        rest, measured = table.shape[1 + self.axes :], len(self.shares)
        parts = table.reshape(-1, *rest).take(self.corner, axis=0)
        for number, share in enumerate(self.shares):
            parts *= share.reshape(2, *(1,) * (measured - 1 - number), *share.shape[1:], *(1,) * len(rest))
        return np.asarray(parts.reshape(1 << measured, *parts.shape[measured:]).sum(0))


def located(factors: int, axes: Sequence[Axis], values: Sequence[ArrayLike]) -> Cells:
    """Where (..., F) values, one array for each axis, lie; without any axis, in the only cell there is."""
    cells = Cells(np.arange(factors), (), np.ones(factors, bool), 0)
    for axis, value in zip(axes, values, strict=True):
        cells = cells.on(axis, value)
    return cells


def same_axes(one: Sequence[Axis], other: Sequence[Axis]) -> bool:
    """Whether these share every grid, so that what was counted on them may be added."""
    return len(one) == len(other) and all(a.same(b) for a, b in zip(one, other, strict=True))
