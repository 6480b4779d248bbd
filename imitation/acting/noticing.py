"""Noticing that the body is not what it was: the evidence, joint by joint, that what is felt is no longer foretold.

What a belief missed, e (the innovation of its Kalman filter, posture and rate), is foretold itself, by what a rehearsal
showed of a body that had not changed. With features x and z >= 0 of what went before (earlier misses, rates, commands):

    e = W x + r,    r_i^2 ~ z . b_i,    nothing changed:  r = t_nu(0, C),    something did:  r = t_nu(0, k^2 C)

t_nu is Student's t, for a healthy body is surprising at times; the broad one says that anything may come. For a few k
the log evidence ratio l is added up as a CUSUM (Page 1954) that fades within the half second in which it has to speak:

    S' = max(0, FADING S + l)

How large the root of S grows by chance is read off the rehearsal too, from the most of every second (`Chance`). The
surprise of a joint is -log of the probability that it comes so far within a second; that of the body is the same of
the greatest one, or of the sum of the three greatest. It is noticed where that exceeds log(seconds): once in so many
seconds of imitation somebody cries wolf.
"""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from babbling.axes import BoolArray, FloatArray
from babbling.regression import Regression
from imitation.acting.loop import Info, State

LAGS = 3
"""Earlier misses that foretell a miss."""
BROADER = (15.0, 60.0)
"""k: how many times as far as usual a miss may lie once something changed."""
FADING = 0.96
"""Per tick."""
RARE = 0.05
"""Share of the seconds of a rehearsal from which chance is extrapolated."""
FEW = 5.0
"""Exceedances that a joint borrows from the others."""
FREEDOMS = np.geomspace(1.5, 60, 40)
"""nu that are tried."""
RIDGE = 1e-3
"""Prior precision of W, in units of each feature's mean square and the noise's."""
TOGETHER = (1, 3)
"""So many greatest surprises are added: a change may be felt in one joint alone, or in several."""
_ROUNDS = 20
_TINY = 1e-18


class Run(NamedTuple):
    """What a mind foretold and felt, T ticks in a row; all one needs of `Info`."""

    missed: FloatArray
    """(T, B, F, 2)."""
    rate: FloatArray
    """(T, B, F) believed."""
    command: FloatArray
    """(T, B, F)."""

    @classmethod
    def of(cls, infos: Sequence[Info]) -> "Run":
        """Of steps one after the other."""
        rows = [(info.missed, info.believed[..., 1], info.commands) for info in infos]
        return cls(*map(np.stack, zip(*rows, strict=True)))

    def features(self) -> tuple[FloatArray, FloatArray]:
        """(T - LAGS, B, F, X) and (T - LAGS, B, F, Z): x and z at every tick but the first."""
        last = len(self.rate) - 1
        v, w, c = (x[LAGS - 1 : last] for x in (self.rate, np.diff(self.rate, axis=0, prepend=self.rate[:1]),
                                                np.diff(self.command, axis=0, prepend=self.command[:1])))  # fmt: skip
        bend = np.diff(self.command, 2, axis=0)[LAGS - 3 : last - 2]
        earlier = [self.missed[LAGS - lag : last + 1 - lag] for lag in range(1, LAGS + 1)]
        x = np.concatenate([*earlier, np.stack([np.ones_like(v), v, v * np.abs(v), w, c, bend], -1)], -1)
        alone = np.stack([v, c, bend, w], -1) ** 2
        together = np.broadcast_to(alone[..., 2:].mean(2, keepdims=True), (*v.shape, 2))
        return x, np.concatenate([np.ones((*v.shape, 1)), alone, together], -1)


