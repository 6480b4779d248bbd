"""Priors learned by counting what was watched: P(a | s, g) and P(s | g) (chapter, sections 3.2 and 3.3.2).

"This can be achieved by keeping a count of the number of times each action is executed at each location, given a fixed
goal location." Where nobody was watched the prior is zero, not unknown: that is kept, shown and counted. Smoothing is a
choice of the one who asks, never a default:

    P(a | s, g) = (n[g, s, a] + k) / (n[g, s] + k A)        P(s | g) = (n[g, s] + k) / (n[g] + k S)
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import expit, gammaln

from babbling.axes import FloatArray, IntArray, fixed
from imitation.episodes import Episode, check_range
from imitation.errors import ImitationError


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
