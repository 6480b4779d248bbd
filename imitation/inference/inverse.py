"""Inverse models: from where one is and where one wants to be, to what to do.

`BayesianInverse` is the project's: the forward model turned round by Eq. (1). `LinearInverse` is its honest peer: least
squares on the same babbling. Both answer the same question, so the same loop runs either.
"""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray
from babbling.forward_model import ForwardModel
from babbling.grids import interpolate
from imitation.inference.bayes import ActionPosterior, action_posterior
from imitation.inference.selection import selection_rule


class Choice(NamedTuple):
    """Actions, and what led to them."""

    action: FloatArray
    """(B, F) in the action axis' unit."""
    posterior: ActionPosterior | None
    """Eq. (1)'s result, (B, F, A) and (B, F); None for inverse models that have no beliefs."""
    uninformed: NDArray[np.bool_]
    """(B, F) where Eq. (1) was 0/0 and the fallback acted."""


class InverseModel(Protocol):
    """Chooses actions for all factors of all copies at once."""

    def choose(self, context: FloatArray, outcome: FloatArray, rng: np.random.Generator) -> Choice:
        """(B, F) context and wanted outcome in, a `Choice` out."""

    def expect(self, context: FloatArray, action: FloatArray) -> FloatArray:
        """(B, F) context and action in, expected outcome out: the forward model behind this inverse."""


class BayesianInverse:
    """Eq. (1) with a selection rule. Where no action ever led to the sub-goal (0/0), the fallback named *line* acts:
    the least-squares line of the same experience; such selections are counted by whoever asks.

    Args:
        forward_model: one context axis, measured.
        selection: name of a selection rule.
        habit: (F,) or scalar exponent of the habit P(a | s) as the prior over actions (`ForwardModel.habit`); 0 is the
            uniform prior.
        prior: (F, A) prior over actions that replaces the habit.
    """

    def __init__(
        self,
        forward_model: ForwardModel,
        selection: str = "mean",
        *,
        habit: FloatArray | float = 1.0,
        prior: FloatArray | None = None,
    ) -> None:
        self.forward_model, self.rule, self.prior = forward_model, selection_rule(selection), prior
        self.line = LinearInverse(forward_model)
        exponent = np.broadcast_to(np.asarray(habit, float), (len(forward_model.factors),))
        table = forward_model.habits() ** exponent[:, None, None]
        self.habits = table / table.sum(-1, keepdims=True)

    def choose(self, context: FloatArray, outcome: FloatArray, rng: np.random.Generator) -> Choice:
        """See `InverseModel`."""
        prior = self.prior
        if prior is None:
            prior = interpolate(self.habits, self.forward_model.contexts, (context,))
        posterior = action_posterior(self.forward_model.likelihood((context,), outcome), prior)
        action = self.rule(posterior.probability, self.forward_model.action, rng)
        uninformed = ~posterior.informed | ~self.forward_model.inside((context,), outcome)
        if uninformed.any():
            action = np.where(uninformed, self.line.choose(context, outcome, rng).action, action)
        return Choice(action, posterior, uninformed)

    def expect(self, context: FloatArray, action: FloatArray) -> FloatArray:
        """See `InverseModel`."""
        return self.forward_model.expected((context,), action)


class LinearInverse:
    """a = b_0 + b_1 context + b_2 outcome, least squares on the forward model's own experience."""

    def __init__(self, forward_model: ForwardModel) -> None:
        inputs = [*(axis.name for axis in forward_model.contexts), forward_model.outcome.name]
        self.fit = forward_model.moments.fit([forward_model.action.name], inputs)
        self.forward = forward_model.linear()

    def choose(self, context: FloatArray, outcome: FloatArray, rng: np.random.Generator) -> Choice:
        """See `InverseModel`."""
        return Choice(self.fit.predict(context, outcome)[..., 0], None, np.zeros(outcome.shape, bool))

    def expect(self, context: FloatArray, action: FloatArray) -> FloatArray:
        """See `InverseModel`."""
        return self.forward.predict(context, action)[..., 0]