class Chance(NamedTuple):
    """How large something grows within a second: P(x > s) = RARE exp(-(s - u) / m) beyond the quantile u, m the mean
    excess; arrays of one shape."""

    usual: FloatArray
    """u."""
    excess: FloatArray
    """m; with `FEW` exceedances taken from all factors alike, in units of u."""

    @classmethod
    def found(cls, sizes: FloatArray, tick_s: float) -> "Chance":
        """From (T, ..., B, F) sizes >= 0; copies are alike."""
        second = round(1 / tick_s)
        most = sizes[: len(sizes) // second * second]
        most = np.moveaxis(most.reshape(-1, second, *sizes.shape[1:]).max(1), -2, 1)
        most = most.reshape(-1, *most.shape[2:])
        usual = np.maximum(np.quantile(most, 1 - RARE, axis=0), 1)
        over = np.maximum(most - usual, 0)
        count, share = (over > 0).sum(0), over.sum(0) / usual
        alike = np.maximum(share.sum(-1, keepdims=True) / np.maximum(count.sum(-1, keepdims=True), 1), RARE)
        return cls(usual, usual * (share + FEW * alike) / (count + FEW))

    def surprise(self, size: FloatArray) -> FloatArray:
        """-log P of (..., B, F) sizes; those below u say nothing: -log RARE at most, 0 at 0."""
        usual = self.usual[..., None, :]
        beyond, below = (size - usual) / self.excess[..., None, :], np.minimum(size / usual, 1)
        return np.asarray(np.maximum(beyond, 0) - np.log(RARE) * below)


class Alarm(NamedTuple):
    """When sizes of what F joints show, by K measures, are more than chance."""

    alone: Chance
    """(K, F)."""
    body: Chance
    """(TOGETHER,) of the sums of the greatest surprises."""

    @classmethod
    def found(cls, sizes: FloatArray, tick_s: float) -> "Alarm":
        """From (T, K, B, F) sizes of about 1 or more while nothing changed."""
        alone = Chance.found(sizes, tick_s)
        return cls(alone, Chance.found(_greatest(alone.surprise(sizes).max(-3)), tick_s))

    def surprise(self, sizes: FloatArray) -> FloatArray:
        """(..., B, F) of each joint, the greatest of its (..., K, B, F) sizes."""
        return np.asarray(self.alone.surprise(sizes).max(-3))

    def whole(self, surprise: FloatArray) -> FloatArray:
        """(..., B) surprise of the whole body, of (..., B, F) joints."""
        together = self.body.surprise(_greatest(surprise)).max(-1)
        return np.asarray(np.maximum(together - np.log(len(TOGETHER)), 0))


class Normal(NamedTuple):
    """What misses are like while nothing changes; see the module."""

    weights: FloatArray
    """(F, 2, X) W."""
    spread: FloatArray
    """(F, 2, Z) b."""
    whitening: FloatArray
    """(F, 2, 2) root of C^-1."""
    freedom: FloatArray
    """(F,) nu."""
    alarm: Alarm
    """For roots of S."""

    @classmethod
    def found(cls, run: Run, tick_s: float) -> "Normal":
        """From what two copies or more foretold and felt while nothing changed. How far chance goes is read off each
        half of the copies by what the other half is like."""
        halves = [Run(*(values[:, half::2] for values in run)) for half in (0, 1)]
        sizes = [cls._fitted(one).sizes(other) for one, other in zip(halves, halves[::-1], strict=True)]
        return cls._fitted(run)._replace(alarm=Alarm.found(np.concatenate(sizes, 2), tick_s))

    @classmethod
    def _fitted(cls, run: Run) -> "Normal":
        """All but chance."""
        x, z = run.features()
        x, z, missed = (v.reshape(-1, *v.shape[2:]) for v in (x, z, run.missed[LAGS:]))
        sums = Regression(missed.shape[1], x.shape[-1], 2)
        sums.observe(x, missed)
        weights = sums.fit(RIDGE).coefficients
        squares = (missed - np.einsum("nfx,fyx->nfy", x, weights)) ** 2
        spread = np.stack([[_spread(z[:, f], squares[:, f, y]) for y in (0, 1)] for f in range(z.shape[1])])
        none, factors = Chance(np.ones(1), np.ones(1)), len(weights)
        start = cls(weights, spread, np.tile(np.eye(2), (factors, 1, 1)), np.ones(factors), Alarm(none, none))
        fits = [_student(rest) for rest in start.standard(run).reshape(-1, factors, 2).swapaxes(0, 1)]
        return start._replace(whitening=np.stack([f[0] for f in fits]), freedom=np.array([f[1] for f in fits]))

    def sizes(self, run: Run) -> FloatArray:
        """(T - LAGS, K, B, F) root of S of a run."""
        grown = [np.zeros((len(BROADER), *run.rate.shape[1:]))]
        for ratio in self.ratios(run):
            grown.append(grow(grown[-1], ratio))
        return np.asarray(np.sqrt(np.stack(grown[1:])))

    def standard(self, run: Run) -> FloatArray:
        """(T - LAGS, B, F, 2) r of every tick but the first, in units of what is usual there."""
        x, z = run.features()
        rest = run.missed[LAGS:] - np.einsum("tbfx,fyx->tbfy", x, self.weights)
        return np.asarray(
            np.einsum(
                "tbfy,fyw->tbfw", rest / np.sqrt(np.einsum("tbfz,fyz->tbfy", z, self.spread) + _TINY), self.whitening
            )
        )

    def ratios(self, run: Run) -> FloatArray:
        """(T - LAGS, K, B, F) log evidence that something changed, tick by tick."""
        squared, half = (self.standard(run) ** 2).sum(-1)[:, None], (self.freedom + 2) / 2
        k2 = np.array(BROADER)[:, None, None] ** 2
        far = np.log1p(squared / self.freedom) - np.log1p(squared / (self.freedom * k2))
        return np.asarray(half * far - np.log(k2))


def grow(grown: FloatArray, ratio: FloatArray) -> FloatArray:
    """S' of S and log evidence ratios."""
    return np.asarray(np.maximum(FADING * grown + ratio, 0))


class Noticer:
    """Listens to a run (`heed` of `imitate`) and keeps how surprised each joint is.

    Args:
        normal: what a rehearsal was like.
        per_hour: false alarms an hour that one puts up with.
    """

    def __init__(self, normal: Normal, per_hour: float = 1.0) -> None:
        self.normal, self.limit = normal, float(np.log(3600 / per_hour))
        self.surprises = list[FloatArray]()
        """(B, F) of each tick."""
        self._recent = deque[Info](maxlen=LAGS + 1)

    def __call__(self, state: State, senses: FloatArray, info: Info) -> None:
        """See `imitate`."""
        if not state.tick:
            self._recent.clear()
            self._grown = np.zeros((len(BROADER), *info.commands.shape))
        self._recent.append(info)
        if len(self._recent) > LAGS:
            self._grown = grow(self._grown, self.normal.ratios(Run.of(list(self._recent)))[0])
        self.surprises.append(self.normal.alarm.surprise(np.sqrt(self._grown)))

    @property
    def noticed(self) -> BoolArray:
        """(B,) whether something has changed, as it seems now."""
        return np.asarray(self.normal.alarm.whole(self.surprises[-1]) > self.limit)


def _greatest(surprise: FloatArray) -> FloatArray:
    """(..., B, TOGETHER)."""
    ordered = np.sort(surprise, -1)
    return np.stack([ordered[..., -together:].sum(-1) for together in TOGETHER], -1)


def _spread(z: FloatArray, squares: FloatArray) -> FloatArray:
    """b >= 0 of squares ~ z . b, each weighed by how exact it is: by its own expectation."""
    size = z.mean(0) + _TINY
    weight = np.full(len(z), squares.mean() + _TINY)
    for _ in range(2):
        found = nnls(z / size / weight[:, None], squares / weight)[0] / size
        weight = z @ found + _TINY
    return np.asarray(found)


def _student(rest: FloatArray) -> tuple[FloatArray, float]:
    """Root of C^-1 and nu of (N, 2) values: expectation maximisation, nu by its likelihood."""
    scatter, freedom = np.cov(rest.T), 4.0
    for number in range(_ROUNDS):
        squared = (rest @ np.linalg.inv(scatter) * rest).sum(-1)
        if number % 5 == 4:
            half = (FREEDOMS + 2) / 2
            freedom = float(FREEDOMS[np.argmin(half * np.log1p(squared[:, None] / FREEDOMS).mean(0))])
        scatter = ((freedom + 2) / (freedom + squared) * rest.T) @ rest / len(rest)
    return np.linalg.cholesky(np.linalg.inv(scatter)), freedom
