"""One imitator: what it knows by its own play, what it believes the other meant, and what it then does."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.forward_model import ForwardModel
from babbling.play import HANDS, Play
from imitation.inference.bayes import action_posterior
from imitation.inference.meaning import GIVES_UP, GOES_ON, REPEATS, Knowing, Meant, Presentation, meant, wanted
from models.objects.states import EITHER, SAME, STATES

GOALS = (*STATES, *EITHER)
"""G: to bring a state about, or any of several."""
MEMBERS: BoolArray = np.array(
    [np.arange(len(STATES)) == n for n in range(len(STATES))]
    + [np.isin(np.arange(len(STATES)), some) for some in EITHER.values()]
)
"""(G, O)."""


@dataclass(frozen=True)
class How:
    """What of an imitator is not learned; every field has a row of its own in the table of sensitivity."""

    acts: int = 3
    """How many there is time for."""
    shown: int = 3
    """How often it is shown."""
    gives_up: float = GIVES_UP
    """P(somebody stops | the goal is not reached)."""
    goes_on: float = GOES_ON
    """P(somebody does it again at once | the goal is reached)."""
    repeats: float = REPEATS
    """P(a thing does what it did before)."""
    all_somebody: bool = False
    """Whether whatever moves is taken for somebody."""
    own_weight: float = 0.1
    """How much one's own play weighs in what one wants, against one effect that was just seen."""
    selection: str = "matching"
    """How goals and actions are drawn from their posteriors: matching or map."""
    as_itself: bool = False
    """Whether it takes the other to have its own hands, not an adult's."""
    prior_strength: float | None = None
    """Pseudo-counts of what becomes of a kind of thing whatever one does; None: as in play."""
    even_goals: bool = False
    """Whether all goals that ever came about are wanted alike."""
    trust: float = 1.0
    """In habit, P(a | s), as its exponent."""
    exponent: float = 1.0
    """Matching draws in proportion to posterior^exponent: 1 is probability matching, 0 chance."""


class Belief(NamedTuple):
    """What it is after, once it has seen what was shown."""

    goal: FloatArray
    """(G,) P(g | somebody pursues one)."""
    somebody: float
    """P(somebody pursues a goal)."""
    effects: IntArray
    """(O,) how often each state was seen to come about."""


class Did(NamedTuple):
    """What it did, act by act, what came of it, and what it was after."""

    primitives: IntArray
    states: IntArray
    goals: IntArray


def sharpened(weights: FloatArray, exponent: float) -> FloatArray:
    """(..., N) weights^exponent, of sum 1; what has no weight gets none."""
    powered = weights
    if exponent != 1:
        powered = np.where(weights > 0, weights / weights.max(-1, keepdims=True), 0.0)
        powered = np.where(powered > 0, np.where(powered > 0, powered, 1.0) ** exponent, 0.0)
    return np.asarray(powered / powered.sum(-1, keepdims=True))


