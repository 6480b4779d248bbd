"""Priors: any P(a | s) as a table, and those learned by counting what was watched (chapter, sections 3.2 and 3.3.2).

"This can be achieved by keeping a count of the number of times each action is executed at each location, given a fixed
goal location." Where nobody was watched the prior is zero, not unknown: that is kept, shown and counted. Smoothing is a
choice of the one who asks, never a default:

    P(a | s, g) = (n[g, s, a] + k) / (n[g, s] + k A)        P(s | g) = (n[g, s] + k) / (n[g] + k S)
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import expit, gammaln

from babbling.axes import Axis, FloatArray, IntArray, fixed, located
from imitation.episodes import Episode, check_range
from imitation.errors import ImitationError


@dataclass(frozen=True, eq=False)
class PriorTable:
    """P(action | context) on a grid of actions, in no context or on the grids of some: what inverse models take."""

    probability: FloatArray
    """(F, C..., A): rows sum to 1, or are zero where nothing is allowed."""
    action: Axis
    contexts: tuple[Axis, ...]

    @classmethod
    def of(cls, given: ArrayLike | Callable[..., ArrayLike], action: Axis, *contexts: Axis) -> "PriorTable":
        """Any P(action | context); only proportions within a row matter: each is made to sum to 1.

        Args:
            given: (A,) numbers for all F factors and contexts alike, (F, A) for all contexts alike, (F, C..., A); or a
                function of the grid points of the contexts and of the actions, (F, C..., A) each, to such numbers.
            action: its axis, of F factors and A points.
            contexts: axes of F factors and C... points, as many as the prior depends on.

        Raises:
            ImitationError: another shape, numbers below 0 or not finite, axes that differ in their factors.
        """
        axes, factors = (*contexts, action), action.factors
        if any(axis.factors != factors for axis in axes):
            told = ", ".join(f"{axis.factors} of {axis.name!r}" for axis in axes)
            raise ImitationError(f"prior on axes of different factors ({told}): one for each motor")
        shape = (factors, *(axis.size for axis in axes))
        if callable(given):
            points = [
                axis.points.reshape(factors, *(axis.size if n == one else 1 for n in range(len(axes))))
                for one, axis in enumerate(axes)
            ]
            given = given(*np.broadcast_arrays(*points))
        numbers = np.asarray(given, float)
        able = list(dict.fromkeys([shape[-1:], (factors, shape[-1]), shape]))
        if numbers.shape not in able:
            raise ImitationError(f"prior of shape {numbers.shape}: {' or '.join(map(str, able))} is possible here")
        if not ((numbers >= 0) & np.isfinite(numbers)).all():
            bad = numbers[~((numbers >= 0) & np.isfinite(numbers))].flat[0]
            raise ImitationError(f"prior of shape {numbers.shape} holds {bad:g}: numbers must be finite and at least 0")
        if numbers.ndim == 2:
            numbers = numbers.reshape(factors, *(1,) * len(contexts), -1)
        total = numbers.sum(-1, keepdims=True)
        even = (abs(total - 1) < 1e-9) | (total == 0)  # numbers that sum to 1 stay as they are, to the last bit
        return cls(np.broadcast_to(numbers / np.where(even, 1, total), shape), action, contexts)

    def over(self, action: Axis, contexts: Sequence[Axis]) -> FloatArray:
        """(F, C..., A) the same prior on all these axes.

        Raises:
            ImitationError: it is about other actions, or depends on something else.
        """
        if not self.action.same(action) or not all(any(mine.same(one) for one in contexts) for mine in self.contexts):
            mine, told = (", ".join(axis.name for axis in axes) for axes in ((*self.contexts, self.action), contexts))
            raise ImitationError(
                f"prior on the axes {mine}: its actions must be on the forward model's own axis {action.name!r}, what "
                f"it depends on on some of its contexts ({told or 'it has none'})"
            )
        places = [next(n for n, one in enumerate(contexts) if one.same(mine)) for mine in self.contexts]
        table = self.probability.transpose(0, *(np.argsort(places) + 1), -1)
        sizes = [axis.size if n in places else 1 for n, axis in enumerate(contexts)]
        whole = (len(table), *(axis.size for axis in contexts), action.size)
        return np.broadcast_to(table.reshape(len(table), *sizes, action.size), whole)

    def log(self, context: Sequence[FloatArray], actions: FloatArray) -> FloatArray:
        """(..., F) log P(a | s) up to a constant, of (..., F) actions in contexts that broadcast against them.

        Between grid points it is interpolated; beyond the ends of the actions' axis nothing is allowed.
        """
        values = [np.broadcast_to(one, actions.shape) for one in context]
        found = located(self.action.factors, (*self.contexts, self.action), [*values, actions]).read(self.probability)
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(np.where(self.action.soft(actions).inside, found, 0)))

    def nearest(self, context: Sequence[FloatArray], actions: FloatArray) -> FloatArray:
        """(..., F) the same actions where they are allowed, else the nearest grid point that is."""
        row = located(self.action.factors, self.contexts, context).read(self.probability)
        row = np.broadcast_to(row, (*actions.shape, self.action.size))
        away = np.where(row > 0, abs(self.action.points - actions[..., None]), np.inf).argmin(-1)
        there = np.take_along_axis(np.broadcast_to(self.action.points, row.shape), away[..., None], -1)[..., 0]
        return np.where(np.isfinite(self.log(context, actions)), actions, there)


@dataclass(frozen=True, eq=False)
class ActionPriors:
    """How often each action was executed in each state on the way to each goal."""

    counts: IntArray
    """(G, S, A)."""

    @classmethod
    def learned(cls, episodes: Sequence[Episode], goals: int, states: int, actions: int) -> "ActionPriors":
        """Count the actions of demonstrations.

        Raises:
            ImitationError: a demonstration that does not fit these sizes.
        """
        check_range(episodes, goals, states, actions)
        index = [np.zeros(0, np.int64)]
        index += [(e.goal * states + e.states[:-1]) * actions + e.actions for e in episodes]
        counts = np.bincount(np.concatenate(index), minlength=goals * states * actions)
        return cls(fixed(counts.reshape(goals, states, actions)))

    def action(self, smoothing: float = 0.0) -> FloatArray:
        """(G, S, A) P(a | s, g); without smoothing, rows of states never watched are zero.

        Raises:
            ImitationError: negative or infinite smoothing.
        """
        return _share(self.counts + check_smoothing(smoothing))

    def state(self, smoothing: float = 0.0) -> FloatArray:
        """(G, S) P(s | g): how often a state was visited on the way to a goal. Long demonstrations spread it thin."""
        return _share(self.counts.sum(-1) + check_smoothing(smoothing))

    def doubtful(self, smoothing: float) -> FloatArray:
        """(G, S, A) P(a | s, g), in doubt whether the goal matters in state s at all: for filters over many steps.

        A few demonstrations differ by accident where the way is common, and a filter that multiplies such accidents
        grows sure of a wrong goal. So two hypotheses are averaged in each state, weighed by how well they predict its
        own counts: one teacher's habit for all goals, or one for each (Dirichlet-multinomial evidence, k = smoothing):

            P(a | s, g) = w (n[s, a] + k) / (n[s] + k A) + (1 - w) (n[g, s, a] + k) / (n[g, s] + k A)
            w / (1 - w) = D(n[s, .]) / prod_g D(n[g, s, .])

        Raises:
            ImitationError: smoothing that is not above 0 (the evidence is then not defined).
        """
        if not check_smoothing(smoothing) > 0:
            raise ImitationError("smoothing 0: doubt about counts needs pseudo-counts above 0, such as 0.1")
        pooled = self.counts.sum(0)
        odds = _dirichlet_evidence(self.counts, smoothing).sum(0) - _dirichlet_evidence(pooled, smoothing)
        common = expit(-odds)[:, None]
        return np.asarray(common * _share(pooled + smoothing) + (1 - common) * _share(self.counts + smoothing))


def check_smoothing(smoothing: float) -> float:
    """Pseudo-counts per cell that make sense.

    Raises:
        ImitationError: negative or infinite ones.
    """
    if not 0 <= smoothing < np.inf:
        raise ImitationError(f"smoothing {smoothing:g}: pseudo-counts must be at least 0 and finite")
    return smoothing


def check_goal_prior(prior: Sequence[float], goals: int) -> FloatArray:
    """(G,) P(g) as given.

    Raises:
        ImitationError: wrong length, a negative entry, or a sum that is not one.
    """
    values = np.array(prior, float)
    if values.shape != (goals,):
        raise ImitationError(f"goal prior of {values.size} numbers; there are {goals} goals, give one for each")
    if not (values >= 0).all() or not np.isfinite(values).all():
        raise ImitationError(f"goal prior {', '.join(f'{v:g}' for v in values)}: probabilities are at least 0")
    if abs(values.sum() - 1) > 1e-6:
        raise ImitationError(f"goal prior {', '.join(f'{v:g}' for v in values)} sums to {values.sum():g}, not to 1")
    return np.asarray(values / values.sum())


def _dirichlet_evidence(counts: IntArray, k: float) -> FloatArray:
    """(...) log D(n) = log of the integral of prod_a p_a^n_a over p ~ Dirichlet(k, ..., k), for (..., A) counts."""
    actions = counts.shape[-1]
    total = gammaln(actions * k) - gammaln(counts.sum(-1) + actions * k)
    return np.asarray(total + (gammaln(counts + k) - gammaln(k)).sum(-1))


def _share(numbers: ArrayLike) -> FloatArray:
    counts = np.asarray(numbers, float)
    total = counts.sum(-1, keepdims=True)
    share = np.zeros_like(counts)
    np.divide(counts, total, out=share, where=total > 0)
    return share
