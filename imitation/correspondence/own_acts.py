"""Which organ does somebody else move? Own acts as hypotheses (chapter, section 2.2: organ identification comes first).

What one has babbled is what another may be doing. Acts that move one motor of one's own, two, or the mouth's and up to
two more, are imagined through the forward model, on a grid of commands, as the relations they would end in. What was
seen is a Gaussian likelihood over relations (information L about x), so that with kernels of half a grid step T^2

    P(moved motors S | seen) = c P(S) mean_a |I + T^2 L|^(-1/2) exp(-(x - r_a)' (L^-1 + T^2)^-1 (x - r_a) / 2)

over the acts a of S. Whole acts are weighed, not single relations: a tongue out and an open mouth share the gap.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from scipy.special import logsumexp

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.dark import FaceMind, gaps
from imitation.inference.bayes import Posterior, action_posterior

FINE, MIDDLE, COARSE = 25, 11, 7
"""Commands imagined of each motor where one, two or three move."""
NOTHING: Final = 0.1
"""P(nothing was done), beforehand."""
FEWER: Final = 0.2
"""P(one motor more), against one less."""
SHOWS: Final = 0.04, -0.1
"""Gap from which, and place beyond the lips from which, the tongue is seen."""
LAPSE: Final = 0.02
"""P(it is seen, or not, against that)."""
CLOUD: Final = 1e-4
"""Share of the likelihood that anything might look like: no hypothesis is ruled out for good."""


class Imagined(NamedTuple):
    """Acts that move the same motors."""

    motors: tuple[int, ...]
    relations: FloatArray
    """(A, 8) where they would end."""
    step: FloatArray
    """(8,) between neighbouring acts."""

    def shows(self) -> BoolArray:
        """(A,) whether the tongue could be seen."""
        return np.asarray((self.relations[:, 0] > SHOWS[0]) & (self.relations[:, 1] > SHOWS[1]))


@dataclass(frozen=True, eq=False)
class OwnActs:
    """All that one can imagine doing."""

    mind: FaceMind

    @cached_property
    def opener(self) -> int:
        """The motor that parts the lips."""
        return int(self.mind.motors[0])

    @cached_property
    def acts(self) -> tuple[Imagined, ...]:
        """Nothing first."""
        still = self.mind.still
        nothing = Imagined((), still[None], np.zeros(len(still)))
        return (nothing, *(self._imagined(motors) for motors in self._sets()))

    @cached_property
    def prior(self) -> FloatArray:
        """(H,) P(S): each further motor is less likely; of as many, all alike."""
        sizes = np.array([len(one.motors) for one in self.acts])
        share = np.where(sizes > 0, FEWER**sizes, 0.0) / np.bincount(sizes)[sizes]
        return np.asarray(np.where(sizes > 0, (1 - NOTHING) * share / share.sum(), NOTHING))

    def posterior(self, seen: FloatArray, information: FloatArray, tongue: bool) -> Posterior:
        """P(S | seen) over `acts`.

        Args:
            seen: (8,) relations, those of a face at rest as one's own at rest.
            information: (8, 8) how surely.
            tongue: whether the tongue was seen.
        """
        log = np.array([self._evidence(one, seen, information, tongue) for one in self.acts])
        return action_posterior(np.exp(log - log.max()) + CLOUD, self.prior)

    def _evidence(self, acts: Imagined, seen: FloatArray, information: FloatArray, tongue: bool) -> float:
        blur = np.diag((acts.step / 2) ** 2)
        wide = np.eye(len(seen)) + blur @ information
        precision = information @ np.linalg.inv(wide)
        off = acts.relations - seen
        log = -0.5 * np.einsum("ai,ij,aj->a", off, precision, off) - 0.5 * np.linalg.slogdet(wide)[1]
        log = log + np.log(np.where(acts.shows() == tongue, 1 - LAPSE, LAPSE))
        return float(logsumexp(log) - np.log(len(log)))

    def _sets(self) -> Iterator[tuple[int, ...]]:
        others = [motor for motor in sorted(set(self.mind.motors.tolist())) if motor != self.opener]
        yield (self.opener,)
        for count in (1, 2):
            for some in combinations(others, count):
                yield some
                yield (self.opener, *some)

    def _imagined(self, motors: tuple[int, ...]) -> Imagined:
        size = (FINE, MIDDLE, COARSE)[len(motors) - 1]
        model, factors = self.mind.forward_model, len(self.mind.motors)
        owned = [np.flatnonzero(self.mind.motors == motor) for motor in motors]
        levels = [np.linspace(*(end[own[0]] for end in (model.action.low, model.action.high)), size) for own in owned]
        grid = np.stack(np.meshgrid(*levels, indexing="ij"), -1).reshape(-1, len(motors))
        commands = np.tile(self.mind.rest[self.mind.motors], (len(grid), 1))
        for own, level in zip(owned, grid.T, strict=True):
            commands[:, own] = level[:, None]
        shut = model.expected([np.full((len(grid), factors), self.mind.still[0])], commands)
        open_ = shut[:, 0] if self.opener in motors else np.full(len(grid), self.mind.still[0])
        relations = np.tile(self.mind.still, (len(grid), 1))
        moved = np.concatenate(owned)
        relations[:, moved] = model.expected([gaps(open_, factors)], commands)[:, moved]
        step = np.zeros(factors)
        step[moved] = np.ptp(relations[:, moved], 0) / (size - 1)
        return Imagined(motors, relations, step)


def owned(mind: FaceMind, motors: tuple[int, ...]) -> BoolArray:
    """(8,) relations that these motors move."""
    return np.isin(mind.motors, motors)


def given_still(seen: FloatArray, information: FloatArray, moved: BoolArray, still: FloatArray) -> FloatArray:
    """(8,) relations that were seen, knowing that all but `moved` were as at rest: mean of the conditional Gaussian."""
    found = still.copy()
    free, fixed = np.flatnonzero(moved), np.flatnonzero(~moved)
    if len(free):
        inner = information[np.ix_(free, free)] + 1e-6 * np.eye(len(free))
        away = information[np.ix_(free, fixed)] @ (seen - still)[fixed]
        found[free] = seen[free] + np.linalg.solve(inner, away)
    return found


def likeliest(acts: OwnActs, posterior: Posterior) -> tuple[int, ...]:
    """The motors of the most probable hypothesis."""
    best: IntArray = np.asarray(posterior.probability.argmax())
    return acts.acts[int(best)].motors
