"""Play: what becomes of things when one does something with them, learned by doing it (chapter, sections 2.3 and 3.5).

    P(state' | kind, hands, primitive)        Dirichlet, in `outcomes`

"The states to be encoded are the states of the object ... the forward model would presumably be one that has been
learned from experience with similar objects". What play leaves behind besides: where one aimed when a state came
about, so that one's aim gets better; how far from comfort each primitive takes one, so that what is awkward is rarely
done; and how one's own hands and head moved, so that another's movement is recognised. All of it is whole numbers:
plays of several days, or machines, are merged by adding, exactly.
"""

from dataclasses import dataclass, replace
from typing import Annotated, Final

import numpy as np

from babbling.axes import Axis, BoolArray, FloatArray, IntArray
from babbling.body import OfOneBody
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel
from babbling.kinds import Numbers, kind

HANDS: Final = ("free", "busy")
PRIOR_STRENGTH: Final = 0.5
"""Pseudo-counts of what becomes of this kind of thing, whatever one does."""
FINE: Final = 1e-4
"""m, rad^2: what whole numbers count."""
AIMS: Final = 5
"""Forward, outwards, up [m], how far [m], how hard [0 to 1]."""
SPREAD: Final = np.array([0.022, 0.013, 0.007, 0.01, 0.25])
MIDDLE: Final = np.array([0.0, 0.0, 0.0, 0.045, 0.65])
"""Aims before anything is known: middle and standard deviation."""
LEAST: Final = 2
"""Times that a state has come about before one aims for it."""
COMFORT: Final = 1.2
"""rad: how far from rest is still comfortable (as in `imitation.correspondence.inversion`)."""
MOST: Final = 2.0**53

_ACTS = "kind primitive"


