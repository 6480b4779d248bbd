"""Which organ does somebody else move? Own acts as hypotheses (chapter, section 2.2: organ identification comes first).

What one has babbled is what another may be doing. Acts that move one motor of one's own, two, or the mouth's and up to
two more, are imagined through the forward model, on a grid of commands, as the relations they would end in. What was
seen is a Gaussian likelihood over relations (information L about x), so that with kernels T of half a grid step, and of
how nearly faces are alike,

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

LEVELS: Final = 7
"""Commands imagined of each motor."""
NOTHING: Final = 0.3
"""P(nothing was done), beforehand: most of the time a face is at rest, and what a tongue does behind shut lips cannot
be seen."""
FEWER: Final = 0.03
"""P(one motor more), against one less."""
SHOWS: Final = 0.04, -0.1
"""Gap from which, and place beyond the lips from which, the tongue is seen."""
LAPSE: Final = 0.02
"""P(it is seen, or not, against that)."""
CLOUD: Final = 1e-8
"""Share of the likelihood that anything might look like: no hypothesis is ruled out for good."""
ALIKE: Final = 0.008
"""How nearly another's relations are seen as they are: what an innate template of the average face misses."""
OTHERS: Final = 0.02
"""How far relations that were not moved may look moved, once it is known which were."""


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

    @cached_property
    def _alike(self) -> tuple[tuple[IntArray, FloatArray, FloatArray, BoolArray], ...]:
        """Hypotheses of equally many acts side by side: their numbers, (S, A, 8) relations, (S, 8) squared kernels, and
        (S, A) whether the tongue could be seen."""
        counts = np.array([len(one.relations) for one in self.acts])
        groups = []
        for count in np.unique(counts):
            which = np.flatnonzero(counts == count)
            some = [self.acts[k] for k in which]
            kernels = np.stack([(one.step / 2) ** 2 + ALIKE**2 for one in some])
            groups.append((which, np.stack([o.relations for o in some]), kernels, np.stack([o.shows() for o in some])))
        return tuple(groups)

    def posterior(self, seen: FloatArray, information: FloatArray, tongue: bool) -> Posterior:
        """P(S | seen) over `acts`.

        Args:
            seen: (8,) relations, those of a face at rest as one's own at rest.
            information: (8, 8) how surely.
            tongue: whether the tongue was seen.
        """
        log = np.empty(len(self.acts))
        for which, relations, kernels, shows in self._alike:
            wide = np.eye(len(seen)) + kernels[:, :, None] * information
            precision = information @ np.linalg.inv(wide)
            off = relations - seen
            each = -0.5 * ((off @ precision) * off).sum(-1) - 0.5 * np.linalg.slogdet(wide)[1][:, None]
            each += np.log(np.where(shows == tongue, 1 - LAPSE, LAPSE))
            log[which] = logsumexp(each, axis=1) - np.log(each.shape[1])
        return action_posterior(np.exp(log - log.max()) + CLOUD, self.prior)

    def _sets(self) -> Iterator[tuple[int, ...]]:
        others = [motor for motor in sorted(set(self.mind.motors.tolist())) if motor != self.opener]
        yield (self.opener,)
        for count in (1, 2):
            for some in combinations(others, count):
                yield some
                yield (self.opener, *some)

    def _imagined(self, motors: tuple[int, ...]) -> Imagined:
        model, factors = self.mind.forward_model, len(self.mind.motors)
        owned = [np.flatnonzero(self.mind.motors == motor) for motor in motors]
        levels = [np.linspace(model.action.low[own[0]], model.action.high[own[0]], LEVELS) for own in owned]
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
        step[moved] = np.ptp(relations[:, moved], 0) / (LEVELS - 1)
        return Imagined(motors, relations, step)


def owned(mind: FaceMind, motors: tuple[int, ...]) -> BoolArray:
    """(8,) relations that these motors move."""
    return np.isin(mind.motors, motors)


def given_still(seen: FloatArray, information: FloatArray, moved: BoolArray, still: FloatArray) -> FloatArray:
    """(8,) relations that were seen, knowing that all but `moved` were as at rest, up to how far faces differ: where
    the Gaussian likelihood times that prior is largest."""
    prior = np.diag(np.where(moved, 1e-6, 1 / OTHERS**2))
    found = np.linalg.solve(information + prior, information @ seen + prior @ still)
    return np.asarray(np.where(moved, found, still))


def likeliest(acts: OwnActs, posterior: Posterior) -> tuple[int, ...]:
    """The motors of the most probable hypothesis."""
    return acts.acts[int(posterior.probability.argmax())].motors
