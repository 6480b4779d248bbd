"""Bayesian linear regression kept as additive sums: the one place where lines are fitted, whatever they are lines of.

Law (conjugate Gaussian; Bishop 2006, section 3.3), for features x and targets y with noise covariance S:

    y = W x + e,  e ~ N(0, S),  rows of W ~ N(0, s^2 / ridge I)   gives   A = sum x x^T + ridge I,  W = sum y x^T A^-1,
    cov(row of W) = s^2 A^-1,   s^2 = misfit / (N - gamma),   gamma = X - ridge tr A^-1

gamma counts the weights that experience determined; without a ridge it is X and W is least squares. Where the prior is
known in its own units, W ~ N(0, I / prior), ridge = prior s^2, and that s^2 is where the evidence P(y | x, s^2) is
greatest (MacKay 1992). All it needs are the second moments of z = (x, y), which add over experience.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.errors import BabblingError

SCALE = 1 << 15
_CHUNK = 1 << 16  # rows per exact float64 product: 2^16 rows x 2^30 < 2^53
RARE = 1e-2
"""Mean square, in units of the half range, that a feature is taken to have at least: what was next to never seen has
little to say."""
ROUNDING = 1e-12
"""Least ridge, relative to each feature's own square: what rounding leaves of features that say the same twice."""
NOISE_ROUNDS = 4


class LinearFit(NamedTuple):
    """Posterior of the weights of F factors with X features and Y targets."""

    coefficients: FloatArray
    """(F, Y, X) posterior mean W; where the first feature is 1, intercept first."""
    covariance: FloatArray
    """(F, Y, Y) mean product of the residuals (and of the ridge's share): S at its greatest likelihood."""
    precision: FloatArray
    """(F, X, X) A: the weights of target y have posterior covariance noise[y]^2 A^-1."""
    samples: IntArray
    """(F,) N."""
    ridge: float = 0.0
    """Prior precision in units of the noise's."""

    @property
    def noise(self) -> FloatArray:
        """(F, Y) standard deviation s of each target; infinite with no more samples than weights and no ridge."""
        free = (self.samples - self.coefficients.shape[-1])[:, None] + 0.0
        misfit = np.diagonal(self.covariance, axis1=1, axis2=2) * self.samples[:, None]
        if self.ridge:
            undetermined = self.ridge * np.trace(np.linalg.inv(self.precision), axis1=1, axis2=2)
            free = np.maximum(free + undetermined[:, None], 1.0)
            misfit = misfit - self.ridge * (self.coefficients**2).sum(-1)
        return np.asarray(np.sqrt(np.where(free > 0, np.maximum(misfit, 0) / np.maximum(free, 1), np.inf)))

    def predict(self, *x: FloatArray) -> FloatArray:
        """(..., F, Y) means for inputs of shape (..., F) each, where the features are 1 and the inputs."""
        return self.mean(np.stack([np.ones_like(x[0]), *x], axis=-1))

    def mean(self, features: FloatArray) -> FloatArray:
        """(..., F, Y) means for features (..., F or 1, X)."""
        return np.asarray((self.coefficients @ features[..., None])[..., 0])

    def doubt(self, features: FloatArray) -> FloatArray:
        """(N, F) x^T A^-1 x for features (N, F, X): a mean's variance in units of the noise's."""
        x = np.moveaxis(features, 0, -1)
        return np.asarray((x * np.linalg.solve(self.precision, x)).sum(1).T)


