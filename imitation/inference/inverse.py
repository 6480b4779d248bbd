"""Inverse models: from where one is and where one wants to be, to what to do.

`BayesianInverse` is the project's: forward models turned round by Eq. (1). `LinearInverse` is its honest peer: least
squares on the same babbling. Both answer the same question, so the same loop runs either.

Where Eq. (1) with its prior is 0/0 there is a ladder of fallbacks: the forward model alone (a uniform prior), and a
last resort that always answers: the least-squares line of the same experience for measured axes, chance for categories.
The first rung that can decides, and every decision says its rung, so that whoever asks can count them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babbling.axes import Axis, BoolArray, FloatArray
from babbling.forward_model import ForwardModel, Rows
from imitation.errors import ImitationError
from imitation.inference.bayes import Posterior, action_posterior, joint_likelihood
from imitation.inference.priors import PriorTable
from imitation.inference.selection import selection_rule


class Rung(IntEnum):
    """Who decides, from the top."""

    INVERSE = 0
    """The inverse model itself: Eq. (1) with its prior."""
    FORWARD_ALONE = 1
    """Eq. (1) with a uniform prior."""
    LINE = 2
    """The least-squares line; a last resort."""
    CHANCE = 3
    """All actions alike; a last resort."""


MEASURED = (Rung.INVERSE, Rung.LINE)
"""Where all axes are measured."""
CATEGORIES = (Rung.INVERSE, Rung.FORWARD_ALONE, Rung.CHANCE)
"""Where axes are categories."""


class Decision(NamedTuple):
    """What the ladder said."""

    posterior: Posterior
    """(..., A) the probability of the rung that decided (a line has none: it is as Eq. (1) left it); evidence and
    `informed` are always those of Eq. (1)."""
    rung: NDArray[np.int8]
    """(...) the `Rung` that decided."""


def descend(
    likelihood: FloatArray, prior: ArrayLike | None, ladder: Sequence[Rung], beyond: BoolArray | bool = False
) -> Decision:
    """Eq. (1) and, where it is 0/0, the next rung that can decide.

    Args:
        likelihood: (..., A) as in `action_posterior`.
        prior: (..., A), or None for uniform.
        ladder: the rungs from `INVERSE` down, with or without `FORWARD_ALONE`, to one last resort.
        beyond: (...) what no table knows (off its axes): the last resort decides.
    """
    bayes = action_posterior(likelihood, prior)
    undecided = np.logical_not(bayes.informed) | beyond
    rung = np.zeros(undecided.shape, np.int8)
    if not undecided.any():
        return Decision(bayes, rung)
    probability = bayes.probability
    rung[undecided] = ladder[-1]
    if Rung.FORWARD_ALONE in ladder:
        alone = action_posterior(likelihood)
        able = undecided & alone.informed & np.logical_not(beyond)
        probability = np.where(able[..., None], alone.probability, probability)
        rung[able] = Rung.FORWARD_ALONE
    probability = np.where((rung == Rung.CHANCE)[..., None], 1.0 / likelihood.shape[-1], probability)
    return Decision(Posterior(probability, bayes.evidence, bayes.informed), rung)


@dataclass(frozen=True, eq=False)
class Term:
    """What an action should bring about: one likelihood P(s' | s, a)^w of Eq. (1)."""

    forward_model: ForwardModel
    """Who knows what actions lead to."""
    context: tuple[FloatArray, ...]
    """(B, F) where one is, for each of its context axes."""
    outcome: FloatArray
    """(B, F) the sub-goal."""
    weight: FloatArray | float = 1.0
    """w, or (F,) of them: 0 leaves the term out, 2 counts it twice."""

    def likelihood(self, actions: FloatArray) -> FloatArray:
        """(A, B, F) P(s' | s, a) of (A, B, F) actions."""
        model = self.forward_model
        rows = model.at([np.broadcast_to(context, actions.shape) for context in self.context])
        where = rows.cells.on(model.action, actions).on(model.outcome, np.broadcast_to(self.outcome, actions.shape))
        return where.read(model.predictive)

    @cached_property
    def rows(self) -> Rows:
        """The forward model at the context, found once for all who ask."""
        return self.forward_model.at(self.context)


class Choice(NamedTuple):
    """Actions, and what led to them."""

    action: FloatArray
    """(B, F) in the action axis' unit."""
    posterior: Posterior | None
    """Eq. (1)'s result, (B, F, A) and (B, F); None for inverse models that have no beliefs."""
    rung: NDArray[np.int8]
    """(B, F) the `Rung` of the ladder that decided."""

    @property
    def uninformed(self) -> BoolArray:
        """(B, F) where a fallback acted."""
        return np.not_equal(self.rung, Rung.INVERSE)


class InverseModel(Protocol):
    """Chooses actions for all factors of all copies at once."""

    def choose(self, terms: Sequence[Term], rng: np.random.Generator) -> Choice:
        """One action for all terms; inverse models that answer a single question refuse several."""

    def expect(self, context: tuple[FloatArray, ...], action: FloatArray) -> FloatArray:
        """(B, F) contexts and action in, expected outcome out: the forward model behind this inverse."""


class BayesianInverse:
    """Eq. (1) with a selection rule: P(a | ...) = c prod_k P(s'_k | s_k, a)^w_k P(a | s, g); where it is 0/0 or a term
    with a weight is off its axes, the ladder of measured axes, or of categories where one axis is categorical.

    Args:
        forward_model: of the first term; the habit, the line and what is expected are its own.
        selection: name of a selection rule.
        trust: (F,) or scalar exponent of the habit P(a | s) as the prior over actions (`ForwardModel.habits`); 0 is the
            uniform prior.
        prior: P(a | s) that replaces the habit: a `PriorTable` on some of the forward model's axes, or whatever
            `PriorTable.of` takes on all of them: (A,), (F, A), `[factor, context..., action]` or a function.

    Raises:
        ImitationError: a prior of another shape, below 0 or not finite.
    """

    def __init__(
        self,
        forward_model: ForwardModel,
        selection: str = "mean",
        *,
        trust: FloatArray | float = 1.0,
        prior: PriorTable | ArrayLike | Callable[..., ArrayLike] | None = None,
    ) -> None:
        self.forward_model, self.rule = forward_model, selection_rule(selection)
        categories = any(axis.is_categorical for axis in forward_model.axes)
        self.ladder = CATEGORIES if categories else MEASURED
        self.line = None if categories else LinearInverse(forward_model)
        table = forward_model.habits
        exponent = np.broadcast_to(np.asarray(trust, float), (len(forward_model.factors),))
        table = table ** exponent.reshape(-1, *(1,) * (table.ndim - 1))
        total = table.sum(-1, keepdims=True)
        self.habits = np.divide(table, total, out=np.zeros_like(table), where=total > 0)
        if prior is not None:
            own = forward_model.action, forward_model.contexts
            told = prior if isinstance(prior, PriorTable) else PriorTable.of(prior, own[0], *own[1])
            self.habits = told.over(*own)

    def choose(self, terms: Sequence[Term], rng: np.random.Generator) -> Choice:
        """See `InverseModel`.

        Raises:
            ImitationError: terms that do not share their actions and factors, or a term that does not fit its forward
                model.
        """
        self._check(terms)
        prior = terms[0].rows.cells.read(self.habits)
        likelihoods, beyond = [], np.zeros(1, bool)
        for term in terms:
            likelihood, inside = term.rows.backwards(term.outcome)
            likelihoods.append(likelihood)
            beyond = beyond | ~inside & (np.asarray(term.weight) > 0)
        joint = joint_likelihood(likelihoods, [term.weight for term in terms])
        posterior, rung = descend(joint, prior, self.ladder, beyond)
        action = self.rule(posterior.probability, self.forward_model.action, rng)
        if self.line is not None and rung.any():
            action = np.where(rung == Rung.LINE, self.line.choose(terms[:1], rng).action, action)
        return Choice(action, posterior, rung)

    def expect(self, context: tuple[FloatArray, ...], action: FloatArray) -> FloatArray:
        """See `InverseModel`."""
        return self.forward_model.expected(context, action)

    def _check(self, terms: Sequence[Term]) -> None:
        if not terms or terms[0].forward_model is not self.forward_model:
            raise ImitationError("the first term must be of the forward model that this inverse was made of")
        for number, term in enumerate(terms):
            model = term.forward_model
            if number and not model.action.same(self.forward_model.action):
                ours, theirs = _described(self.forward_model.action), _described(model.action)
                raise ImitationError(f"term {number}: actions are {theirs}; those of term 0, {ours}, must be shared")
            if len(term.context) != len(model.contexts):
                raise ImitationError(
                    f"term {number}: {len(term.context)} contexts; its forward model has {len(model.contexts)} "
                    f"({', '.join(axis.name for axis in model.contexts)})"
                )
            shape = terms[0].outcome.shape
            for value in (term.outcome, *term.context):
                if value.shape != shape:
                    raise ImitationError(f"term {number}: shape {value.shape} beside {shape} of the sub-goal of term 0")


class LinearInverse:
    """a = b_0 + sum_i b_i context_i + b outcome, least squares on the forward model's own experience.

    Raises:
        ImitationError: an axis of categories, through which no line goes.
    """

    def __init__(self, forward_model: ForwardModel) -> None:
        for axis in forward_model.axes:
            if axis.is_categorical:
                raise ImitationError(f"axis {axis.name!r} holds categories, no line goes through them")
        inputs = [*(axis.name for axis in forward_model.contexts), forward_model.outcome.name]
        self.fit = forward_model.moments.fit([forward_model.action.name], inputs)
        self.forward = forward_model.linear()

    def choose(self, terms: Sequence[Term], rng: np.random.Generator) -> Choice:
        """See `InverseModel`."""
        term = single(terms)
        action = self.fit.predict(*term.context, term.outcome)[..., 0]
        return Choice(action, None, np.zeros(action.shape, np.int8))

    def expect(self, context: tuple[FloatArray, ...], action: FloatArray) -> FloatArray:
        """See `InverseModel`."""
        return self.forward.predict(*context, action)[..., 0]


def single(terms: Sequence[Term]) -> Term:
    """The only term, for inverse models that answer a single question.

    Raises:
        ImitationError: several terms, or none.
    """
    if len(terms) != 1:
        raise ImitationError(f"{len(terms)} terms: this inverse model answers one; BayesianInverse multiplies several")
    return terms[0]


def _described(axis: Axis) -> str:
    return f"{axis.name!r}, {axis.size} from {axis.low[0]:g} to {axis.high[0]:g}, {axis.factors} factors"
