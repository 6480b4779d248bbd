"""A linear-Gaussian fit kept as additive sums: the conjugate prior behind the tables, and a peer to compare with.

Law: y = b_0 + b_1 x_1 + ... + e, e ~ N(0, S), fitted by least squares. All it needs are the second moments of
z = (1, x, y), which add over experience. Values are kept as integers (fixed point, 2^-15 of a channel's half range), so
sums are exact and merging is the same in any order, on any number of threads.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray, IntArray
from babbling.errors import BabblingError

SCALE = 1 << 15
_CHUNK = 1 << 16  # rows per exact float64 product: 2^16 rows x 2^30 < 2^53


class LinearFit(NamedTuple):
    """y = coefficients[..., 0] + sum_i coefficients[..., i + 1] x_i, residuals of covariance `covariance`."""

    coefficients: FloatArray
    """(F, Y, 1 + X) intercept and slopes."""
    covariance: FloatArray
    """(F, Y, Y) residual covariance."""

    def predict(self, *x: NDArray[np.float64]) -> FloatArray:
        """(..., F, Y) means for inputs of shape (..., F) each."""
        mean = self.coefficients[..., 0] + np.zeros((*np.shape(x[0]), 1))
        for i, value in enumerate(x):
            mean = mean + self.coefficients[..., i + 1] * np.asarray(value)[..., None]
        return mean


@dataclass
class LinearGaussian:
    """Second moments of named channels for F factors, exact and additive."""

    channels: tuple[str, ...]
    centre: FloatArray
    """(F, C) middle of each channel's range."""
    half: FloatArray
    """(F, C) half of each channel's range; values beyond it are cut."""
    sums: IntArray
    """(F, 1 + C, 1 + C) sums of z z^T in fixed point, z = (1, channels)."""

    @classmethod
    def empty(cls, channels: tuple[str, ...], low: FloatArray, high: FloatArray) -> "LinearGaussian":
        """No experience yet; ranges `low`, `high` are (F, C)."""
        size = 1 + len(channels)
        return cls(channels, (low + high) / 2, (high - low) / 2, np.zeros((len(low), size, size), np.int64))

    @property
    def samples(self) -> IntArray:
        """(F,) how many transitions were seen."""
        return self.sums[:, 0, 0] // SCALE**2

    def observe(self, values: FloatArray, keep: NDArray[np.bool_]) -> None:
        """Add (N, F, C) values; rows where `keep` (N, F) is False are left out."""
        ones = np.full((*keep.shape, 1), float(SCALE))
        z = np.concatenate([ones, (values - self.centre) * (SCALE / self.half)], axis=-1)
        np.rint(np.clip(z, -SCALE, SCALE, out=z), out=z)
        if not keep.all():
            z *= keep[..., None]
        for start in range(0, len(z), _CHUNK):
            part = np.ascontiguousarray(z[start : start + _CHUNK].transpose(1, 2, 0))
            self.sums += (part @ part.transpose(0, 2, 1)).astype(np.int64)  # integers in float64: exact

    def fit(self, targets: Sequence[str], inputs: Sequence[str], ridge: float = 1e-9) -> LinearFit:
        """Least squares of `targets` on 1 and `inputs`, in the channels' own units.

        Raises:
            BabblingError: a factor without experience.
        """
        if (self.samples <= len(inputs) + 1).any():
            raise BabblingError(f"factor {int(np.argmin(self.samples))} has no experience to fit a line to")
        xs = [0, *(1 + self.channels.index(c) for c in inputs)]
        ys = [1 + self.channels.index(c) for c in targets]
        moments = self.sums / (self.sums[:, :1, :1].astype(float))
        sxx = moments[:, xs][:, :, xs] + ridge * np.eye(len(xs))
        sxy = moments[:, xs][:, :, ys]
        syy = moments[:, ys][:, :, ys]
        beta = np.linalg.solve(sxx, sxy)  # (F, X, Y) in normalised units
        cov = syy - sxy.transpose(0, 2, 1) @ beta
        half_x = np.concatenate([np.ones((len(self.half), 1)), self.half[:, [i - 1 for i in xs[1:]]]], axis=1)
        centre_x = self.centre[:, [i - 1 for i in xs[1:]]]
        half_y, centre_y = self.half[:, [i - 1 for i in ys]], self.centre[:, [i - 1 for i in ys]]
        slopes = (beta * half_y[:, None, :] / half_x[:, :, None]).transpose(0, 2, 1)
        slopes[..., 0] += centre_y - (slopes[..., 1:] * centre_x[:, None, :]).sum(-1)
        cov = cov * half_y[:, :, None] * half_y[:, None, :]
        floor = (half_y / SCALE) ** 2  # fixed point cannot see less
        diagonal = np.arange(len(ys))
        cov[:, diagonal, diagonal] = np.maximum(cov[:, diagonal, diagonal], floor)
        return LinearFit(slopes, cov)