class LinearGaussian:
    """Second moments of named channels for F factors: exact, so merging (adding `sums`) is the same in any order.

    Values are kept as integers, 2^-15 of a channel's half range; any channels can be targets and inputs.

    Args:
        channels: C names.
        low, high: (F, C) ranges of the channels; values beyond them are cut.
    """

    def __init__(self, channels: Sequence[str], low: FloatArray, high: FloatArray) -> None:
        self.names = ("1", *channels)
        self.centre = np.pad((low + high) / 2, ((0, 0), (1, 0)))
        self.half = np.pad((high - low) / 2, ((0, 0), (1, 0)), constant_values=1)
        self.sums: IntArray = np.zeros((len(low), *2 * (len(self.names),)), np.int64)
        """(F, Z, Z) sums of z z^T in fixed point, z = (1, channels)."""

    @property
    def samples(self) -> IntArray:
        """(F,) how many transitions were seen."""
        return self.sums[:, 0, 0] // SCALE**2

    def observe(self, values: FloatArray, keep: BoolArray) -> None:
        """Add (N, F, C) values; rows where `keep` (N, F) is False are left out."""
        some, z = not keep.all(), np.full((len(values), len(self.names)), float(SCALE))
        for f, (centre, half) in enumerate(zip(self.centre[:, 1:], self.half[:, 1:], strict=True)):
            rest = z[:, 1:]  # one factor's columns at a time stay in the cache
            np.multiply(values[:, f] - centre, SCALE / half, out=rest)
            np.rint(np.clip(rest, -SCALE, SCALE, out=rest), out=rest)
            _add(self.sums[f : f + 1], (z * keep[:, f, None] if some else z)[:, None])

    def fit(self, targets: Sequence[str], inputs: Sequence[str], ridge: float = 1e-9) -> LinearFit:
        """Posterior of `targets` on 1 and `inputs`, in the channels' own units.

        The prior's precision is `ridge` for each sample and mean square of a feature (`RARE` at least).

        Raises:
            BabblingError: a factor without experience.
        """
        if (self.samples <= len(inputs) + 1).any():
            raise BabblingError(f"factor {int(np.argmin(self.samples))} has no experience to fit a line to")
        order = [self.names.index(name) for name in ("1", *inputs, *targets)]
        moments = (self.sums / (self.sums[:, :1, :1].astype(float)))[:, order][:, :, order]
        centre, half = self.centre[:, order], self.half[:, order]
        own = ridge * (np.diagonal(moments, axis1=1, axis2=2)[:, : 1 + len(inputs)] + RARE)
        fit = _posterior(moments, self.samples, own, centre, half)
        floor = (half[:, 1 + len(inputs) :] / SCALE) ** 2  # fixed point cannot see less
        diagonal = np.arange(len(targets))
        fit.covariance[:, diagonal, diagonal] = np.maximum(fit.covariance[:, diagonal, diagonal], floor)
        return fit


class Regression:
    """The same for features whose ranges nobody knows: sums of (F or 1, X) features and (F, Y) targets as real numbers.

    sums: (F, X + Y, X + Y); samples: (F,). Both add.
    """

    def __init__(self, factors: int, features: int, targets: int) -> None:
        self.features = features
        self.sums, self.samples = np.zeros((factors, *2 * (features + targets,))), np.zeros(factors, np.int64)

    def observe(self, x: FloatArray, y: FloatArray, keep: BoolArray | None = None) -> None:
        """Add (N, F or 1, X) features and (N, F, Y) targets; rows where `keep` (N, F) is False are left out."""
        z = np.concatenate([np.broadcast_to(x, (*y.shape[:2], self.features)), y], axis=-1)
        if keep is not None:
            z[~keep] = 0
        self.samples += len(z) if keep is None else keep.sum(0)
        _add(self.sums, z)

    def fit(self, ridge: float = 0.0) -> LinearFit:
        """Posterior with this prior precision, in units of the noise's; 0 is least squares."""
        moments = self.sums / np.maximum(self.samples, 1)[:, None, None]
        size = np.sqrt(np.diagonal(moments, axis1=1, axis2=2))
        size = np.where(size > 0, size, 1.0)
        own = ridge / (np.maximum(self.samples, 1)[:, None] * size[:, : self.features] ** 2)
        moments = moments / (size[:, :, None] * size[:, None, :])
        return _posterior(moments, self.samples, own + ROUNDING, 0 * size, size)._replace(ridge=ridge)

    def fit_with_noise(self, prior: float = 1.0, least: float = 1e-9) -> tuple[LinearFit, float]:
        """Posterior where W ~ N(0, I / prior), and the noise variance, all targets alike, by evidence; `least` of it.

        Weights and noise in turn, from a noise of a thousandth of the targets.
        """
        squares = np.diagonal(self.sums, axis1=1, axis2=2)[:, self.features :]
        variance = 1e-3 * float((squares / self.samples[:, None]).mean())
        for _ in range(NOISE_ROUNDS):
            fit = self.fit(prior * max(variance, least))
            variance = max(float((fit.noise**2).mean()), least)
        return fit, variance


