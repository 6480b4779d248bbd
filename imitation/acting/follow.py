"""From sub-goal to sub-goal: imitation in discrete states by Eq. (1) (chapter, section 3.3.2).

At each step: the sub-goal of the state one is in, or, pushed off the demonstrated way, the state one came from
("backtracking over a previous step"); the forward model read backwards at that outcome; the learned prior; Eq. (1);
one action by a selection rule. Where Eq. (1) is 0/0 the ladder of fallbacks is, each rung counted: the forward model
alone (uniform prior), then chance.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babbling.axes import FloatArray, IntArray
from babbling.body import Body
from babbling.forward_model import ForwardModel
from babbling.moves import Places, RelativeMoves, relative_move
from imitation.errors import ImitationError
from imitation.inference.ladder import CATEGORIES, Rung, descend
from imitation.inference.selection import Rule, selection_rule


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
    forward_alone: NDArray[np.bool_]
    """Eq. (1) was 0/0 and the forward model alone decided."""
    chance: NDArray[np.bool_]
    """The forward model was 0/0 as well and chance decided."""
    backtracking: NDArray[np.bool_]
    """The sub-goal was the state one came from."""


@dataclass(frozen=True, eq=False)
class Journey:
    """How imitations went, B copies at once; T is the step of the last arrival, or the limit."""

    states: IntArray
    """(T + 1, B) state before the first step and after each; the goal from arrival on."""
    decisions: Decisions
    """(T, B, ...)."""
    steps: IntArray
    """(B,) steps to the goal, or the limit where it was not reached."""
    reached: NDArray[np.bool_]
    """(B,) whether the goal was reached within the limit."""


def believed_likelihood(forward_model: ForwardModel, outcome: IntArray) -> FloatArray:
    """(..., F, A) P(outcome | a) for every action; an action nobody tried says nothing: uniform over outcomes."""
    untried = forward_model.familiarity(()) == 0
    return np.where(untried, 1.0 / forward_model.outcome.size, forward_model.likelihood((), outcome))


def follow(
    body: Body,
    forward_model: ForwardModel,
    successor: IntArray,
    goal: ArrayLike,
    prior: FloatArray | None = None,
    *,
    selection: str = "map",
    rng: np.random.Generator,
    limit: int,
) -> Journey:
    """Every copy of the body imitates until it stands on its goal.

    Args:
        body: who imitates; from rest.
        forward_model: relative moves; one factor for all copies, or one per copy.
        successor: (S,) or (B, S) sub-goal of each state, -1 where there is none (`SubGoals.successor`).
        goal: (B,) or one state to end in.
        prior: (S, A) or (B, S, A) P(a | s, g) for the goal; None is uniform everywhere.
        selection: name of a selection rule.
        rng: randomness of ties, matching and chance.
        limit: most steps.

    Raises:
        ImitationError: the body begins where no demonstration went, or a limit below 1.
    """
    if limit < 1:
        raise ImitationError(f"a limit of {limit} steps; at least 1 is needed")
    rule, copy = selection_rule(selection), np.arange(body.copies)
    places, sense = Places.of(body), RelativeMoves().place
    successor = np.broadcast_to(successor, (body.copies, places.size))
    goals = np.broadcast_to(np.asarray(goal), body.copies)
    actions = forward_model.action.size
    priors = np.broadcast_to(1.0 / actions if prior is None else prior, (body.copies, places.size, actions))
    here = places.number(body.reset()[:, sense])
    _check_start(places, here, successor[copy, here], goals)
    came_from = np.full((body.copies, places.size), -1)  # the way each state was first entered: it cannot form a circle
    steps = np.where(here == goals, 0, -1)
    states, log = [here], list[Decisions]()
    while (steps < 0).any() and len(log) < limit:
        active = steps < 0
        ahead = successor[copy, here]
        subgoal = np.where(active, np.where(ahead >= 0, ahead, came_from[copy, here]), here)
        outcome = relative_move(places.place(here), places.place(subgoal))
        decided = _decide(forward_model, outcome, priors[copy, here], rule, rng)
        senses = body.act(decided.action[:, None].astype(float))
        log.append(_while_active(decided._replace(subgoal=subgoal, backtracking=ahead < 0), active))
        there = np.where(active, places.number(senses[:, sense]), here)
        new = (came_from[copy, there] < 0) & (there != here)
        came_from[copy[new], there[new]] = here[new]
        here = there
        states.append(here)
        steps[active & (here == goals)] = len(log)
    if not log:  # everybody begins on the goal: nothing to decide
        outcome = np.zeros(body.copies, np.int64)
        empty = _decide(forward_model, outcome, priors[copy, here], rule, rng)
        decisions = Decisions._make(column[None][:0] for column in empty)
    else:
        decisions = Decisions._make(np.array(column) for column in zip(*log, strict=True))
    return Journey(np.array(states), decisions, np.where(steps < 0, len(log), steps), steps >= 0)


def _decide(
    forward_model: ForwardModel, outcome: IntArray, prior: FloatArray, rule: Rule, rng: np.random.Generator
) -> Decisions:
    """Eq. (1) and its ladder for (B,) wanted outcomes under (B, A) priors."""
    factors, size = len(forward_model.factors), forward_model.action.size
    likelihood = believed_likelihood(forward_model, outcome.reshape(-1, factors)).reshape(len(outcome), size)
    posterior, rung = descend(likelihood, prior, CATEGORIES)
    action = rule(posterior.probability, forward_model.action, rng).astype(np.int64)
    alone, chance = rung == Rung.FORWARD_ALONE, rung == Rung.CHANCE
    return Decisions(
        outcome, action, posterior.probability, posterior.entropy, posterior.evidence, alone, chance, chance
    )


def _while_active(decided: Decisions, active: NDArray[np.bool_]) -> Decisions:
    """Blank out the copies that have arrived."""
    return decided._replace(
        subgoal=np.where(active, decided.subgoal, -1),
        action=np.where(active, decided.action, -1),
        posterior=decided.posterior * active[:, None],
        entropy=decided.entropy * active,
        evidence=decided.evidence * active,
        forward_alone=decided.forward_alone & active,
        chance=decided.chance & active,
        backtracking=decided.backtracking & active,
    )


def _check_start(places: Places, here: IntArray, ahead: IntArray, goals: IntArray) -> None:
    lost = (ahead < 0) & (here != goals)
    if lost.any():
        x, y = places.place(here[lost][0])
        raise ImitationError(
            f"the imitator begins at ({x}, {y}), where no demonstration went; one must pass through its start"
        )