class Agent:
    """A child with a play of its own.

    Args:
        play: what this child knows (`Play.alone`).
        how: what is not learned.
    """

    def __init__(self, play: Play, how: How) -> None:
        model = play.outcomes
        if how.prior_strength is not None:
            model = ForwardModel(model.contexts, model.action, model.outcome, prior_strength=how.prior_strength)
            model.add(play.outcomes.counts)
        self.play, self.how, self._model = replace(play, outcomes=model), how, model

    def knowing(self, kind: int, hands: int = HANDS.index("free")) -> Knowing:
        """What it knows of a kind of thing with its hands free, or bound."""
        habit = self._model.habits[0, kind, hands]
        habit = habit if self.how.trust == 1 else sharpened(habit, self.how.trust)
        return Knowing(self._model.predictive[0, kind, hands], habit, MEMBERS)

    def wants(self, kind: int) -> FloatArray:
        """(G,) P(g) of its own play."""
        free = HANDS.index("free")
        came = self._model.counts[0, kind, free].sum(0) > 0
        prior = wanted(self.play.ends[kind, free], came, MEMBERS)
        if self.how.even_goals and came.any():  # who never brought anything about wants what it wants
            prior = np.where(MEMBERS @ came > 0, prior > 0, 0.0)
        return np.asarray(prior / prior.sum())

    def believes(
        self,
        seen: Sequence[Presentation],
        kind: int,
        other: int,
        hands: int,
        somebody: float,
        wants: FloatArray | None = None,
    ) -> tuple[Belief, Meant]:
        """Eq. (2) over what was shown.

        Args:
            seen: what was shown.
            kind: of thing that it is for oneself.
            other: the kind that it is for the other, with the other's hands.
            hands: of the other, free or bound.
            somebody: P(somebody), by the looks.
            wants: (G,) P(g); None is that of its own play.
        """
        prior = self.wants(kind) if wants is None else wants
        theirs = self.knowing(kind if self.how.as_itself else other, hands)
        how, before = self.how, 1.0 if self.how.all_somebody else somebody
        found = meant(seen, theirs, prior, before, gives_up=how.gives_up, goes_on=how.goes_on, repeats=how.repeats)
        effects = np.bincount([one.state for one in seen if one.state not in (None, SAME)], minlength=len(STATES))
        return Belief(found.goal[-1], min(float(found.somebody[-1]), 1.0), effects), found

    def responds(
        self,
        belief: Belief,
        kind: int,
        world: Callable[[int, int], int],
        rng: np.random.Generator,
        wants: FloatArray | None = None,
    ) -> Did:
        """Acts while there is time: the goal that somebody seems to have, or else one of its own; by Eq. (1), and what
        it sees come of its own acts counts at once. An effect that it saw and has brought about tempts it no more.

        Args:
            belief: of what was shown.
            kind: of thing before it.
            world: of a primitive and a goal, the state that comes about.
            rng: of choices.
            wants: see `believes`.
        """
        prior = self.wants(kind) if wants is None else wants
        single = MEMBERS.sum(1) == 1  # to bring either of two about is what another may want; oneself has one in mind
        known, own, tempting = self.knowing(kind), np.where(single, prior, 0), np.zeros(len(GOALS))
        own = self.how.own_weight * (own if own.sum() > 0 else prior)
        tempting[: len(STATES)] = belief.effects
        adopts = self._drawn(np.array([belief.somebody, 1 - belief.somebody]), rng) == 0
        goal = self._drawn(belief.goal if adopts else own + tempting, rng)
        strength, tried = self._model.prior_strength, self._model.visits[0, kind, HANDS.index("free")].copy()
        outcomes, done = known.outcomes.copy(), list[tuple[int, int, int]]()
        while len(done) < self.how.acts:
            posterior = action_posterior(outcomes @ MEMBERS[goal], known.habit)
            act = self._drawn(posterior.probability if posterior.informed else known.habit, rng)
            state = world(act, goal)
            done.append((act, state, goal))
            total = tried[act] + strength
            outcomes[act] = (outcomes[act] * total + (np.arange(len(STATES)) == state)) / (total + 1)
            tried[act] += 1
            if MEMBERS[goal, state]:
                tempting[state] = 0
                goal = self._drawn(own + tempting, rng)
        return Did(*np.array(done, int).T)

    def mimics(self, movement: FloatArray, world: Callable[[int, int], int], rng: np.random.Generator) -> Did:
        """The peer without goals: does the movement that it saw."""
        done = []
        for _ in range(self.how.acts):
            act = self._drawn(movement, rng)
            done.append((act, world(act, SAME), SAME))
        return Did(*np.array(done, int).T)

    def _drawn(self, weights: FloatArray, rng: np.random.Generator) -> int:
        if self.how.selection == "map":
            return int(rng.choice(np.flatnonzero(weights == weights.max())))
        return int(rng.choice(len(weights), p=sharpened(weights, self.how.exponent)))

    @cached_property
    def nothing_seen(self) -> Belief:
        """Of those who were shown nothing: nobody has a goal."""
        return Belief(np.full(len(GOALS), 1 / len(GOALS)), 0.0, np.zeros(len(STATES), int))


def emulation(seen: Sequence[Presentation]) -> Belief | None:
    """The peer that only wants the end it saw last; None where it saw nothing come about."""
    ends = [one.state for one in seen if one.state not in (None, SAME)]
    if not ends:
        return None
    return Belief((np.arange(len(GOALS)) == ends[-1]).astype(float), 1.0, np.zeros(len(STATES), int))