def regress(
    x: FloatArray, y: FloatArray, *, keep: BoolArray | None = None, outlier: float = np.inf, rounds: int = 1
) -> LinearFit:
    """Least squares on rows that are at hand, every factor on those of its rows that are finite.

    Args:
        x: (N, F or 1, X) features.
        y: (N, F, Y) targets.
        keep: (N, F) rows that may be used at all.
        outlier: rows that a round misses by more than so many standard deviations are left out of the next one.
        rounds: how often is fitted.
    """
    used = usable = np.isfinite(x.sum(-1) + y.sum(-1)) & (True if keep is None else keep)
    for _ in range(rounds):
        sums = Regression(y.shape[1], x.shape[-1], y.shape[2])
        sums.observe(x, y, used)
        fit = sums.fit()
        miss = y - fit.mean(x)
        rest = np.where(
            used[..., None], miss, 0.0
        )  # of the rows themselves: sums lose a small rest beside large targets
        fit = fit._replace(covariance=np.einsum("nfi,nfj->fij", rest, rest) / np.maximum(fit.samples, 1)[:, None, None])
        rounded = 1e-9 * np.abs(np.where(usable[..., None], y, 0)).max(0)  # is no outlier
        used = usable & np.all(np.abs(miss) <= outlier * fit.noise + rounded, axis=-1)
    return fit


def _add(sums: FloatArray | IntArray, z: FloatArray) -> None:
    """Add z z^T of (N, F, Z) rows; exact where z holds whole numbers up to `SCALE`."""
    for start in range(0, len(z), _CHUNK):
        part = np.ascontiguousarray(z[start : start + _CHUNK].transpose(1, 2, 0))
        sums += (part @ part.transpose(0, 2, 1)).astype(sums.dtype)


def _posterior(
    moments: FloatArray, samples: IntArray, ridge: FloatArray, centre: FloatArray, half: FloatArray
) -> LinearFit:
    """Posterior from (F, Z, Z) mean moments of (z - centre) / half: first X features, as long as the diagonal `ridge`.

    A centre other than 0 needs a first feature that is 1.
    """
    size = ridge.shape[1]
    xx, xy, yy = moments[:, :size, :size], moments[:, :size, size:], moments[:, size:, size:]
    xx = xx + ridge[:, :, None] * np.eye(size)
    beta = np.linalg.solve(xx, xy)  # (F, X, Y) in normalised units
    half_x, half_y, middle = half[:, :size], half[:, size:], centre[:, :size]
    slopes = (beta * half_y[:, None, :] / half_x[:, :, None]).transpose(0, 2, 1)
    slopes[..., 0] += centre[:, size:] - (slopes[..., 1:] * middle[:, None, 1:]).sum(-1)
    covariance = (yy - xy.transpose(0, 2, 1) @ beta) * half_y[:, :, None] * half_y[:, None, :]
    precision = xx * half_x[:, :, None] * half_x[:, None, :] * samples[:, None, None]
    precision += middle[:, :, None] * precision[:, :1]
    precision += precision[:, :, :1] * middle[:, None, :]
    return LinearFit(slopes, covariance, precision, samples)
