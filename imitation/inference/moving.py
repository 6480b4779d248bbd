"""Eq. (1) for one's own movements: which command brings about a wanted displacement, by all explanations at once.

    P(a | s, s', g) = c N(w; E[w | s, a], s^2) prod_k P(s'_k | s_k, a)^{w_k} P(a | s)^h

The likelihood is the average of rival explanations (`babbling.explanations`), P(a | s) the habit, h how far it is
trusted. An action is a real number: a first look, as far as stiction and play may carry, finds where the posterior is
more than nothing; there it is worked out at even distances. The most probable action is the default: where stiction or
play make two ways equally likely, their mean is neither.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple, Protocol

import numpy as np

from babbling.axes import Axis, BoolArray, FloatArray
from babbling.explanations import Explanations
from babbling.features import Echo
from babbling.mind import Mind
from babbling.outlook import Outlook
from imitation.errors import ImitationError
from imitation.inference.bayes import Posterior, action_posterior
from imitation.inference.inverse import Term
from imitation.inference.priors import PriorTable
from imitation.inference.selection import select_mean, selection_rule

CANDIDATES = 41
"""Actions at which the posterior is worked out."""
COARSE = 2.0
"""Where those of a first look begin to thin out, in standard deviations that the posterior would have on a line."""
DEEP = 16.0
"""What is so much less probable than the most probable action, nats, lies beyond their ends."""
FAR = (8.0, 4.0)
"""The first look reaches one and a half times so many of these standard deviations, or so many of the habit's."""

Prior = Callable[[Outlook, FloatArray], FloatArray]
"""What one is used to, for (A, B, F) actions c - q: (A, B, F) log P(a | s, g), up to a constant."""


CONTEXTS: dict[str, Callable[[Outlook], FloatArray]] = {
    "posture": lambda outlook: outlook.posture,
    "rate": lambda outlook: outlook.before[..., 1],
    "command": lambda outlook: outlook.echo.command,
}
"""What a `PriorTable` may depend on, by the names of its contexts; the command is the one before this."""


class Here(NamedTuple):
    """Where one is; arrays (B, F)."""

    posture: FloatArray
    rate: FloatArray
    echo: Echo
    """What earlier commands left."""
    pace: FloatArray
    """Rate that is wanted next."""
    ahead: FloatArray
    """(n, B, F) postures that are wanted, from the next tick on."""


class Decided(NamedTuple):
    """Actions, and what led to them."""

    action: FloatArray
    """(B, F) c - q."""
    candidates: FloatArray
    """(B, F, A) actions that were weighed; (B, F, 0) for inverse models without beliefs."""
    posterior: Posterior | None
    """Eq. (1) over them."""
    beyond: BoolArray
    """(B, F) where the table was asked beyond its axes, and answered with their ends."""

    @classmethod
    def bare(cls, action: FloatArray) -> "Decided":
        """Actions of an inverse model without beliefs."""
        return cls(action, np.zeros((*action.shape, 0)), None, np.zeros(action.shape, bool))


class MovingInverse(Protocol):
    """Chooses actions for all factors of all copies at once."""

    def choose(self, here: Here, wanted: FloatArray, terms: Sequence[Term], rng: np.random.Generator) -> Decided:
        """For (B, F) wanted displacements beyond coasting, and whatever else the terms want."""

    def expect(self, here: Here, command: FloatArray) -> FloatArray:
        """(B, F) expected displacement beyond coasting under (B, F) commands: the forward model behind this inverse."""


