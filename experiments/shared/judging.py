"""How good something was: errors, learning curves, calibration, intervals; for those who judge."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class LearningCurve:
    """Prediction error of held-out experience against body time, in the unit of whoever drew it."""

    minutes: FloatArray
    """The pilot's counted."""
    table: FloatArray
    """Of the forward model."""
    line: FloatArray
    """Of a line fitted to the same experience."""
    unit: str = "deg"
    floor: float | None = None
    """What the best possible prediction would miss, where that can be known."""
    piloted: float | None = None
    """Minutes at the end of the pilot."""


def rmse(reached: FloatArray, wanted: FloatArray) -> float:
    """Root mean square over all frames and joints; where what was wanted is NaN is left out."""
    away = (reached - wanted)[np.isfinite(wanted)]
    return float(np.sqrt(np.mean(away**2)))


def rmse_deg(reached: FloatArray, wanted: FloatArray) -> float:
    """The same of radians, in degrees."""
    return float(np.rad2deg(rmse(reached, wanted)))


def ringing(error: FloatArray) -> FloatArray:
    """(J,) how far an error e (T, J) shakes from tick to tick, peak to peak as a sine wave of its strength:
    2 sqrt(2) RMS(second difference of e / 4). Slow errors hardly count."""
    return np.asarray(2 * np.sqrt(2 * np.mean((np.diff(error, 2, axis=0) / 4) ** 2, axis=0)))


def interval_95(hits: float, count: float) -> tuple[float, float]:
    """Exact 95 % interval of a share (Clopper and Pearson 1934), by the quantiles of beta distributions; of nothing
    tried, all shares.

    For `count` means in [0, 1] instead, whose sum is `hits`, it is too wide rather than too narrow: no numbers in
    [0, 1] vary more about their mean than zeros and ones.
    """
    from scipy.special import betaincinv  # all of scipy.stats takes half a second to load

    low = betaincinv(hits, count - hits + 1, 0.025) if hits > 0 else 0.0
    high = betaincinv(hits + 1, count - hits, 0.975) if hits < count else 1.0
    return float(low), float(high)


def intervals_95(right: BoolArray) -> list[tuple[float, float]]:
    """The same of every column of (N, K)."""
    return [interval_95(int(hits), len(right)) for hits in right.sum(0)]


def calibration_error(confidence: FloatArray, right: BoolArray, bins: int = 10) -> tuple[float, FloatArray]:
    """Expected calibration error sum_b n_b/N |accuracy_b - confidence_b|, and (bins, 3) confidence, accuracy, count."""
    index = np.minimum((confidence * bins).astype(int), bins - 1)
    count = np.bincount(index, minlength=bins)
    sure, hits = (np.bincount(index, each, bins) / np.maximum(count, 1) for each in (confidence, right))
    return float(np.average(np.abs(sure - hits), weights=count)), np.stack([sure, hits, count], 1)


def calibration_of_chance(confidence: FloatArray, bins: int = 10) -> float:
    """What `calibration_error` of (N,) confidences would be on average if they were exactly right, for of few trials in
    a bin accuracy differs from them by chance: sum_b sqrt(2 / pi sum_{i in b} p_i (1 - p_i)) / N, of many."""
    index = np.minimum((confidence * bins).astype(int), bins - 1)
    return float(np.sqrt(2 / np.pi * np.bincount(index, confidence * (1 - confidence), bins)).sum() / len(confidence))


def calibrations(name: str, learners: Sequence[tuple[FloatArray, BoolArray]]) -> dict[str, Any]:
    """Calibration error over all trials of several learners, each its (N,) confidences and whether they were right; of
    each alone; and what chance alone would show in either."""
    sure, right = (np.concatenate(each) for each in zip(*learners, strict=True))
    return {
        f"{name}_calibration_error": calibration_error(sure, right)[0],
        f"{name}_calibration_of_chance": calibration_of_chance(sure),
        f"{name}_calibration_error_by_play": [calibration_error(*one)[0] for one in learners],
        f"{name}_calibration_of_chance_by_play": [calibration_of_chance(one) for one, _ in learners],
    }


