"""Arithmetic on grids: reading a table between its points, and spreading a Gaussian over them."""

import math
from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr

from babbling.axes import UNIT, Axis, FloatArray, IntArray


def interpolate(table: FloatArray, axes: Sequence[Axis], values: Sequence[ArrayLike]) -> FloatArray:
    """Multilinear interpolation of `[factor, axes..., rest...]` at one (..., F) value per axis: (..., F, rest...).

    Categorical axes are looked up, not interpolated; without any axis the table itself comes back.
    """
    if not axes:
        return table
    corners: list[list[tuple[IntArray, FloatArray | None]]] = []
    for axis, value in zip(axes, values, strict=True):
        if axis.is_categorical:
            corners.append([(axis.hard(value), None)])
            continue
        soft = axis.soft(value)
        share = soft.weight / UNIT
        corners.append([(soft.lower, 1 - share), (soft.lower + 1, share)])
    factor = np.arange(len(table))
    rest = table.ndim - 1 - len(axes)
    total: FloatArray | None = None
    for corner in product(*corners):
        part = table[(factor, *(i for i, _ in corner))]
        for _, weight in corner:
            if weight is not None:
                part = part * weight.reshape(weight.shape + (1,) * rest)
        total = part if total is None else total + part
    assert total is not None
    return total


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
