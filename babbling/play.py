"""Play: what becomes of things when one does something with them, learned by doing it (chapter, sections 2.3 and 3.5).

    P(state' | kind, hands, primitive)        Dirichlet, in `outcomes`

"The states to be encoded are the states of the object ... the forward model would presumably be one that has been
learned from experience with similar objects". What play leaves behind besides: where one aimed when a state came
about, so that one's aim gets better; how far from comfort each primitive takes one, so that what is awkward is rarely
done; and how one's own hands and head moved, so that another's movement is recognised. All of it is whole numbers:
plays of several days, or machines, are merged by adding, exactly.

Many children play side by side. How to aim, and how a movement looks, they have in common; what each of them brought
about itself is kept too (`each`), so that one play is also a population of children with an experience of their own.
"""

from dataclasses import dataclass, replace
from typing import Annotated, Final

import numpy as np

from babbling.axes import Axis, FloatArray, IntArray
from babbling.body import OfOneBody
from babbling.body_image import COMFORT
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel
from babbling.kinds import Numbers, kind

HANDS: Final = ("free", "busy")
PRIOR_STRENGTH: Final = 0.5
"""Pseudo-counts of what becomes of this kind of thing, whatever one does."""
AIMS: Final = ("forward", "outwards", "up", "how far", "how hard")
MIDDLE: Final = np.array([0.0, 0.0, 0.0, 0.045, 0.65])
SPREAD: Final = np.array([0.033, 0.02, 0.0105, 0.015, 0.35])
"""Aims that are tried: their middle, and how far from it they go; m, but for how hard (0 to 1)."""
AIM_POINTS: Final = 9
AIM_STRENGTH: Final = 4.0
"""Pseudo-counts of what a primitive brings about, wherever one aims: few tries say little of where to aim."""
EAGER: Final = 8.0
"""Exponent of P(state | aim) where one draws an aim."""
FINE: Final = 1e-4
"""m, rad^2: what whole numbers count."""
LEAST: Final = 2
"""Times that a state has come about before one aims for it."""
CURIOUS: Final = 3.0
"""How many times more often what sometimes succeeds is done than what always or never does (at P = 1/2)."""
MOST: Final = 2.0**53
_ACTS = "kind primitive"


