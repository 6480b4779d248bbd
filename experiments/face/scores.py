"""Published ways of scoring newborns' imitation: how often each finds what is there, and what is not there.

Every score is a law of (B, n, M, 6) counts, B samples of n infants with M models, tongue out first and mouth open
second, to (B,) whether it is significant: one-sided t tests over infants at 5 %. A tongue act is label 0, tongue out;
the tongue to the side is counted for neither gesture. Published effects are of separate papers and of designs unlike
each other: they stand beside the simulated ones, which were not fitted to them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
from scipy.stats import norm, t

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.errors import ExperimentError
from experiments.face.theories import GESTURES, OBJECTS, PASSIVE, STRANGE, THEORIES, Infants, Theory

TONGUE, MOUTH = GESTURES.index("tongue out"), GESTURES.index("mouth open")
LEVEL: Final = 0.05
NS: Final = (6, 12, 40, 106)
"""Infants of Meltzoff and Moore (1977, experiments 1 and 2; 1983 and later) and of Oostenbroek et al. (2016)."""
PUBLISHED: Final[Mapping[str, Mapping[str, Any]]] = {
    "meta-analysis": {"d": 0.68, "interval": (0.39, 0.96)},
    "Meltzoff and Moore": {"g": 1.87},
    "other laboratories": {"g": 0.38},
    "Oostenbroek et al.": {"g": 0.09},
}
"""Davis et al. (2021): 336 effects, 949 infants. By laboratory: random effects over the rows of MetaLab's
neonatal_imitation.csv, taken as independent."""


def beyond(acts: FloatArray | IntArray) -> FloatArray:
    """(B, n, 2, M - 1) by how much an infant does the tongue's, the mouth's act more while it is shown than while each
    other model is; the mouth's model comes first among the tongue's others and the reverse."""
    tongue, mouth = acts[..., TONGUE], acts[..., MOUTH]
    return np.stack([tongue[..., :1] - tongue[..., 1:], mouth[..., 1:2] - np.delete(mouth, 1, -1)], -2)


def above(differences: FloatArray | IntArray) -> BoolArray:
    """(B,) whether each of (B, n, ...) differences has a mean over infants above t_0.95(n - 1) standard errors, every
    one in a test of its own. Where no infant differs from another the sign decides, and no difference is none."""
    n = differences.shape[1]
    error = differences.std(1, ddof=1) / np.sqrt(n)
    sure = differences.mean(1) > t.ppf(1 - LEVEL, n - 1) * error
    return np.asarray(sure.reshape(len(differences), -1).all(1))


def effect_size(differences: FloatArray | IntArray) -> FloatArray:
    """(B,) Hedges' g = (1 - 3 / (4 (n - 1) - 1)) mean / standard deviation of (B, n) differences within infants; 0
    where no infant differs from another."""
    mean, sd = differences.mean(1), differences.std(1, ddof=1)
    g = np.divide(mean, sd, out=np.zeros(len(mean)), where=sd > 0)
    return np.asarray(g * (1 - 3 / (4 * differences.shape[1] - 5)))


def raw(counts: IntArray) -> BoolArray:
    """Tongue acts while the tongue is shown exceed those before a passive face."""
    return above(beyond(counts)[:, :, 0, 1])


def cross_target(counts: IntArray) -> BoolArray:
    """Tongue acts while the tongue is shown exceed those while the mouth is (Meltzoff and Moore 1983)."""
    return above(beyond(counts)[:, :, 0, 0])


def cross_target_sum(counts: IntArray) -> BoolArray:
    """The same difference and the mouth's, added."""
    return above(beyond(counts)[..., 0].sum(-1))


def cross_target_each(counts: IntArray) -> BoolArray:
    """Both differences, each in a test of its own."""
    return above(beyond(counts)[..., 0])


def cross_target_shares(counts: IntArray) -> BoolArray:
    """The sum, on shares of all acts of a period that a judge names: how active an infant is drops out. One that does
    nothing in either period has no share to compare, and differs by 0."""
    total = counts[..., :2, :].sum(-1)
    shares = counts[..., :2, :] / np.maximum(total, 1)[..., None]
    return above(beyond(shares)[..., 0].sum(-1) * (total > 0).all(-1))


def over_each(counts: IntArray) -> BoolArray:
    """Both gestures exceed what is done while each other model is shown, every one in a test of its own."""
    return above(beyond(counts))


def over_mean(counts: IntArray) -> BoolArray:
    """Both gestures exceed the mean over all other models."""
    return above(beyond(counts).mean(-1))


class Protocol(NamedTuple):
    """What is shown to every infant, and for how long."""

    models: tuple[str, ...]
    minutes: float
    """Each; where demonstration and a still face take turns, the acts of both are counted, and the still face between
    two demonstrations moves an infant as they do."""


class Score(NamedTuple):
    """A protocol, and the law by which its counts say that there is imitation."""

    protocol: Protocol
    test: Callable[[IntArray], BoolArray]


