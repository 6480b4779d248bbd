"""The forward model: a bank of Dirichlet tables P(outcome | context, action), learned by counting.

Chapter, section 3.1 and 3.2: P(s_{t+1} = S_j | s_t = S_i, a_t = A_i), learned in a supervised manner from babbling.
Law, per factor f, context c and action a:

    P(o | c, a) = (n[f, c, a, o] + k q[f, c, a, o]) / (n[f, c, a] + k)

with soft counts n, a prior predictive distribution q of strength k pseudo-counts. q is either absent (k = 0: plain
relative frequencies, a row nobody tried is all zeros) or drawn from the very same experience: its linear-Gaussian fit
on measured axes, what happens in context c whatever one does where outcomes are categories.
Counts are integers: models learned apart are merged by adding, exactly, in any order.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from babbling.axes import Axis, BoolArray, Cells, FloatArray, IntArray, fixed, located, same_axes
from babbling.counting import count_categories, count_softly, hat_mass, weight_bits
from babbling.errors import BabblingError
from babbling.regression import SCALE, LinearFit, LinearGaussian

_CHUNK = 1 << 16  # transitions per exact bincount: 2^16 x 2^36 < 2^53


class ForwardModel:
    """F factors share counts `[factor, context..., action, outcome]`.

    Args:
        contexts: the axes of the state that matter (none for state-free dynamics).
        action: the axis of actions.
        outcome: the axis of what happens.
        factors: one label per factor, for people.
        prior_strength: pseudo-counts k of the prior, linear-Gaussian where all axes are measured, what usually happens
            where outcomes are categories; 0 for none (needed for measured outcomes of categories).
        fingerprint: of the body whose experience is counted.
    """

    def __init__(
        self,
        contexts: Sequence[Axis],
        action: Axis,
        outcome: Axis,
        *,
        factors: Sequence[str] = ("0",),
        prior_strength: float = 0.0,
        fingerprint: str = "",
    ) -> None:
        self.contexts, self.action, self.outcome = tuple(contexts), action, outcome
        self.factors = tuple(factors)
        self.prior_strength = float(prior_strength)
        self.fingerprint = fingerprint
        for axis in self.axes:
            if axis.factors != len(self.factors):
                raise BabblingError(f"axis {axis.name!r} has {axis.factors} factors, the model has {len(self.factors)}")
        soft = sum(not axis.is_categorical for axis in self.axes)
        if prior_strength < 0 or (prior_strength > 0 and not outcome.is_categorical and soft < len(self.axes)):
            raise BabblingError(
                f"prior strength {prior_strength:g}: it must be >= 0, and 0 for measured outcomes of categories"
            )
        self.unit = 1 << (weight_bits(self.axes) * soft)
        self.counts: IntArray = np.zeros((len(self.factors), *(axis.size for axis in self.axes)), np.int64)
        self.outside = np.zeros(len(self.factors), np.int64)
        names = (*(axis.name for axis in self.axes),)
        low = np.stack([axis.low for axis in self.axes], axis=1)
        high = np.stack([axis.high for axis in self.axes], axis=1)
        self.moments = LinearGaussian(names, low, np.maximum(high, low + 1e-12))

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
        categories = self.categorical
        values = [np.asarray(v) if categories else np.asarray(v, float) for v in (*context, action, outcome)]
        if len(values) != len(self.axes) or any(v.shape != values[-1].shape for v in values):
            raise BabblingError(f"expected {len(self.axes)} arrays of one shape (N, {len(self.factors)})")
        for start in range(0, len(values[0]), _CHUNK):
            some = [v[start : start + _CHUNK] for v in values]
            if categories:
                self.add(count_categories(self.axes, some))
            else:
                self._observe(some)
        self.refresh()

    def _observe(self, values: list[FloatArray]) -> None:
        happened = ~np.logical_or.reduce([np.isnan(v) for v in values])
        if not happened.all():
            values = [np.where(happened, v, axis.low) for v, axis in zip(values, self.axes, strict=True)]
        keep = happened.copy()
        for f in range(len(self.factors)):  # one factor's table and columns at a time stay in the cache
            columns = [np.ascontiguousarray(v[:, f]) for v in values]
            counts, keep[:, f] = count_softly([axis.of(f) for axis in self.axes], columns, happened[:, f])
            self.counts[f] += counts
        self.outside += (happened & ~keep).sum(0)
        self.moments.observe(np.stack(values, axis=-1), keep)

    def add(self, counts: IntArray) -> None:
        """Add visits counted before, `[factor, context..., action, outcome]`, where every axis is categorical.

        Raises:
            BabblingError: another shape, negative counts, or an axis that is not categorical.
        """
        if counts.shape != self.counts.shape or (counts.size and counts.min() < 0):
            raise BabblingError(f"counts of shape {counts.shape}; {self.counts.shape} numbers from 0 are needed")
        if not self.categorical:
            raise BabblingError(
                "bare counts say nothing of the moments of a measured axis; merge forward models instead"
            )
        self.counts += counts
        self.moments.sums[:, 0, 0] += counts.reshape(len(self.factors), -1).sum(1) * SCALE**2
        self.refresh()

    def merge(self, other: "ForwardModel") -> None:
        """Add what another model of the same axes learned: equal to having learned on the union.

        Raises:
            BabblingError: the axes differ.
        """
        if not same_axes(self.axes, other.axes):
            raise BabblingError("these forward models do not share their axes; only tables of one pilot can be merged")
        self.counts += other.counts
        self.outside += other.outside
        self.moments.sums += other.moments.sums
        self.refresh()

    def refresh(self) -> None:
        """What follows from the counts has to be worked out anew, for they have changed."""
        for table in ("predictive", "visits", "by_outcome", "mean", "habits"):
            vars(self).pop(table, None)

    # --------------------------------------------------------------- predicting

    @cached_property
    def predictive(self) -> FloatArray:
        """`[factor, context..., action, outcome]`: P(outcome | context, action); rows without any evidence are zero."""
        table: FloatArray = self.counts / self.unit
        visits = table.sum(-1, keepdims=True)
        if self.prior_strength > 0:
            table += self.prior_strength * self.prior()
            visits = visits + self.prior_strength
        return fixed(np.divide(table, visits, out=table, where=visits > 0))

    @cached_property
    def visits(self) -> FloatArray:
        """`[factor, context..., action]`: how often each row was tried (soft counts, as real numbers)."""
        return fixed(self.counts.sum(-1) / self.unit)

    @cached_property
    def by_outcome(self) -> FloatArray:
        """`[factor, context..., outcome, action]`: `predictive`, laid out to be read backwards."""
        return fixed(np.ascontiguousarray(np.swapaxes(self.predictive, -1, -2)))

    @cached_property
    def mean(self) -> FloatArray:
        """`[factor, context..., action]`: E[outcome | context, action] in the outcome's unit."""
        points = self.outcome.points.reshape(len(self.factors), *(1,) * (len(self.contexts) + 1), self.outcome.size)
        return fixed((self.predictive * points).sum(-1))

    @cached_property
    def habits(self) -> FloatArray:
        """`[factor, context..., action]`: P(action | context), how often each action was taken there.

        Law: (visits + k g) / (sum of visits + k), with g the linear-Gaussian fit action = f(contexts) of the same
        experience and k the prior strength: the learned prior over actions of Eq. (1) when there is no goal but to move
        as one is used to. Where nothing was tried and k is 0 the row is zero.
        """
        table = self.visits.copy()
        if self.prior_strength > 0:
            table += self.prior_strength * self._usual_action()
        total = table.sum(-1, keepdims=True)
        return fixed(np.divide(table, total, out=table, where=total > 0))

    def linear(self) -> LinearFit:
        """The least-squares line outcome = f(contexts, action) of the same experience."""
        inputs = [axis.name for axis in self.axes[:-1]]
        return self.moments.fit([self.outcome.name], inputs)

    def prior(self) -> FloatArray:
        """`[factor, context..., action, outcome]`: the linear-Gaussian fit, assigned softly to the outcome grid; of
        categories, what happens in that context whatever one does, itself shrunk towards anything alike by one count.

        A mean beyond the outcome's range is clipped into it: an all-but-empty row would otherwise turn uniform.
        """
        if not self.outcome.is_categorical:
            return self._gaussian(self.outcome, self.axes[:-1])
        usual = self.counts.sum(-2, keepdims=True) / self.unit
        return np.asarray((usual + 1 / self.outcome.size) / (usual.sum(-1, keepdims=True) + 1))

    @property
    def categorical(self) -> bool:
        """Whether every axis holds categories."""
        return all(axis.is_categorical for axis in self.axes)

    def _usual_action(self) -> FloatArray:
        """`[factor, context..., action]`: what is done as a rule, in contexts of which nothing is known."""
        if not self.outcome.is_categorical:
            return self._gaussian(self.action, self.contexts)
        usual = self.visits.sum(tuple(range(1, 1 + len(self.contexts))), keepdims=True)
        return np.asarray((usual + 1 / self.action.size) / (usual.sum(-1, keepdims=True) + 1))

    def _gaussian(self, target: Axis, inputs: Sequence[Axis]) -> FloatArray:
        """P(target | inputs) of the least-squares line, on the grids: `[factor, inputs..., target]`."""
        fit = self.moments.fit([target.name], [axis.name for axis in inputs])
        factors = len(self.factors)
        wide = (factors, *(1,) * len(inputs))
        mean = fit.coefficients[:, 0, 0].reshape(wide)
        for i, axis in enumerate(inputs):
            along = [factors, *(1,) * len(inputs)]
            along[1 + i] = axis.size
            mean = mean + fit.coefficients[:, 0, 1 + i].reshape(wide) * axis.points.reshape(along)
        spread = np.sqrt(fit.covariance[:, 0, 0]).reshape(wide)
        low, high, step = (v.reshape(wide) for v in (target.low, target.high, target.step))
        return hat_mass(
            (np.clip(mean, low, high) - low) / step, np.broadcast_to(spread / step, mean.shape), target.size
        )

    def at(self, context: Sequence[ArrayLike]) -> "Rows":
        """The rows of one (..., F) array per context axis: found once, asked as often as one likes."""
        return Rows(self, located(len(self.factors), self.contexts, context))

    def likelihood(self, context: Sequence[ArrayLike], outcome: ArrayLike) -> FloatArray:
        """(..., F, A): `Rows.backwards` of (..., F) values, wherever they lie."""
        return self.at(context).backwards(outcome)[0]

    def expected(self, context: Sequence[ArrayLike], action: ArrayLike) -> FloatArray:
        """E[outcome | context, action] in the outcome's unit: (..., F) values in, (..., F) out."""
        return self.at(context).expected(action)


class Rows(NamedTuple):
    """A forward model at some contexts; where these lie on their axes has been worked out."""

    forward_model: ForwardModel
    cells: Cells
    """Where the (..., F) contexts lie."""

    def backwards(self, outcome: ArrayLike) -> tuple[FloatArray, BoolArray]:
        """(..., F, A) P(outcome | context, every action) of (..., F) outcomes; (..., F) whether all lie on their axes.

        Soft assignment on both sides: the table is interpolated between the neighbouring contexts and outcomes.
        Values off an axis are taken at its nearest end.
        """
        there = self.cells.on(self.forward_model.outcome, outcome)
        return there.read(self.forward_model.by_outcome), there.inside

    def expected(self, action: ArrayLike) -> FloatArray:
        """(..., F) E[outcome | context, action] of (..., F) actions."""
        return self.cells.on(self.forward_model.action, action).read(self.forward_model.mean)

    def familiarity(self, action: ArrayLike | None = None) -> FloatArray:
        """(..., F, A) how often each action was tried here; (..., F) how often those nearest to `action` were."""
        visits, axis = self.forward_model.visits, self.forward_model.action
        cells = self.cells if action is None else self.cells.onto(axis, axis.hard(action))
        return cells.read(visits)