@kind("play", "make one with `imitate play`")
@dataclass(frozen=True)
class Play(OfOneBody):
    """What was learned of K kinds of things, with A primitives, O states, D numbers of a seen movement."""

    fingerprint: str
    outcomes: Annotated[ForwardModel, Numbers("table")]
    """P(state' | kind, hands, primitive)."""
    each: Annotated[IntArray, Numbers("child kind hands primitive state", low=0, high=MOST)]
    """(C, K, H, A, O) the same, counted for each child."""
    aims: Annotated[ForwardModel, Numbers("aimed")]
    """P(state' | kind, primitive, aim), one factor for each of `AIMS`, as shares of `SPREAD` from `MIDDLE`."""
    moved: Annotated[IntArray, Numbers(f"{_ACTS} feature", low=-MOST, high=MOST, scale=FINE)]
    """(K, A, D) sums of where one's parts were seen, m."""
    moved_products: Annotated[
        IntArray, Numbers("feature feature", low=-MOST, high=MOST, covariance=True, scale=FINE**2)
    ]
    """(D, D) sums of their products, over all kinds and primitives."""
    strain: Annotated[IntArray, Numbers(_ACTS, "rad2", low=0, high=MOST, scale=FINE)]
    """(K, A) sums of the farthest from rest that one's posture was, rad^2."""
    rounds: Annotated[int, Numbers(low=0)]
    """Rounds played."""
    milliseconds: Annotated[int, Numbers(unit="ms", low=0, high=MOST)]
    """Body time."""

    @classmethod
    def empty(
        cls,
        fingerprint: str,
        kinds: tuple[str, ...],
        primitives: tuple[str, ...],
        states: tuple[str, ...],
        features: int,
        children: int = 1,
    ) -> "Play":
        """Before anything is done."""
        outcomes = ForwardModel(
            (Axis.categorical("kind", kinds), Axis.categorical("hands", HANDS)),
            Axis.categorical("primitive", primitives),
            Axis.categorical("state", states),
            prior_strength=PRIOR_STRENGTH,
            fingerprint=fingerprint,
        )
        count, ends = len(AIMS), np.ones(len(AIMS))
        aims = ForwardModel(
            (Axis.categorical("kind", kinds, count), Axis.categorical("primitive", primitives, count)),
            Axis("aim", "1", -ends, ends, AIM_POINTS),
            Axis.categorical("state", states, count),
            factors=AIMS,
            prior_strength=AIM_STRENGTH,
            fingerprint=fingerprint,
        )
        acts = (len(kinds), len(primitives))
        moved, products = np.zeros((*acts, features), np.int64), np.zeros((features, features), np.int64)
        each = np.zeros((children, *outcomes.counts.shape[1:]), np.int64)
        return cls(fingerprint, outcomes, each, aims, moved, products, np.zeros(acts, np.int64), 0, 0)

    @property
    def kinds(self) -> tuple[str, ...]:
        """K names."""
        return self.outcomes.contexts[0].labels

    @property
    def minutes(self) -> float:
        """Body time."""
        return self.milliseconds / 60_000

    def alone(self, child: int) -> "Play":
        """What one of the children knows: what became of things when it did something itself, with the skill of all."""
        own = self.nothing()
        own.outcomes.add(self.each[None, child])
        return replace(self, outcomes=own.outcomes, each=self.each[child : child + 1])

    @property
    def reached(self) -> IntArray:
        """(K, A, O) how often each primitive ended so with each kind, hands free."""
        return np.asarray(self.outcomes.counts[0][:, HANDS.index("free")])

    @property
    def tried(self) -> IntArray:
        """(K, A) how often each primitive was done with each kind, hands free."""
        return np.asarray(self.reached.sum(-1))

    @property
    def liked(self) -> FloatArray:
        """(K, H, A, O) how often each primitive was done again, and ended so: the first try of each child is curiosity,
        what it goes on with is liking (of n tries that ended so and so, (n - 1) / n each)."""
        count = self.each.sum(-1, keepdims=True)
        return np.asarray((self.each * (1 - 1 / np.maximum(count, 1))).sum(0))

    @property
    def liking(self) -> FloatArray:
        """(K, H, A) P(primitive | kind, hands) of one who is after nothing = (done again + k q) / (their number + k),
        q = (done + 1 / A) / (their number + 1), k = `PRIOR_STRENGTH`. (The habit in Eq. (1) is all that was done.)"""
        return usually(self.liked.sum(-1), self.outcomes.visits[0])

    @property
    def ends(self) -> FloatArray:
        """(K, H, O) P(state), by the same law: how one's acts end when one does what one likes."""
        return usually(self.liked.sum(-2), self.outcomes.counts[0].sum(-2))

    def after(
        self,
        kind: int,
        hands: int,
        which: IntArray,
        states: IntArray,
        aims: FloatArray,
        features: FloatArray,
        strain: FloatArray,
        who: IntArray,
        minutes: float,
    ) -> "Play":
        """After N tries with one kind of thing; with hands bound, only what became of it is kept.

        Args:
            kind, hands: which, and whether hands were free.
            which, states: (N,) primitives and what became of it, as it was seen.
            aims: (N, 5). features: (N, D) where parts were seen. strain: (N,) rad^2.
            who: (N,) children that tried.
            minutes: body time.
        """
        new = self.nothing()
        np.add.at(new.each[:, kind, hands], (who, which, states), 1)
        new.outcomes.observe(
            [np.full((len(which), 1), value) for value in (kind, hands)], which[:, None], states[:, None]
        )
        if hands == HANDS.index("busy"):
            return self.merged(replace(new, milliseconds=round(60_000 * minutes)))
        at = (np.full(len(which), kind), which)
        seen = np.rint(features / FINE).astype(np.int64)
        np.add.at(new.moved, at, seen)
        new.moved_products[:] = seen.T @ seen
        np.add.at(new.strain, at, np.rint(strain / FINE).astype(np.int64))
        shares = np.clip((aims - MIDDLE) / SPREAD, -1, 1)
        rows = [np.broadcast_to(np.asarray(value)[:, None], shares.shape) for value in (*at, states)]
        new.aims.observe(rows[:2], shares, rows[2])
        return self.merged(replace(new, milliseconds=round(60_000 * minutes)))

    def nothing(self) -> "Play":
        """The same kinds of things, never played with."""
        acts, states = self.outcomes.action.labels, self.outcomes.outcome.labels
        return Play.empty(self.fingerprint, self.kinds, acts, states, self.moved.shape[-1], len(self.each))

    def merged(self, other: "Play") -> "Play":
        """Both together: exactly as if the same children had played it all.

        Raises:
            BabblingError: somebody else's play, of another number of children, or with other kinds of things.
        """
        if self.fingerprint != other.fingerprint:
            raise BabblingError(
                f"plays of two bodies (fingerprints {self.fingerprint} and {other.fingerprint}) cannot be merged"
            )
        if self.moved.shape[-1] != other.moved.shape[-1]:
            raise BabblingError("plays whose movements were seen at other moments cannot be merged")
        if len(self.each) != len(other.each):
            raise BabblingError(
                f"plays of {len(self.each)} and of {len(other.each)} children cannot be merged: who is who?"
            )
        both = self.nothing()
        for one in (self, other):
            both.outcomes.merge(one.outcomes)
            both.aims.merge(one.aims)
        summed = ("each", "moved", "moved_products", "strain", "rounds", "milliseconds")
        return replace(both, **{name: getattr(self, name) + getattr(other, name) for name in summed})

    def practised(self, kind: int) -> IntArray:
        """(A,) the state each primitive is practised for with this kind: of those that came about at least `LEAST`
        times the one that is the greatest surprise, -log P(state | kind); -1 for none."""
        count = self.reached[kind]
        share = (count.sum(0) + 1) / (count.sum() + count.shape[-1])
        surprise = np.where(count >= LEAST, -np.log(share), -np.inf)
        return np.where(np.isfinite(surprise).any(-1), surprise.argmax(-1), -1)

    def aimed(self, kind: int, which: IntArray, states: IntArray) -> FloatArray:
        """(N, 5, `AIM_POINTS`) P(state | kind, primitive, aim) at every aim, for the inverse; 1 everywhere for a state
        of -1: nothing is aimed for."""
        rows = [
            np.broadcast_to(value[:, None], (len(which), len(AIMS))) for value in (np.full(len(which), kind), which)
        ]
        goal = np.broadcast_to(np.maximum(states, 0)[:, None], rows[0].shape)
        likely = self.aims.likelihood(rows, goal)
        return np.where((states < 0)[:, None, None], 1.0, likely)

    def comfort(self, kind: int) -> FloatArray:
        """(A,) how gladly each primitive is done with this kind, exp(-strain / 2 COMFORT^2), normalised; alike before
        any is tried, and later 0 for one that was not."""
        tried = self.tried[kind]
        if not tried.any():
            return np.full(len(tried), 1 / len(tried))
        glad = np.where(tried > 0, np.exp(-self.strain[kind] * FINE / np.maximum(tried, 1) / (2 * COMFORT**2)), 0)
        return np.asarray(glad / glad.sum())

    def appeal(self, kind: int) -> FloatArray:
        """(A,) how readily each primitive is done in play: comfort (1 + CURIOUS 4 P (1 - P)), normalised, P = P(what it
        is practised for | kind, primitive). What sometimes succeeds is what there is to learn."""
        states = self.practised(kind)
        chance = self.outcomes.predictive[0, kind, HANDS.index("free"), np.arange(len(states)), states]
        appeal = self.comfort(kind) * (1 + CURIOUS * np.where(states < 0, 0, 4 * chance * (1 - chance)))
        return np.asarray(appeal / appeal.sum())


def usually(liked: FloatArray, done: IntArray) -> FloatArray:
    """(..., N) shares of what was done again, of which what was ever done is the prior (see `Play.liking`)."""
    prior = (done + 1 / done.shape[-1]) / (done.sum(-1, keepdims=True) + 1)
    return np.asarray((liked + PRIOR_STRENGTH * prior) / (liked.sum(-1, keepdims=True) + PRIOR_STRENGTH))
