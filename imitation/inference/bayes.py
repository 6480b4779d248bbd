"""Eq. (1) and Eq. (2) of the chapter: the forward model turned round to choose actions, and once more to infer goals.

Both are written on arrays with any leading dimensions; they know no body and no table. Nothing is smoothed away: where
every action (or goal) is impossible the posterior is 0/0, its row is zero, `informed` is False and the caller must
name what it does instead.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import mul

import numpy as np
from numpy.typing import ArrayLike

from babbling.axes import BoolArray, FloatArray
from imitation.errors import ImitationError


@dataclass(frozen=True, eq=False)
class Posterior:
    """P(a_t = A_i | s_t, s_{t+1}, s_G) of Eq. (1), or P(s_G = S_k | a_t, s_t, s_{t+1}) of Eq. (2)."""

    probability: FloatArray
    """(..., A) or (..., G) sums to 1 where informed, all zeros where not."""
    evidence: FloatArray
    """(...) the normaliser: P(s_{t+1} | s_t, s_G) = sum_m P(s_{t+1} | s_t, A_m) P(A_m | s_t, s_G), the 1/c of Eq. (1),
    or 1/k_3 of Eq. (2)."""
    informed: BoolArray
    """(...) False where the evidence is zero."""

    @cached_property
    def entropy(self) -> FloatArray:
        """(...) `entropy` of the probability."""
        return entropy(self.probability)


def entropy(probability: FloatArray) -> FloatArray:
    """(...) -sum_i p_i log2 p_i of (..., A), bits; 0 where all are zero."""
    logs = np.zeros_like(probability)
    np.log2(probability, out=logs, where=probability > 0)
    return np.asarray(-(probability * logs).sum(-1))


def action_posterior(likelihood: ArrayLike, prior: ArrayLike | None = None) -> Posterior:
    """Eq. (1): P(a | s, s', g) = c P(s' | s, a) P(a | s, g).

    Args:
        likelihood: (..., A) P(s' = sub-goal | s, a) for every action: a row of the forward model, read backwards
            (`ForwardModel.likelihood`).
        prior: (..., A) P(a | s, g), broadcast against the likelihood; None is uniform. Only proportions within a row
            matter to the posterior; the evidence takes the prior as given, so it should sum to one.

    Raises:
        ImitationError: a negative or non-finite probability.
    """
    likely = _checked("likelihood", likelihood)
    actions = likely.shape[-1]
    weight = np.full(actions, 1.0 / actions) if prior is None else _checked("prior over actions", prior)
    return _normalised(likely * weight)


def joint_likelihood(likelihoods: Sequence[FloatArray], weights: Sequence[ArrayLike]) -> FloatArray:
    """prod_k P(s'_k | s_k, a)^w_k: several sub-goals that one action should reach, for Eq. (1).

    Args:
        likelihoods: (..., A) each, at least one, of any shapes that broadcast.
        weights: w_k, (...) each: 1 counts a likelihood as it is, 2 as if it were given twice, 0 leaves it out.

    Raises:
        ImitationError: a negative or non-finite weight.
    """
    powers: list[FloatArray] = []
    for number, (likelihood, given) in enumerate(zip(likelihoods, weights, strict=True)):
        if np.ndim(given) or given != 1:
            weight = np.asarray(given, float)
            if not (weight.min() >= 0 and weight.max() < np.inf):
                raise ImitationError(f"term {number}: weight {given}; it must be finite and at least 0")
            likelihood = likelihood ** weight[..., None]
        powers.append(likelihood)
    return reduce(mul, powers)


def goal_posterior(
    likelihood: ArrayLike, action_prior: ArrayLike, goal_prior: ArrayLike, state_given_goal: ArrayLike | None = None
) -> Posterior:
    """Eq. (2): P(g | a, s, s') = k P(s' | s, a, g) P(a | g, s) P(s | g) P(g).

    Args:
        likelihood: (..., 1) or (..., G) P(s' | s, a, g); the forward model does not depend on the goal, so an observed
            action gives one number per row and it cancels.
        action_prior: (..., G) P(a | s, g) of the action that was seen; where none was, `unobserved_action` and a
            likelihood of 1.
        goal_prior: (..., G) P(g), or the posterior of the step before (a filter over time).
        state_given_goal: (..., G) P(s | g); None leaves the factor out (1 for every goal). A filter uses it once.
    """
    weight = _checked("likelihood", likelihood) * _checked("prior over actions", action_prior)
    weight = weight * _checked("prior over goals", goal_prior)
    if state_given_goal is not None:
        weight = weight * _checked("P(state | goal)", state_given_goal)
    return _normalised(weight)


def unobserved_action(likelihood: ArrayLike, action_prior: ArrayLike) -> FloatArray:
    """(..., G) P(s' | s, g) = sum_a P(s' | s, a) P(a | g, s): what stands in Eq. (2) where no action was seen.

    Args:
        likelihood: (..., A) P(s' | s, a) of what was seen, for every action.
        action_prior: (..., G, A) P(a | s, g).
    """
    likely = _checked("likelihood", likelihood)
    return np.asarray((likely[..., None, :] * _checked("prior over actions", action_prior)).sum(-1))


def _checked(name: str, values: ArrayLike) -> FloatArray:
    array = np.asarray(values, float)
    if not (array.min(initial=0) >= 0 and array.max(initial=0) < np.inf):
        bad = array[~((array >= 0) & np.isfinite(array))].flat[0]
        raise ImitationError(f"{name}: {bad:g} is not a probability; all entries must be finite and at least 0")
    return array


def _normalised(joint: FloatArray) -> Posterior:
    """`joint` is normalised in place."""
    evidence: FloatArray = joint.sum(-1)
    informed = evidence > 0
    joint /= np.where(informed, evidence, 1.0)[..., None]  # nothing to divide where all are zero
    return Posterior(joint, evidence, informed)
