"""Counting transitions into the cells of a table: whole where all axes are categories, softly elsewhere."""

import math
from collections.abc import Sequence
from functools import reduce
from itertools import product
from operator import mul

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from babbling.axes import UNIT, Axis, BoolArray, FloatArray, IntArray

_BITS = UNIT.bit_length() - 1


def weight_bits(axes: Sequence[Axis]) -> int:
    """Of a soft weight, such that their product over all measured axes and many transitions stays exact."""
    measured = sum(not axis.is_categorical for axis in axes)
    return min(_BITS, 36 // measured) if measured else 0


def count_categories(axes: Sequence[Axis], values: Sequence[NDArray[np.generic]]) -> IntArray:
    """`[factor, axes...]` counts of (N, F) category numbers, one array per axis; NaN is nothing that happened."""
    rows, factors = values[0].shape
    values = [v.reshape(-1) for v in values]  # NumPy runs along the last axis, and F is often 1
    index: IntArray | None = np.tile(np.arange(factors), rows) if factors > 1 else None
    missing = [np.isnan(v) for v in values if v.dtype.kind == "f"]
    if any(m.any() for m in missing):
        happened = ~np.logical_or.reduce(missing)
        values = [v[happened] for v in values]
        index = index[happened] if index is not None else None
    for axis, value in zip(axes, values, strict=True):
        codes = axis.codes(value)
        if index is None:
            index = codes
        else:
            index = index * axis.size
            index += codes
    assert index is not None
    shape = (factors, *(axis.size for axis in axes))
    return np.bincount(index, minlength=int(np.prod(shape))).reshape(shape)


def count_softly(
    axes: Sequence[Axis], columns: Sequence[FloatArray], happened: BoolArray
) -> tuple[IntArray, BoolArray]:
    """`[axes...]` soft counts of one factor's (N,) columns, and (N,) which of them lie on all axes.

    Args:
        axes: grids of this factor alone.
        columns: one for each axis.
        happened: (N,) which ones to count.
    """
    shape = tuple(axis.size for axis in axes)
    bits = weight_bits(axes)
    shift, stride, keep = _BITS - bits, int(np.prod(shape)), happened
    parts: list[list[tuple[IntArray, FloatArray | None]]] = []
    for axis, column in zip(axes, columns, strict=True):
        stride //= axis.size
        if axis.is_categorical:
            parts.append([(axis.hard(column[:, None])[:, 0] * stride, None)])
            continue
        soft = axis.soft(column[:, None])
        keep = keep & soft.inside[:, 0]
        upper = ((soft.weight[:, 0] + (1 << shift >> 1)) >> shift).astype(float)
        index = soft.lower[:, 0] * stride
        parts.append([(index, (1 << bits) - upper), (index + stride, upper)])
    if not keep.all():
        parts = [[(i[keep], None if w is None else w[keep]) for i, w in part] for part in parts]
    total = np.zeros(int(np.prod(shape)))
    for corner in product(*parts):
        index = reduce(np.add, (i for i, _ in corner))
        weights = [w for _, w in corner if w is not None]
        total += np.bincount(index, reduce(mul, weights) if weights else None, total.size)
    return total.astype(np.int64).reshape(shape), keep


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
