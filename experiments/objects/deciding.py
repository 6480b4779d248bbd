"""What is remembered of an act, and what one then does: Eq. (1) on the tables of one's own play."""

from dataclasses import dataclass

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.play import HANDS, Play
from experiments.objects.showing import Seen
from experiments.shared.children import Child
from experiments.shared.playing import Tried, at_table
from imitation.acting.aiming import aims
from imitation.deferred import ActMemory
from imitation.inference.bayes import Posterior
from imitation.inference.inverse import BayesianInverse, Term
from imitation.seeing.acts import likelihood
from models.objects import TOYS
from models.objects.states import SAME, Watched

IMITATORS = 3_000_000
"""Specimens from here on are those that imitators are given."""
UNSEEN = -1
"""A goal of those who saw nothing: they do what they like."""


def remembered(play: Play, toy: str, seen: Seen, kind: str | None = None) -> list[ActMemory]:
    """Each act of N as states of the object, and as what oneself does so: with a thing of its own kind, or of another,
    which it is for the one who is watched."""
    thing = TOYS[toy]
    watched = Watched(
        seen.tracks[:, :, 3:].swapaxes(0, 1), seen.tracks[:, :, :3].swapaxes(0, 1), seen.signal.swapaxes(0, 1)
    )
    ends = thing.state(watched)
    likely = likelihood(play, play.kinds.index(kind or thing.kind), seen.tracks, seen.noise)
    movement = likely / likely.sum(1, keepdims=True)
    return [
        ActMemory(play.fingerprint, thing.kind, np.array([SAME, end]), one)
        for end, one in zip(ends.tolist(), movement, strict=True)
    ]


@dataclass(frozen=True)
class Response:
    """What N of them did, act by act; -1 after they had done."""

    goals: IntArray
    """(N,) state they were after, `UNSEEN` for none."""
    primitives: IntArray
    """(N, acts)."""
    states: IntArray
    """(N, acts) what became of the object, by the object itself."""
    posteriors: FloatArray
    """(N, A) P(a | s, s', g) of the first act."""
    tried: list[Tried]
    """The physics of every act, of those who still acted."""

    def ever(self, state: int) -> BoolArray:
        """(N,) whether this state came about."""
        return np.asarray((self.states == state).any(1))


def decide(play: Play, kind: int, hands: int, goals: IntArray, selection: str) -> tuple[Posterior, BayesianInverse]:
    """Eq. (1) for N goals: P(a | s, s' = goal) from the play's tables, habit as the prior; without a goal one does what
    one likes."""
    inverse = BayesianInverse(play.outcomes, selection)
    where = np.full((len(goals), 1), kind), np.full((len(goals), 1), hands)
    term = Term(play.outcomes, where, np.maximum(goals, 0)[:, None])
    choice = inverse.choose([term], np.random.default_rng(0))
    assert choice.posterior is not None
    probability = choice.posterior.probability[:, 0]
    probability = np.where((goals == UNSEEN)[:, None], play.liking[kind, hands], probability)
    return Posterior(probability, choice.posterior.evidence[:, 0], choice.posterior.informed[:, 0]), inverse


def respond(
    child: Child, toy: str, goals: IntArray, acts: int, selection: str, rng: np.random.Generator, *, first: int = 0,
    keep: bool = False, otherwise: FloatArray | None = None, further: float = 0.0,
) -> Response:  # fmt: skip
    """N imitators with the same play act, each on one specimen, until their goal is reached or time is up.

    Args:
        child: whose mind and play they have.
        toy: what is before them.
        goals: (N,) states they are after, or `UNSEEN`.
        acts: how many there is time for.
        selection: map or matching.
        rng: of choices and sight.
        first: number of the first specimen.
        keep: see `Player.tries`.
        further: see `PlayBody`.
        otherwise: (N, A) what a peer draws from, instead of Eq. (1).
    """
    play, count = child.play, len(goals)
    kind = play.kinds.index(TOYS[toy].kind)
    posterior, inverse = decide(play, kind, HANDS.index("free"), goals, selection)
    weights = posterior.probability if otherwise is None else otherwise
    primitives, states = np.full((count, acts), -1), np.full((count, acts), -1)
    going, tries = np.arange(count), list[Tried]()
    player = child.player
    for act in range(acts):
        if not len(going):
            break
        chosen = inverse.rule(weights[going, None], play.outcomes.action, rng)[:, 0].astype(int)
        aim = np.where(goals[going] == UNSEEN, play.practised(kind)[chosen], goals[going])
        body = at_table(toy, len(going), further=further)
        body.set_out((IMITATORS + first + going).tolist())
        tried = player.tries(body, chosen, aims(play, kind, chosen, aim, "mean", rng), rng, keep=keep)
        came = TOYS[toy].state(tried.true)
        primitives[going, act], states[going, act] = chosen, came
        tries.append(tried)
        going = going[came != goals[going]]
    return Response(goals, primitives, states, weights, tries)
