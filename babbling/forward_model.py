"""The forward model: a bank of Dirichlet tables P(outcome | context, action), learned by counting.

Chapter, section 3.1 and 3.2: P(s_{t+1} = S_j | s_t = S_i, a_t = A_i), learned in a supervised manner from babbling.
Law, per factor f, context c and action a:

    P(o | c, a) = (n[f, c, a, o] + k q[f, c, a, o]) / (n[f, c, a] + k)

with soft counts n, a prior predictive distribution q of strength k pseudo-counts. q is either absent (k = 0: plain
relative frequencies, a row nobody tried is all zeros) or the linear-Gaussian fit of the very same experience.
Counts are integers: models learned apart are merged by adding, exactly, in any order.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import product
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr

from babbling.axes import UNIT, Axis, FloatArray, IntArray
from babbling.errors import BabblingError
from babbling.linear_gaussian import LinearFit, LinearGaussian

_CHUNK = 1 << 16  # transitions per exact bincount: 2^16 x 2^36 < 2^53
_BITS = UNIT.bit_length() - 1


class ForwardModel:
    """F factors share counts `[factor, context..., action, outcome]`.

    Args:
        contexts: the axes of the state that matter (none for state-free dynamics).
        action: the axis of actions.
        outcome: the axis of what happens.
        factors: one label per factor, for people.
        prior_strength: pseudo-counts k of the linear-Gaussian prior; 0 for none (needed when an axis is categorical).
        wiring: anything that says how senses and motors became factors, kept beside the counts (saved with them).
    """

    def __init__(
        self,
        contexts: Sequence[Axis],
        action: Axis,
        outcome: Axis,
        *,
        factors: Sequence[str] = ("0",),
        prior_strength: float = 0.0,
        provenance: Mapping[str, str | int | float] | None = None,
    ) -> None:
        self.contexts, self.action, self.outcome = tuple(contexts), action, outcome
        self.factors = tuple(factors)
        self.prior_strength = float(prior_strength)
        self.provenance: Mapping[str, str | int | float] = MappingProxyType(dict(provenance or {}))
        for axis in self.axes:
            if axis.factors != len(self.factors):
                raise BabblingError(f"axis {axis.name!r} has {axis.factors} factors, the model has {len(self.factors)}")
        soft = sum(not axis.is_categorical for axis in self.axes)
        if prior_strength < 0 or (prior_strength > 0 and soft < len(self.axes)):
            raise BabblingError(
                f"prior strength {prior_strength:g}: it must be >= 0, and 0 where an axis is categorical"
            )
        self._bits = min(_BITS, 36 // soft) if soft else 0
        self.unit = 1 << (self._bits * soft)
        self.counts: IntArray = np.zeros((len(self.factors), *(axis.size for axis in self.axes)), np.int64)
        self.outside = np.zeros(len(self.factors), np.int64)
        names = (*(axis.name for axis in self.axes),)
        low = np.stack([axis.low for axis in self.axes], axis=1)
        high = np.stack([axis.high for axis in self.axes], axis=1)
        self.moments = LinearGaussian.empty(names, low, np.maximum(high, low + 1e-12))
        self._predictive: FloatArray | None = None

    @property
    def axes(self) -> tuple[Axis, ...]:
        """All axes in order: contexts, action, outcome."""
        return (*self.contexts, self.action, self.outcome)

    @property
    def transitions(self) -> int:
        """How many transitions were learned, all factors together."""
        return int(self.moments.samples.sum())

    # ---------------------------------------------------------------- learning

    def observe(self, context: Sequence[ArrayLike], action: ArrayLike, outcome: ArrayLike) -> None:
        """Count transitions: one (N, F) array per context axis, (N, F) actions, (N, F) outcomes.

        A transition that falls off an axis is not bent onto its end: it is left out and counted in `outside`.
        A value of NaN means "nothing happened for this factor" and is left out silently.
        """
        values = [np.asarray(v, float) for v in (*context, action, outcome)]
        if len(values) != len(self.axes) or any(v.shape != values[-1].shape for v in values):
            raise BabblingError(f"expected {len(self.axes)} arrays of one shape (N, {len(self.factors)})")
        for start in range(0, len(values[0]), _CHUNK):
            self._observe([v[start : start + _CHUNK] for v in values])
        self._predictive = None

    def _observe(self, values: list[FloatArray]) -> None:
        happened = ~np.isnan(values[0])
        for v in values[1:]:
            happened &= ~np.isnan(v)
        values = [np.where(happened, v, axis.low) for v, axis in zip(values, self.axes, strict=True)]
        keep = happened.copy()
        parts: list[tuple[tuple[IntArray, NDArray[np.float64] | None], ...]] = []
        flat_strides = np.cumprod([1, *self.counts.shape[:0:-1]])[::-1]  # of factor, contexts, action, outcome
        for axis, value, stride in zip(self.axes, values, flat_strides[1:], strict=True):
            if axis.is_categorical:
                parts.append(((axis.hard(value) * stride, None),))
                continue
            soft = axis.soft(value)
            keep &= soft.inside
            shift = _BITS - self._bits
            upper = ((soft.weight + (1 << shift >> 1)) >> shift).astype(float)
            parts.append(
                (
                    (soft.lower * stride, (1 << self._bits) - upper),
                    ((soft.lower + 1) * stride, upper),
                )
            )
        self.outside += (happened & ~keep).sum(0)
        base = np.broadcast_to(np.arange(len(self.factors)) * flat_strides[0], keep.shape)[keep]
        parts = [tuple((i[keep], None if w is None else w[keep]) for i, w in part) for part in parts]
        total = np.zeros(self.counts.size)
        for corner in product(*parts):
            index, weight = base, None
            for i, w in corner:
                index = index + i
                weight = w if weight is None else (weight if w is None else weight * w)
            total += np.bincount(index, weights=weight, minlength=self.counts.size)
        self.counts += total.astype(np.int64).reshape(self.counts.shape)
        self.moments.observe(np.stack(values, axis=-1), keep)

    def merge(self, other: "ForwardModel") -> None:
        """Add what another model of the same axes learned: equal to having learned on the union.

        Raises:
            BabblingError: the axes differ.
        """
        if not same_axes(self, other):
            raise BabblingError("these forward models do not share their axes; only tables of one pilot can be merged")
        self.counts += other.counts
        self.outside += other.outside
        self.moments.sums += other.moments.sums
        self._predictive = None

    def empty(self) -> "ForwardModel":
        """The same axes, nothing learned."""
        return ForwardModel(
            self.contexts,
            self.action,
            self.outcome,
            factors=self.factors,
            prior_strength=self.prior_strength,
            provenance=self.provenance,
        )

    # --------------------------------------------------------------- predicting

    @property
    def predictive(self) -> FloatArray:
        """`[factor, context..., action, outcome]`: P(outcome | context, action); rows without any evidence are zero."""
        if self._predictive is None:
            table = self.counts / self.unit
            visits = table.sum(-1, keepdims=True)
            if self.prior_strength > 0:
                table += self.prior_strength * self.prior()
                visits = visits + self.prior_strength
            np.divide(table, visits, out=table, where=visits > 0)
            table.flags.writeable = False
            self._predictive = table
        return self._predictive

    @property
    def visits(self) -> FloatArray:
        """`[factor, context..., action]`: how often each row was tried (soft counts, as real numbers)."""
        visits: FloatArray = self.counts.sum(-1) / self.unit
        return visits

    def linear(self) -> LinearFit:
        """The least-squares line outcome = f(contexts, action) of the same experience."""
        inputs = [axis.name for axis in self.axes[:-1]]
        return self.moments.fit([self.outcome.name], inputs)

    def prior(self) -> FloatArray:
        """`[factor, context..., action, outcome]`: the linear-Gaussian fit, assigned softly to the outcome grid.

        A mean beyond the outcome's range is clipped into it: an all-but-empty row would otherwise turn uniform.
        """
        fit = self.linear()
        grids = [axis.points for axis in self.axes[:-1]]
        mesh = np.array(
            [np.stack(np.meshgrid(*(g[f] for g in grids), indexing="ij"), -1) for f in range(len(self.factors))]
        )  # (F, C..., A, X)
        slopes = fit.coefficients[:, 0, 1:].reshape(-1, *(1,) * len(grids), len(grids))
        mean = (mesh * slopes).sum(-1) + fit.coefficients[:, 0, 0].reshape(-1, *(1,) * len(grids))
        spread = np.sqrt(fit.covariance[:, 0, 0]).reshape(-1, *(1,) * len(grids))
        low, high, step = (
            v.reshape(mean.shape[0], *(1,) * len(grids))
            for v in (self.outcome.low, self.outcome.high, self.outcome.step)
        )
        return hat_mass((np.clip(mean, low, high) - low) / step, spread / step, self.outcome.size)

    def likelihood(self, context: Sequence[ArrayLike], outcome: ArrayLike) -> FloatArray:
        """P(outcome | context, every action): (..., F) values in, (..., F, A) out.

        Soft assignment on both sides: the table is interpolated between the neighbouring contexts and outcomes.
        Values off an axis are taken at its nearest end; see `inside`.
        """
        return self._gather(self.predictive, (*context, outcome), (*self.contexts, self.outcome), outcome=True)

    def familiarity(self, context: Sequence[ArrayLike]) -> FloatArray:
        """How often each action was tried in this context: (..., F) values in, (..., F, A) visits out."""
        return self._gather(self.visits[..., None], context, self.contexts, outcome=False)

    def inside(self, context: Sequence[ArrayLike], outcome: ArrayLike) -> NDArray[np.bool_]:
        """(..., F) whether context and outcome lie on their axes."""
        ok = np.ones(np.shape(outcome), bool)
        for axis, value in zip((*self.contexts, self.outcome), (*context, outcome), strict=True):
            if not axis.is_categorical:
                ok &= axis.soft(value).inside
        return ok

    def _gather(
        self, table: FloatArray, values: Sequence[ArrayLike], axes: Sequence[Axis], *, outcome: bool
    ) -> FloatArray:
        factor = np.arange(len(self.factors))
        corners: list[list[tuple[IntArray, FloatArray]]] = []
        for axis, value in zip(axes, values, strict=True):
            if axis.is_categorical:
                index = axis.hard(value)
                corners.append([(index, np.ones(index.shape))])
            else:
                soft = axis.soft(value)
                share = soft.weight / UNIT
                corners.append([(soft.lower, 1 - share), (soft.lower + 1, share)])
        shape = np.shape(values[0]) if values else (len(self.factors),)
        total = np.zeros((*shape, self.action.size))
        for corner in product(*corners):
            weight = math.prod((w for _, w in corner), start=np.ones(shape))
            where = [i for i, _ in corner]
            at_outcome = where.pop() if outcome else np.zeros(shape, np.int64)
            cell: list[IntArray] = [factor, *where]
            total += (
                weight[..., None]
                * table[
                    (
                        *(i[..., None] for i in np.broadcast_arrays(*cell)),
                        np.arange(self.action.size),
                        at_outcome[..., None],
                    )
                ]
            )
        return total


def same_axes(one: ForwardModel, other: ForwardModel) -> bool:
    """Whether two forward models share every grid, so that their counts may be added."""
    return len(one.axes) == len(other.axes) and all(
        a.name == b.name
        and a.size == b.size
        and a.labels == b.labels
        and np.array_equal(a.low, b.low)
        and np.array_equal(a.high, b.high)
        for a, b in zip(one.axes, other.axes, strict=True)
    )


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
