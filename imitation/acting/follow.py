"""From sub-goal to sub-goal: imitation in discrete states by Eq. (1) (chapter, section 3.3.2).

At each step (`Follower.step`): the sub-goal of the state one is in, or, pushed off the demonstrated way, the state one
came from ("backtracking over a previous step"); the forward model read backwards at the outcome that leads there; the
learned prior; Eq. (1); one action by a selection rule. Where Eq. (1) is 0/0 the ladder of fallbacks is, each rung
counted: the forward model alone (uniform prior), then chance. What states, outcomes and contexts are is handed in.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from babbling.axes import BoolArray, FloatArray, IntArray, located
from babbling.body import Body
from babbling.forward_model import ForwardModel
from babbling.states import StateMap
from imitation.errors import ImitationError
from imitation.inference.inverse import CATEGORIES, Rung, descend
from imitation.inference.selection import selection_rule


class Way(NamedTuple):
    """All that the next step needs, never changed."""

    here: IntArray
    """(B,) state; the goal from arrival on."""
    came_from: IntArray
    """(B, S) the state from which each was first entered, -1 where never: such ways back cannot form a circle."""
    arrived: BoolArray
    """(B,)."""


class Decisions(NamedTuple):
    """What was decided, (B, ...) at one step or (T, B, ...) over a journey; after arrival -1, 0 and False."""

    subgoal: IntArray
    """The state that was aimed at."""
    action: IntArray
    """What was done."""
    posterior: FloatArray
    """(..., A) what Eq. (1), or the rung of the ladder that decided, said."""
    entropy: FloatArray
    """Of that posterior, bits."""
    evidence: FloatArray
    """P(sub-goal | state, goal), the 1/c of Eq. (1)."""
    forward_alone: BoolArray
    """Eq. (1) was 0/0 and the forward model alone decided."""
    chance: BoolArray
    """The forward model was 0/0 as well and chance decided."""
    backtracking: BoolArray
    """The sub-goal was the state one came from."""


NOTHING = Decisions._make(np.array(value) for value in (-1, -1, 0.0, 0.0, 0.0, False, False, False))


@dataclass(frozen=True, eq=False)
class Journey:
    """How imitations went, B copies at once; T is the step of the last arrival, or the limit."""

    states: IntArray
    """(T + 1, B) state before the first step and after each; the goal from arrival on."""
    decisions: Decisions
    """(T, B, ...)."""
    steps: IntArray
    """(B,) steps to the goal, or the limit where it was not reached."""
    reached: BoolArray
    """(B,) whether the goal was reached within the limit."""
    ended: str | None = None
    """Why it ended early, if it did."""


def believed(forward_model: ForwardModel) -> FloatArray:
    """`[factor, context..., action, outcome]`: learned rows; an action nobody tried says nothing: uniform."""
    untried = forward_model.visits[..., None] == 0
    return np.where(untried, 1.0 / forward_model.outcome.size, forward_model.predictive)


class Follower:
    """Copies that go from sub-goal to sub-goal, to be driven step by step.

    Args:
        forward_model: one factor for all copies, or one per copy.
        states: how senses are read, as when the forward model was learned.
        successor: (S,) or (B, S) sub-goal of each state, -1 where there is none (`Route.successor`).
        goal: (B,) or one state to end in.
        prior: (S, A) or (B, S, A) P(a | s, g) for the goal; None is uniform everywhere.
        copies: B.
        selection: name of a selection rule.
    """

    def __init__(
        self,
        forward_model: ForwardModel,
        states: StateMap,
        successor: IntArray,
        goal: ArrayLike,
        prior: FloatArray | None = None,
        *,
        copies: int = 1,
        selection: str = "map",
    ) -> None:
        self.forward_model, self.states, self.rule = forward_model, states, selection_rule(selection)
        self.by_outcome = np.ascontiguousarray(np.swapaxes(believed(forward_model), -1, -2))
        size, actions = successor.shape[-1], forward_model.action.size
        self.successor = np.broadcast_to(successor, (copies, size))
        self.goal = np.broadcast_to(np.asarray(goal), copies)
        self.prior = np.broadcast_to(1.0 / actions if prior is None else prior, (copies, size, actions))
        self.copy = np.arange(copies)

    def start(self, senses: FloatArray) -> Way:
        """Feeling (B, S); `step` is to be given it as well.

        Raises:
            ImitationError: a copy begins where no demonstration went.
        """
        here = self.states.number(senses)
        lost = (self.successor[self.copy, here] < 0) & (here != self.goal)
        if lost.any():
            where = self.states.name(int(here[lost][0]))
            raise ImitationError(
                f"the imitator begins at {where}, where no demonstration went; one must pass through its start"
            )
        return Way(here, np.full(self.successor.shape, -1), np.zeros(len(here), bool))

    def step(self, state: Way, senses: FloatArray, rng: np.random.Generator) -> tuple[Way, FloatArray, Decisions]:
        """Feeling (B, S): where that is, the (B, 1) next actions, and why; those who arrived do not decide any more."""
        model, copy, came_from = self.forward_model, self.copy, state.came_from
        here = np.where(state.arrived, state.here, self.states.number(senses))
        new = (came_from[copy, here] < 0) & (here != state.here)
        if new.any():
            came_from = came_from.copy()
            came_from[copy[new], here[new]] = state.here[new]
        arrived = here == self.goal
        ahead = self.successor[copy, here]
        subgoal = np.where(arrived, here, np.where(ahead >= 0, ahead, came_from[copy, here]))
        query = *self.states.context(senses), self.states.outcome(here, subgoal)
        asked = [column.reshape(-1, len(model.factors)) for column in query]
        cells = located(len(model.factors), (*model.contexts, model.outcome), asked)
        likelihood = cells.read(self.by_outcome).reshape(len(here), -1)
        posterior, rung = descend(likelihood, self.prior[copy, here], CATEGORIES)
        action = self.rule(posterior.probability, model.action, rng).astype(np.int64)
        shown = posterior.probability, posterior.entropy, posterior.evidence
        decided = subgoal, action, *shown, rung == Rung.FORWARD_ALONE, rung == Rung.CHANCE, ahead < 0
        info = Decisions._make(np.where(arrived, no, value.T).T for value, no in zip(decided, NOTHING, strict=True))
        return Way(here, came_from, arrived), action[:, None].astype(float), info


def follow(
    body: Body,
    follower: Follower,
    *,
    rng: np.random.Generator,
    limit: int,
    ended: Callable[[FloatArray], str | None] = lambda senses: None,
) -> Journey:
    """Every copy of a body imitates, from rest, until it stands on its goal: the loop around `Follower.step`.

    Args:
        body: who imitates.
        follower: what it goes by.
        rng: randomness of ties, matching and chance.
        limit: most steps.
        ended: asked with the (B, S) senses before every step; why to stop there, or None.

    Raises:
        ImitationError: the body begins where no demonstration went, or a limit below 1.
    """
    if limit < 1:
        raise ImitationError(f"a limit of {limit} steps; at least 1 is needed")
    senses = body.reset()
    state, ways, log = follower.start(senses), list[tuple[IntArray, BoolArray]](), list[Decisions]()
    while True:
        why = ended(senses)
        state, motors, decided = follower.step(state, senses, rng)
        ways.append((state.here, state.arrived))
        log.append(decided)
        if state.arrived.all() or len(log) > limit or why is not None:
            break
        senses = body.act(motors)
    here, arrived = (np.array(column) for column in zip(*ways, strict=True))
    decisions = Decisions._make(np.array(column)[:-1] for column in zip(*log, strict=True))  # the last was not done
    return Journey(here, decisions, np.where(arrived[-1], arrived.argmax(0), len(log) - 1), arrived[-1], why)
