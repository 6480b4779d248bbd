"""How good something was: errors, learning curves, calibration, intervals; for those who judge."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import binomtest

from babbling.axes import BoolArray, FloatArray


@dataclass(frozen=True)
class LearningCurve:
    """Prediction error of held-out experience against body time, in the unit of whoever drew it."""

    minutes: FloatArray
    table: FloatArray
    """Of the forward model."""
    line: FloatArray
    """Of a line fitted to the same experience."""


def rmse_deg(reached: FloatArray, wanted: FloatArray) -> float:
    """Root mean square over all frames and joints, degrees; where what was wanted is NaN is left out."""
    away = (reached - wanted)[np.isfinite(wanted)]
    return float(np.rad2deg(np.sqrt(np.mean(away**2))))


def ringing_deg(error: FloatArray) -> FloatArray:
    """(J,) how far an error e (T, J), rad, shakes from tick to tick, peak to peak as a sine wave of its strength:
    2 sqrt(2) RMS(second difference of e / 4). Slow errors hardly count."""
    return np.asarray(2 * np.sqrt(2 * np.mean((np.diff(np.rad2deg(error), 2, axis=0) / 4) ** 2, axis=0)))


def interval_95(hits: int, count: int) -> tuple[float, float]:
    """Exact 95 % interval of a share (Clopper and Pearson 1934)."""
    found = binomtest(hits, count).proportion_ci(0.95, "exact")
    return float(found.low), float(found.high)


def calibration_error(confidence: FloatArray, right: BoolArray, bins: int = 10) -> tuple[float, FloatArray]:
    """Expected calibration error sum_b n_b/N |accuracy_b - confidence_b|, and (bins, 3) confidence, accuracy, count."""
    index = np.minimum((confidence * bins).astype(int), bins - 1)
    rows = np.zeros((bins, 3))
    for b in range(bins):
        mine = index == b
        if mine.any():
            rows[b] = confidence[mine].mean(), right[mine].mean(), mine.sum()
    error = float((rows[:, 2] * np.abs(rows[:, 0] - rows[:, 1])).sum() / len(confidence))
    return error, rows