@kind("play", "make one with `imitate play`")
@dataclass(frozen=True)
class Play(OfOneBody):
    """What was learned of K kinds of things, with A primitives, O states, D numbers of a seen movement."""

    fingerprint: str
    outcomes: Annotated[ForwardModel, Numbers("factor")]
    """P(state' | kind, hands, primitive), of what was done as well as one could by then."""
    reached: Annotated[IntArray, Numbers(f"{_ACTS} state", low=0, high=MOST)]
    """(K, A, O) how often, first attempts included."""
    aimed: Annotated[IntArray, Numbers(f"{_ACTS} state aim:{AIMS}", low=-MOST, high=MOST, scale=FINE)]
    """(K, A, O, 5) sums of the aims with which a state came about."""
    aimed_squares: Annotated[IntArray, Numbers(f"{_ACTS} state aim:{AIMS}", low=0, high=MOST, scale=FINE**2)]
    moved: Annotated[IntArray, Numbers(f"{_ACTS} feature", low=-MOST, high=MOST, scale=FINE)]
    """(K, A, D) sums of where one's parts were seen, m."""
    moved_squares: Annotated[IntArray, Numbers(f"{_ACTS} feature", low=0, high=MOST, scale=FINE**2)]
    strain: Annotated[IntArray, Numbers(_ACTS, "rad2", low=0, high=MOST, scale=FINE)]
    """(K, A) sums of the farthest from rest that one's posture was, rad^2."""
    rounds: Annotated[int, Numbers(low=0)]
    """Rounds played."""
    minutes: Annotated[float, Numbers(unit="min", low=0, high=1e6)]
    """Body time."""

    @classmethod
    def empty(
        cls,
        fingerprint: str,
        kinds: tuple[str, ...],
        primitives: tuple[str, ...],
        states: tuple[str, ...],
        features: int,
    ) -> "Play":
        """Before anything is done."""
        outcomes = ForwardModel(
            (Axis.categorical("kind", kinds), Axis.categorical("hands", HANDS)),
            Axis.categorical("primitive", primitives),
            Axis.categorical("state", states),
            prior_strength=PRIOR_STRENGTH,
            fingerprint=fingerprint,
        )
        acts = (len(kinds), len(primitives))
        aims = np.zeros((*acts, len(states), AIMS), np.int64)
        moved, none = np.zeros((*acts, features), np.int64), np.zeros(acts, np.int64)
        return cls(fingerprint, outcomes, aims[..., 0].copy(), aims, aims.copy(), moved, moved.copy(), none, 0, 0.0)

    @property
    def kinds(self) -> tuple[str, ...]:
        """K names."""
        return self.outcomes.contexts[0].labels

    @property
    def tried(self) -> IntArray:
        """(K, A) how often each primitive was done with each kind."""
        return np.asarray(self.reached.sum(-1))

    def after(
        self,
        kind: int,
        hands: int,
        which: IntArray,
        states: IntArray,
        aims: FloatArray,
        features: FloatArray,
        strain: FloatArray,
        skilled: BoolArray,
        minutes: float,
    ) -> "Play":
        """After N tries with one kind of thing.

        Args:
            kind, hands: which, and whether hands were free.
            which, states: (N,) primitives and what became of it, as it was seen.
            aims: (N, 5). features: (N, D) where parts were seen. strain: (N,) rad^2.
            skilled: (N,) whether it was done as well as one can by now.
            minutes: body time.
        """
        new = self.nothing()
        at = (np.full(len(which), kind), which)
        whole = np.rint(np.asarray(aims) / FINE).astype(np.int64)
        seen = np.rint(features / FINE).astype(np.int64)
        np.add.at(new.reached, (*at, states), 1)
        np.add.at(new.aimed, (*at, states), whole)
        np.add.at(new.aimed_squares, (*at, states), whole**2)
        np.add.at(new.moved, at, seen)
        np.add.at(new.moved_squares, at, seen**2)
        np.add.at(new.strain, at, np.rint(strain / FINE).astype(np.int64))
        row = [np.full((int(skilled.sum()), 1), value) for value in (kind, hands)]
        new.outcomes.observe(row, which[skilled, None], states[skilled, None])
        return self.merged(replace(new, minutes=minutes))

    def nothing(self) -> "Play":
        """The same kinds of things, never played with."""
        acts, states = self.outcomes.action.labels, self.outcomes.outcome.labels
        return Play.empty(self.fingerprint, self.kinds, acts, states, self.moved.shape[-1])

    def merged(self, other: "Play") -> "Play":
        """Both together: exactly as if one had played it all.

        Raises:
            BabblingError: somebody else's play, or play with other kinds of things.
        """
        if self.fingerprint != other.fingerprint:
            raise BabblingError(
                f"plays of two bodies (fingerprints {self.fingerprint} and {other.fingerprint}) cannot be merged"
            )
        outcomes = self.nothing().outcomes
        for one in (self.outcomes, other.outcomes):
            outcomes.merge(one)
        if self.moved.shape != other.moved.shape:
            raise BabblingError("plays whose movements were seen at other moments cannot be merged")
        summed = ("reached", "aimed", "aimed_squares", "moved", "moved_squares", "strain", "rounds", "minutes")
        return replace(self, outcomes=outcomes, **{name: getattr(self, name) + getattr(other, name) for name in summed})

    # ------------------------------------------------------------------ skill

    def practised(self, kind: int) -> IntArray:
        """(A,) the state each primitive is practised for with this kind: of those that came about at least `LEAST`
        times the one that is the greatest surprise, -log P(state | kind); -1 for none."""
        count = self.reached[kind]
        share = (count.sum(0) + 1) / (count.sum() + count.shape[-1])
        surprise = np.where(count >= LEAST, -np.log(share), -np.inf)
        return np.where(np.isfinite(surprise).any(-1), surprise.argmax(-1), -1)

    def aim(self, kind: int, which: IntArray, states: IntArray) -> tuple[FloatArray, FloatArray]:
        """(N, 5) means and standard deviations of P(aim | kind, primitive, state came about): Gaussian, one imagined
        success at `MIDDLE`, `SPREAD`; of the imagined one alone where a state (or -1) never came about."""
        known = (states >= 0)[:, None]
        count = self.reached[kind, which, states][:, None] * known
        total = self.aimed[kind, which, states] * FINE * known
        squares = self.aimed_squares[kind, which, states] * FINE**2 * known
        mean = (total + MIDDLE) / (count + 1)
        variance = (squares + MIDDLE**2 + SPREAD**2) / (count + 1) - mean**2
        return mean, np.sqrt(np.maximum(variance, 1e-8))

    def comfort(self, kind: int) -> FloatArray:
        """(A,) how gladly each primitive is done with this kind: exp(-strain / 2 COMFORT^2), normalised; alike where
        one has not yet been tried."""
        tried = self.tried[kind]
        if not tried.all():
            return np.full(len(tried), 1 / len(tried))
        glad = np.exp(-self.strain[kind] * FINE / tried / (2 * COMFORT**2))
        return np.asarray(glad / glad.sum())
