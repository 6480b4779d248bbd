"""Inferring the intent of a teacher over time: Eq. (2) at every step, alone or as a Bayes filter (section 3.3.3).

Per step, the chapter's rule: each step is judged by itself with the full Eq. (2). As a filter: what was believed after
one step is the prior over goals at the next,

    P(g | steps 1 .. t) = k P(a_t | g, s_t) P(g | steps 1 .. t - 1),        P(g | nothing) = k P(s_1 | g) P(g),

so that P(s | g) enters at most once. Multiplying it in at every step would count the same evidence again and again.
Where only states were seen, actions are marginalised with one's own forward model: P(s_{t+1} | s_t, g) stands in for
P(a_t | g, s_t) (`step_evidence`).
"""

from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from imitation.errors import ImitationError
from imitation.inference.bayes import entropy, goal_posterior, unobserved_action


class Intent(NamedTuple):
    """What was believed of a teacher's goal, step by step."""

    probability: FloatArray
    """(T, G) P(g) after each step; rows sum to 1."""
    entropy: FloatArray
    """(T,) bits."""
    informed: BoolArray
    """(T,) False where a step was 0/0 under every goal: the belief was then left as it was."""

    @property
    def uninformed_steps(self) -> int:
        """How many steps said nothing because no goal explains them."""
        return int((~self.informed).sum())


def step_evidence(
    action_prior: FloatArray, states: IntArray, actions: IntArray | None, likelihood: FloatArray | None = None
) -> FloatArray:
    """(T, G) what each step says of each goal: P(a_t | g, s_t), or P(s_{t+1} | s_t, g) where no action was seen.

    Args:
        action_prior: (G, S, A) P(a | g, s).
        states: (T,) s_1 .. s_T.
        actions: (T,) a_1 .. a_T; None where only states were seen.
        likelihood: (T, A) P(s_{t+1} | s_t, a) of every action, by one's own forward model; needed without actions.

    Raises:
        ImitationError: neither actions nor a forward model's likelihood.
    """
    if actions is not None:
        return np.asarray(action_prior[:, states, actions].T)
    if likelihood is None:
        raise ImitationError("no actions were seen; a forward model's likelihood of each step has to stand in for them")
    return unobserved_action(likelihood, np.moveaxis(action_prior[:, states], 0, 1))


def intent_by_step(evidence: FloatArray, goal_prior: FloatArray, state_given_goal: FloatArray | None = None) -> Intent:
    """Eq. (2) for each step by itself; a step that is 0/0 leaves the prior over goals as it was.

    Args:
        evidence: (T, G) of `step_evidence`.
        goal_prior: (G,).
        state_given_goal: (T, G) P(s_t | g), or None to leave it out.
    """
    posterior = goal_posterior(np.ones((len(evidence), 1)), evidence, goal_prior, state_given_goal)
    probability = np.where(posterior.informed[:, None], posterior.probability, goal_prior)
    return Intent(probability, entropy(probability), posterior.informed)


def intent_filter(evidence: FloatArray, goal_prior: FloatArray) -> Intent:
    """The Bayes filter of the module's head; a step that is 0/0 leaves the belief as it was, counted.

    Args:
        evidence: (T, G) of `step_evidence`.
        goal_prior: (G,) P(g | nothing): P(g), or P(g | s_1) to use where the teacher began.
    """
    belief = goal_prior
    probability, informed = np.empty(evidence.shape), np.empty(len(evidence), bool)
    for t, seen in enumerate(evidence):
        posterior = goal_posterior(np.ones(1), seen, belief)
        informed[t] = posterior.informed
        belief = posterior.probability if informed[t] else belief
        probability[t] = belief
    return Intent(probability, entropy(probability), informed)


def in_blocks(values: FloatArray, length: int) -> FloatArray:
    """(ceil(T / length), ...) means over blocks of steps; the last block may be shorter."""
    if length < 1:
        raise ImitationError(f"blocks of {length} steps; at least 1 is needed")
    starts = np.arange(0, len(values), length)
    sizes = np.diff([*starts, len(values)]).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray(np.add.reduceat(values, starts, axis=0) / sizes)
