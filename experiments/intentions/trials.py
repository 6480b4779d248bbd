"""Tries in physics that nobody learned from: what adults show, and what becomes of what imitators then do."""

from dataclasses import dataclass

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.play import HANDS
from experiments.shared.children import Child
from experiments.shared.playing import LOOKED_AT, Tried, at_table
from imitation.acting.aiming import aims
from imitation.acting.primitives import NAMES, possible
from imitation.inference.bayes import action_posterior
from models.loading import load_body
from models.objects import TOYS
from models.objects.sight import Hands
from models.objects.states import STATES

SPECIMENS = 8_000_000
"""Specimens from here on; play has others."""


@dataclass(frozen=True)
class Trials:
    """N tries of one child with one object."""

    toy: str
    which: IntArray
    """(N,) primitives."""
    states: IntArray
    """(N,) what became of the object, by the object itself."""
    careless: BoolArray
    """(N,) whether it was aimed anywhere."""
    busy: bool
    """Whether hands were bound, under a blanket."""
    tracks: FloatArray
    """(N, L, 5, 3) m: hands, forehead, a and b at the looks, in the world's own places."""
    signal: BoolArray
    """(N, L) whether it shone or buzzed."""
    outline: FloatArray
    """(N, L, 7, 3) m: hands, forehead, elbows and shoulders."""

    def rows(self, act: int | None = None, state: int | None = None, *, never: int | None = None) -> IntArray:
        """Tries of an act, that ended in a state, or did not end in another."""
        found = np.ones(len(self.which), bool)
        found &= self.which == act if act is not None else True
        found &= self.states == state if state is not None else True
        found &= self.states != never if never is not None else True
        return np.flatnonzero(found)


def trials(
    child: Child, toy: str, shown: str, target: str, first: int, *, busy: bool = False, each: int, means: int,
    careless: int,
) -> Trials:  # fmt: skip
    """Every primitive, aimed as play taught, most often those by which the target is reached, and carelessly the one
    that is to be shown; with bound hands nothing but that one is needed.

    Args:
        child: who does it.
        toy: with what.
        shown: name of the act that adults show with it.
        target: name of the state that it is for.
        first: number of the first specimen.
        busy: whether its hands are bound.
        each: tries of every primitive.
        means: more of those that Eq. (1) would choose for the target.
        careless: of the act that is to be shown, aimed anywhere.
    """
    able, play = possible(TOYS[toy].alone), child.play
    kind, rng = play.kinds.index(TOYS[toy].kind), np.random.default_rng([first, 0x7122])
    free = HANDS.index("free")
    likely = play.outcomes.predictive[0, kind, free, able, STATES.index(target)]
    likely = action_posterior(likely, play.outcomes.habits[0, kind, free, able]).probability
    skilled = np.concatenate([np.repeat(able, each), rng.choice(able, means, p=likely)]) if not busy else able[:0]
    which = np.concatenate([skilled, np.full(careless, NAMES.index(shown))])
    return done(child, toy, which, np.arange(len(which)) >= len(skilled), first, busy=busy)[0]


def done(
    child: Child, toy: str, which: IntArray, careless: BoolArray, first: int, *, busy: bool = False, keep: bool = False
) -> tuple[Trials, Tried]:
    """(N,) acts, each with a specimen of its own, aimed as play taught, or anywhere and without a second look; and
    their physics."""
    play = child.play
    kind, rng = play.kinds.index(TOYS[toy].kind), np.random.default_rng([first, 0x7121])
    body = at_table(toy, len(which), busy=busy)
    body.set_out(SPECIMENS + first)
    skilled = aims(play, kind, which, play.practised(kind)[which], "mean", rng)
    anywhere = aims(play, kind, which, np.full(len(which), -1), "matching", rng)
    where = np.where(careless[:, None], anywhere, skilled)
    tried = child.player.tries(body, which, where, rng, keep=keep, careless=careless)
    looks = list(LOOKED_AT)
    tracks = np.concatenate([tried.true.parts, tried.true.handles], 2)[looks].swapaxes(0, 1)
    outline = outlines(child.robot, tried.angles[looks])
    states, signal = TOYS[toy].state(tried.true), tried.true.signal[looks].T
    return Trials(toy, which, states, careless, busy, tracks, signal, outline), tried


def outlines(robot: str, angles: FloatArray) -> FloatArray:
    """(N, L, 7, 3) m where hands, forehead, elbows and shoulders are at (L, N, J) joint angles."""
    body = load_body(robot)
    eyes = Hands(body, 0, outline=True)
    places = eyes.at(body.configurations(angles.reshape(-1, angles.shape[-1])))
    return np.asarray(places.reshape(*angles.shape[:2], -1, 3).swapaxes(0, 1))
