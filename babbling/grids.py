"""Arithmetic on grids: reading a table between its points, and spreading a Gaussian over them."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr

from babbling.axes import UNIT, Axis, BoolArray, FloatArray, IntArray


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

    def read(self, table: FloatArray) -> FloatArray:
        """Multilinear interpolation of `[factor, axes..., rest...]`: (..., F, rest...)."""
        rest, measured = table.shape[1 + self.axes :], len(self.shares)
        parts = table.reshape(-1, *rest).take(self.corner, axis=0)
        for number, share in enumerate(self.shares):
            parts *= share.reshape(2, *(1,) * (measured - 1 - number), *share.shape[1:], *(1,) * len(rest))
        values: FloatArray = parts.reshape(-1, *parts.shape[measured:]).sum(0) if measured else parts
        return values


def located(factors: int, axes: Sequence[Axis], values: Sequence[ArrayLike]) -> Cells:
    """Where (..., F) values, one array for each axis, lie; without any axis, in the only cell there is."""
    cells = Cells(np.arange(factors), (), np.ones(factors, bool), 0)
    for axis, value in zip(axes, values, strict=True):
        cells = cells.on(axis, value)
    return cells


def hat_mass(mean: FloatArray, spread: FloatArray, size: int) -> FloatArray:
    """Mean soft assignment of a Gaussian: E[hat_k(x)], x ~ N(mean, spread^2) in grid steps, k = 0 .. size - 1.

    The hat of grid point k is max(0, 1 - |x - k|); mass beyond the ends goes to the ends. With
    G(t) = E[max(0, x - t)] = (mean - t) cdf(u) + spread pdf(u), u = (mean - t) / spread, hat_k is a second difference
    of G, so rows sum to one and keep their mean (up to what lies beyond the ends).
    """
    knots = np.arange(size, dtype=float)
    spread = np.maximum(spread, 1e-6)[..., None]
    u = (mean[..., None] - knots) / spread
    ramp = spread * (u * ndtr(u) + np.exp(-u * u / 2) / math.sqrt(2 * math.pi))  # G at each knot
    slope = np.diff(ramp, axis=-1)  # E of the derivative between knots, in [-1, 0]
    mass: FloatArray = np.empty(u.shape)
    mass[..., 1:-1] = np.diff(slope, axis=-1)
    mass[..., 0] = 1 + slope[..., 0]
    mass[..., -1] = -slope[..., -1]
    return np.maximum(mass, 0)
