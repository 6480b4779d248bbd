"""Rival theories of newborns who are shown a face: what a blind judge counts if imitation, or only arousal, is at work.

While model m is shown, infant i acts at a rate of its own, and each of its acts is with probability w_i an imitation of
the gesture shown, else a habit. How often either looks like label l was measured on its body, and acts are drawn from
there with replacement, so that a thinned Poisson process gives the very counts:

    n_iml ~ Poisson(T r_m a_i s_im (w_i P(l | i imitates m) + (1 - w_i) P(l | habit of i)))
    a_i ~ Gamma, mean 1        s_im ~ lognormal, mean 1        w_i ~ Beta(k w, k (1 - w))

A model that no organ of this body makes, a face at rest and a thing leave nothing to imitate: then all of it is habit.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from babbling.axes import FloatArray, IntArray, fixed
from experiments.errors import ExperimentError

GESTURES: Final = ("tongue out", "tongue to the side", "mouth open", "lips pursed", "brows", "head turn")
"""What is shown, and what a judge may say, by number; one more label is "nothing", which no judge counts."""
SAID: Final = (*GESTURES, "nothing")
"""What each label says, in words."""
LABELS: Final = len(SAID)
HABIT: Final = len(GESTURES)
"""Row of `Infants.looks` beyond those of the gestures shown."""
PASSIVE: Final = "passive face"
STRANGE: Final = ("finger", "hand", "voice")
OBJECTS: Final = ("tube", "box")


@dataclass(frozen=True, eq=False)
class Infants:
    """I infants that babbled apart, as a blind judge sees them."""

    habit: IntArray
    """(I, H) labels of its spontaneous acts, 0 .. 5 as in `GESTURES`, 6 nothing."""
    imitated: IntArray
    """(I, 6, R) labels of what its body did when it imitated each gesture."""

    def __post_init__(self) -> None:
        shapes, gestures = f"{self.habit.shape} habits and {self.imitated.shape} imitations", len(GESTURES)
        if self.habit.ndim != 2 or self.imitated.ndim != 3 or self.imitated.shape[:2] != (len(self.habit), gestures):
            raise ExperimentError(f"{shapes}: give (I, H) and (I, {gestures}, R) labels of the same infants")
        if not (self.habit.size and self.imitated.size):
            raise ExperimentError(f"{shapes}: every infant needs at least one of each")
        for labels in (self.habit, self.imitated):
            if labels.min() < 0 or labels.max() >= LABELS:
                raise ExperimentError(f"labels {labels.min()} to {labels.max()}: a judge has 0 to {LABELS - 1}")

    @cached_property
    def looks(self) -> FloatArray:
        """(I, 7, 7) P(label | infant, gesture imitated), and in the last row P(label | habit)."""
        shares = [(labels[..., None] == np.arange(LABELS)).mean(-2) for labels in (self.imitated, self.habit[:, None])]
        return fixed(np.concatenate(shares, axis=1))


@dataclass(frozen=True)
class Theory:
    """Who imitates how much, and what moves an infant to act. Numbers are assumptions, chosen and not fitted: no study
    that could be retrieved gives counts by infant."""

    imitation: float
    """w, share of acts that are imitations, mean over infants: 1 active intermodal mapping, 0 arousal alone."""
    tongue_interest: float = 1.0
    """Acts while the tongue comes out, as a multiple of those before other moving faces (Jones 1996: it is merely more
    interesting)."""
    passive_interest: float = 0.6
    """The same before a face at rest."""
    object_interest: float = 0.7
    """The same before a thing that moves."""
    acts_a_minute: float = 8.0
    """Before a moving face, mean over infants."""
    activity_cv: float = 0.6
    """Standard deviation of a_i: some infants act more than others."""
    state_sd: float = 0.5
    """Of log s_im: an infant is more awake during one model than during another."""
    likeness: float = 6.0
    """k, how like each other infants are in w_i; all alike where w is 0 or 1."""

    def interest(self, model: str) -> float:
        """How much an infant acts before this model, as a multiple of what it does before a moving face."""
        special = {GESTURES[0]: self.tongue_interest, PASSIVE: self.passive_interest}
        return (special | dict.fromkeys(OBJECTS, self.object_interest)).get(model, 1.0)

    def counts(
        self, infants: Infants, who: IntArray, models: Sequence[str], minutes: float, rng: np.random.Generator
    ) -> IntArray:
        """(..., M, 6) acts of each gesture that a judge counts in (...) infants while each of M models is shown for so
        many minutes; w, a and s are drawn anew each time."""
        w = np.full(who.shape, self.imitation)
        if 0 < self.imitation < 1:
            w = rng.beta(self.likeness * self.imitation, self.likeness * (1 - self.imitation), who.shape)
        active = rng.gamma(self.activity_cv**-2, self.activity_cv**2, who.shape)
        state = rng.lognormal(-(self.state_sd**2) / 2, self.state_sd, (*who.shape, len(models)))
        acts = minutes * self.acts_a_minute * np.array([self.interest(model) for model in models])
        shown = [GESTURES.index(model) if model in GESTURES else HABIT for model in models]
        looks, habit = infants.looks[who[..., None], shown], infants.looks[who[..., None], HABIT]
        seen = (habit + w[..., None, None] * (looks - habit))[..., :HABIT]
        return np.asarray(rng.poisson((active[..., None] * state * acts)[..., None] * seen))


THEORIES: Final = {
    "imitation, w = 1": Theory(1.0),
    "w = 0.5": Theory(0.5),
    "w = 0.25": Theory(0.25),
    "w = 0.1": Theory(0.1),
    "w = 0.05": Theory(0.05),
    "arousal, all models alike": Theory(0.0),
    "arousal, tongue 1.6 x": Theory(0.0, tongue_interest=1.6),
}
"""Active intermodal mapping (Meltzoff and Moore 1997), mixtures, and what a prior over actions does without it."""