def scores(probability: FloatArray, target: IntArray) -> FloatArray:
    """(3,) of (N, G) beliefs about (N,) truths: log loss, nats (a belief of 0 counts as 1e-6); Brier score, the squared
    distance from the truth; expected calibration error of the most probable."""
    chosen, truth = probability.argmax(1), np.eye(probability.shape[1])[target]
    surprise = -np.log(np.maximum((probability * truth).sum(1), 1e-6))
    off = calibration_error(probability.max(1), chosen == target)[0]
    return np.array([surprise.mean(), ((probability - truth) ** 2).sum(1).mean(), off])


def constant_confidence(probability: FloatArray, target: IntArray) -> FloatArray:
    """The peer that takes what (N, G) beliefs take and is always as sure as they are right on average, the rest spread
    evenly: (N, G), well calibrated by construction."""
    chosen, others = probability.argmax(1), probability.shape[1] - 1
    accuracy = (chosen == target).mean()
    return np.asarray(np.where(np.eye(others + 1, dtype=bool)[chosen], accuracy, (1 - accuracy) / others))


def over_learners(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean of (S, ...) values over S learners, and half of its 95 % interval by Student's t."""
    from scipy.stats import t  # takes half a second to load

    half = t.ppf(0.975, len(values) - 1) * values.std(0, ddof=1) / np.sqrt(len(values))
    return values.mean(0), half


def interval_over_learners(values: FloatArray) -> tuple[float, float] | None:
    """The ends of that interval, of (S,) values; None for one learner."""
    if len(values) < 2:
        return None
    middle, half = over_learners(values)
    return float(middle - half), float(middle + half)


def share_over_learners(values: FloatArray) -> tuple[float, float] | None:
    """The same of (S,) shares, each learner's own; none lies beyond 0 and 1."""
    found = interval_over_learners(values)
    return found and (max(found[0], 0.0), min(found[1], 1.0))


def difference(one: tuple[int, int], other: tuple[int, int]) -> tuple[float, float]:
    """By how much the share of one (hits, count) lies above another's, and its standard error (Agresti and Caffo 2000,
    whose added successes and failures keep it from 0)."""
    shares = [(hits + 1) / (count + 2) for hits, count in (one, other)]
    error = np.sqrt(sum(p * (1 - p) / (count + 2) for p, (_, count) in zip(shares, (one, other), strict=True)))
    return one[0] / one[1] - other[0] / other[1], float(error)


def alike(one: tuple[int, int], other: tuple[int, int], margin: float) -> float:
    """p of two shares (hits, count) being further apart than `margin`: two one-sided tests (Schuirmann 1987)."""
    from scipy.stats import norm  # takes half a second to load

    gap, error = difference(one, other)
    return float(max(norm.sf((gap + margin) / error), norm.cdf((gap - margin) / error)))


def lately(happened: BoolArray, ticks: float) -> BoolArray:
    """(T,) where it happens, or did at most so many ticks ago."""
    return np.convolve(happened, np.ones(round(ticks) + 1))[: len(happened)] > 0


class Verdict(NamedTuple):
    """Whether something is so, as far as an interval tells: no claim is made beyond it."""

    holds: bool | None
    """None: too few to tell."""
    low: float
    high: float
    """Interval of a difference."""
    n: int
    """Trials, or learners, that it rests on."""
    level: int = 95
    """Per cent."""

    @property
    def said(self) -> str:
        """In words."""
        return "too few to tell" if self.holds is None else "yes" if self.holds else "no"

    def told(self, of: str = "+.1%") -> str:
        """The same with its interval, for a table or a figure."""
        many = f"n = {self.n}"
        if not np.isfinite([self.low, self.high]).all():
            return f"{self.said} ({many})"
        return f"{self.said} ({self.low:{of}} to {self.high:{of}}, {self.level} %, {many})"

    @property
    def numbers(self) -> dict[str, Any]:
        """For metrics.json."""
        ends = [end if np.isfinite(end) else None for end in (self.low, self.high)]
        return {"holds": self.holds, "said": self.told(), f"interval_{self.level}": ends, "n": self.n}


def above_zero(low: float, high: float, n: int) -> Verdict:
    """Whether a difference lies above 0: told only where its 95 % interval does not include it."""
    return Verdict(True if low > 0 else False if high < 0 else None, float(low), float(high), n)


def within(low: float, high: float, n: int, margin: float) -> Verdict:
    """Whether a difference lies within a margin of 0, by its 90 % interval: two one-sided tests (Schuirmann 1987)."""
    apart = low >= margin or high <= -margin
    return Verdict(True if -margin < low and high < margin else False if apart else None, low, high, n, 90)


def more_often(one: BoolArray, other: BoolArray) -> Verdict:
    """Whether something happens more often than something else in the same trials, (N,) each: exactly, given how many
    of the trials tell them apart (McNemar 1947; Clopper and Pearson's interval of the share among those)."""
    n, better, worse = one.size, int((one & ~other).sum()), int((other & ~one).sum())
    if not better + worse:
        most = interval_95(0, n)[1]
        return above_zero(-most, most, n)
    low, high = (2 * end - 1 for end in interval_95(better, better + worse))
    return above_zero(low * (better + worse) / n, high * (better + worse) / n, n)


def oftener(one: tuple[int, int], other: tuple[int, int]) -> Verdict:
    """Whether one share (hits, count) lies above that of other trials: the two exact intervals joined by the square
    root of their squares (Newcombe 1998, method 10, with Clopper and Pearson's in place of Wilson's)."""
    (low, high), (least, most) = interval_95(*one), interval_95(*other)
    p, q = (hits / max(count, 1) for hits, count in (one, other))
    return above_zero(p - q - np.hypot(p - low, most - q), p - q + np.hypot(high - p, q - least), min(one[1], other[1]))


def over_learners_above_zero(values: FloatArray) -> Verdict:
    """Whether the mean of (S,) differences over learners lies above 0."""
    if len(values) < 2:
        return Verdict(None, -np.inf, np.inf, len(values))
    mean, half = over_learners(values)
    return above_zero(float(mean - half), float(mean + half), len(values))


@dataclass(frozen=True)
class Sweep:
    """How often R rules were right at K grades of a difficulty, for each of S learners."""

    label: str
    at: tuple[float, ...]
    rules: tuple[str, ...]
    right: FloatArray
    """(S, R, K)"""

    def beyond(self, other: str) -> FloatArray:
        """(3,) by how much the first rule is right more often than another, over all grades: mean and 95 % interval."""
        mean, half = over_learners((self.right[:, 0] - self.right[:, self.rules.index(other)]).mean(1))
        return np.asarray(mean + half * np.array([0.0, -1.0, 1.0]))

    def numbers(self) -> dict[str, Any]:
        """For metrics.json."""
        mean, half = over_learners(self.right)
        rules = {rule: {"right": mean[r], "half_95": half[r]} for r, rule in enumerate(self.rules)}
        others = self.rules[1:]
        verdicts = {rule: self.ahead(rule).numbers for rule in others}
        return {"at": self.at, **rules, "beyond": {rule: self.beyond(rule) for rule in others}, "ahead": verdicts}

    def ahead(self, other: str) -> Verdict:
        """Whether the first rule is right more often than another."""
        return over_learners_above_zero((self.right[:, 0] - self.right[:, self.rules.index(other)]).mean(1))

    def told(self) -> Iterator[tuple[str, str]]:
        """Every other rule, and by how many points the first is right more often, for a table."""
        for rule in self.rules[1:]:
            mean, low, high = 100 * self.beyond(rule)
            few = f", {self.ahead(rule).said}" if self.ahead(rule).holds is None else ""
            yield rule, f"{mean:+.1f} ({low:.1f} to {high:.1f}{few})"