class AveragedInverse:
    """See the module.

    Args:
        forward_model: what babbling left.
        selection: name of a selection rule.
        trust: (F,) or (B, F) exponent h of the habit; 0 is the uniform prior.
        prior: what replaces the habit: a function to log P(a | s), or a `PriorTable` of actions c - q in rad, whose
            contexts are named as in `CONTEXTS`.
        candidates: actions at which the posterior is worked out.

    Raises:
        ImitationError: a prior that is neither, has other factors or contexts, or somewhere allows nothing.
    """

    def __init__(
        self,
        forward_model: Explanations,
        selection: str = "map",
        *,
        trust: FloatArray | float = 0.1,
        prior: Prior | PriorTable | None = None,
        candidates: int = CANDIDATES,
    ) -> None:
        self._even = np.linspace(-1, 1, candidates)
        self._places = Axis("candidate", "1", np.zeros(1), np.array([candidates - 1.0]), candidates)
        self.forward_model, self.rule = forward_model, selection_rule(selection)
        self.trust, self._table = np.asarray(trust, float), prior if isinstance(prior, PriorTable) else None
        if self._table is not None:
            _check(self._table, len(forward_model.factors))
            prior = partial(_told, self._table)
        if not (prior is None or callable(prior)):
            raise ImitationError("prior: a function to log P(a | s), or PriorTable.of(numbers, action axis, contexts)")
        self.prior: Prior = prior or self.habit

    @classmethod
    def of(cls, mind: Mind, selection: str = "map", candidates: int = CANDIDATES) -> "AveragedInverse":
        """As a mind's temper has it."""
        temper = mind.temper
        model = mind.forward_model.by_pace(temper.trust >= 1).by_line(temper.simple > 0)
        return cls(model, selection, trust=temper.trust, candidates=candidates)

    def habit(self, outlook: Outlook, actions: FloatArray) -> FloatArray:
        """h log P(a | s): a Gaussian about the line through what babbling did."""
        return np.asarray(-0.5 * self.trust * ((actions - outlook.usual) / self.forward_model.habit[1]) ** 2)

    def expect(self, here: Here, command: FloatArray) -> FloatArray:
        """See `MovingInverse`."""
        return self.forward_model.at(here.posture, here.rate, here.echo).expected(command)

    def choose(self, here: Here, wanted: FloatArray, terms: Sequence[Term], rng: np.random.Generator) -> Decided:
        """See `MovingInverse`.

        Raises:
            ImitationError: a prior that is not a number, or allows no action that may be of use.
        """
        model, posture = self.forward_model, here.posture
        outlook = model.at(posture, here.rate, here.echo)
        last, count, even = here.echo.command, len(self._even), self._even[:, None, None]
        slope = np.maximum(np.abs(model.slope), 1e-6)
        near = last - posture + (wanted - outlook.expected(last)) / slope  # the line's answer
        width = 1 / np.sqrt((slope / model.spread) ** 2 + self.trust / model.habit[1] ** 2)
        reach = np.maximum(FAR[0] * width, FAR[1] * model.habit[1])
        if self._table is not None:
            near = self._table.nearest(_context(self._table, outlook), near)

        def logs(actions: FloatArray) -> tuple[FloatArray, FloatArray]:
            likelihood = -0.5 * ((wanted - outlook.expected(posture + actions)) / model.spread) ** 2
            for term in terms:
                likelihood = likelihood + term.weight * np.log(np.maximum(term.likelihood(actions), 1e-300))
            prior = self.prior(outlook, actions)
            if np.shape(prior) != actions.shape or not np.isfinite(prior.max(0)).all():
                raise ImitationError(
                    f"prior: log P(a | s) of shape {np.shape(prior)} for actions of shape {actions.shape} from "
                    f"{actions.min():.3g} to {actions.max():.3g} rad: one number each, not NaN, and not all -inf"
                )
            return likelihood, prior

        about = near + COARSE * width * np.sinh(even * np.arcsinh(1.5 * reach / (COARSE * width)))
        roughly = np.add(*logs(about))
        likely = roughly > roughly.max(0) - DEEP
        first, last = likely.argmax(0) - 1, count - likely[::-1].argmax(0)  # a place to spare on either side
        ends = np.clip(np.stack([first, last]), 0, count - 1)
        low, high = np.take_along_axis(about, ends, 0)
        actions = low + (high - low) * (even + 1) / 2
        likelihood, prior = logs(actions)
        top = likelihood.max(0), prior.max(0)
        weight = np.exp(prior - top[1])
        found = action_posterior(
            np.moveaxis(np.exp(likelihood - top[0]), 0, -1), np.moveaxis(weight / weight.sum(0), 0, -1)
        )
        posterior = Posterior(found.probability, found.evidence * np.exp(top[0]), found.informed)
        candidates = np.moveaxis(actions, 0, -1)
        if self.rule is select_mean:
            action = (posterior.probability * candidates).sum(-1)
        else:
            action = low + (high - low) * self.rule(posterior.probability, self._places, rng) / (count - 1)
        if self._table is not None:  # rules draw between candidates
            action = self._table.nearest(_context(self._table, outlook), action)
        return Decided(action, candidates, posterior, outlook.beyond(posture + action))


def _context(table: PriorTable, outlook: Outlook) -> list[FloatArray]:
    return [CONTEXTS[axis.name](outlook) for axis in table.contexts]


def _told(table: PriorTable, outlook: Outlook, actions: FloatArray) -> FloatArray:
    return table.log(_context(table, outlook), actions)


def _check(table: PriorTable, factors: int) -> None:
    names = [axis.name for axis in table.contexts]
    if table.action.factors != factors or not set(names) <= set(CONTEXTS):
        raise ImitationError(
            f"prior of {table.action.factors} factors, given {', '.join(names) or 'nothing'}: there are {factors} "
            f"factors, and it may be given {', '.join(CONTEXTS)}"
        )
    if not table.probability.sum(-1).all():
        raise ImitationError("prior: a row is all zero, so that no action is allowed there; give it at least one")
