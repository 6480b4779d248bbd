"""How good something was: errors, learning curves, calibration, intervals; for those who judge."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class LearningCurve:
    """Prediction error of held-out experience against body time, in the unit of whoever drew it."""

    minutes: FloatArray
    table: FloatArray
    """Of the forward model."""
    line: FloatArray
    """Of a line fitted to the same experience."""
    unit: str = "deg"


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


def interval_95(hits: int, count: int) -> tuple[float, float]:
    """Exact 95 % interval of a share (Clopper and Pearson 1934)."""
    from scipy.stats import binomtest  # takes half a second to load

    found = binomtest(hits, count).proportion_ci(0.95, "exact")
    return float(found.low), float(found.high)


def intervals_95(right: BoolArray) -> list[tuple[float, float]]:
    """The same of every column of (N, K)."""
    return [interval_95(int(hits), len(right)) for hits in right.sum(0)]


def calibration_error(confidence: FloatArray, right: BoolArray, bins: int = 10) -> tuple[float, FloatArray]:
    """Expected calibration error sum_b n_b/N |accuracy_b - confidence_b|, and (bins, 3) confidence, accuracy, count."""
    index = np.minimum((confidence * bins).astype(int), bins - 1)
    count = np.bincount(index, minlength=bins)
    sure, hits = (np.bincount(index, each, bins) / np.maximum(count, 1) for each in (confidence, right))
    return float(np.average(np.abs(sure - hits), weights=count)), np.stack([sure, hits, count], 1)


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
        return {"at": self.at, **rules, "beyond": {rule: self.beyond(rule) for rule in self.rules[1:]}}


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