_CROSS = Protocol((GESTURES[TONGUE], GESTURES[MOUTH], PASSIVE), 4.0)
"""Meltzoff and Moore (1983); the minutes recalled."""
_ANISFELD = Protocol(_CROSS.models, 160 / 60)
"""Anisfeld et al. (2001): 20 s of demonstration, 20 s still, 160 s in all; control is a passive face throughout."""
_OTHERS = tuple(gesture for gesture in GESTURES if gesture not in _CROSS.models)
_OOSTENBROEK = Protocol((*_CROSS.models[:2], *_OTHERS, *STRANGE, *OBJECTS), 1.0)
"""After Oostenbroek et al. (2016), nine social and two other models, with the gestures of this body; the minute
recalled."""
SCORES: Final = {
    "tongue over passive face": Score(_CROSS, raw),
    "cross-target, tongue alone": Score(_CROSS, cross_target),
    "cross-target, both added": Score(_CROSS, cross_target_sum),
    "cross-target, each of both": Score(_CROSS, cross_target_each),
    "cross-target, both, shares": Score(_CROSS, cross_target_shares),
    "Anisfeld: each over 2 others": Score(_ANISFELD, over_each),
    "Oostenbroek: each over mean of 10": Score(_OOSTENBROEK, over_mean),
    "Oostenbroek: each over each of 10": Score(_OOSTENBROEK, over_each),
}


@dataclass(frozen=True, eq=False)
class Powers:
    """How often every score was significant under every theory."""

    theories: Mapping[str, Theory]
    ns: tuple[int, ...]
    repeats: int
    hits: IntArray
    """(T, S, N) of `repeats`."""
    effects: FloatArray
    """(T, N, 3) Hedges' g of the tongue's cross-target difference: mean, 2.5 % and 97.5 % of repeats."""

    @property
    def share(self) -> FloatArray:
        """(T, S, N) of results that are significant: power, or false positives where nobody imitates."""
        return np.asarray(self.hits / self.repeats)

    @property
    def interval(self) -> FloatArray:
        """(T, S, N, 2) 95 % of that share (Wilson 1927)."""
        z2 = norm.ppf(0.975) ** 2
        middle = (self.hits + z2 / 2) / (self.repeats + z2)
        half = np.sqrt(z2 * (self.hits * (1 - self.share) + z2 / 4)) / (self.repeats + z2)
        return np.stack([middle - half, middle + half], -1).clip(0, 1)

    def as_metrics(self) -> dict[str, Any]:
        """For metrics.json: theory -> score -> n, by name."""
        found: dict[str, Any] = {f"{what}{of}": {} for what in ("power", "false_positives") for of in ("", "_interval")}
        size = [str(n) for n in self.ns]
        for k, (name, theory) in enumerate(self.theories.items()):
            what = "power" if theory.imitation else "false_positives"
            for key, values in ((what, self.share[k]), (f"{what}_interval", self.interval[k])):
                rows = zip(SCORES, values.tolist(), strict=True)
                found[key][name] = {score: dict(zip(size, row, strict=True)) for score, row in rows}
        simulated = {
            name: {n: {"g": g, "interval": ends} for n, (g, *ends) in zip(size, rows, strict=True)}
            for name, rows in zip(self.theories, self.effects.tolist(), strict=True)
        }
        return found | {"effect_size": {"simulated": simulated, "published": PUBLISHED}}


def power(
    infants: Infants,
    theories: Mapping[str, Theory] = THEORIES,
    ns: Sequence[int] = NS,
    repeats: int = 400,
    *,
    rng: np.random.Generator,
) -> Powers:
    """Samples of n different infants, new acts each time, scored in every way. Intervals are over repeats: samples of
    the same infants, so they say how well the share is known for these infants.

    Raises:
        ExperimentError: more infants a sample than there are, or fewer than two.
    """
    everybody, protocols = np.arange(len(infants.habit)), dict.fromkeys(score.protocol for score in SCORES.values())
    for n in ns:
        if not 2 <= n <= len(everybody):
            raise ExperimentError(f"samples of {n} infants: there are {len(everybody)}, and a t test needs at least 2")
    hits = np.empty((len(theories), len(SCORES), len(ns)), np.int64)
    effects = np.empty((len(theories), len(ns), 3))
    for k, theory in enumerate(theories.values()):
        for j, n in enumerate(ns):
            who = rng.permuted(np.tile(everybody, (repeats, 1)), axis=1)[:, :n]
            counts = {protocol: theory.counts(infants, who, *protocol, rng) for protocol in protocols}
            hits[k, :, j] = [score.test(counts[score.protocol]).sum() for score in SCORES.values()]
            g = effect_size(beyond(counts[_CROSS])[:, :, 0, 0])
            effects[k, j] = g.mean(), *np.percentile(g, (2.5, 97.5))
    return Powers(theories, tuple(ns), repeats, hits, effects)
