"""Steady seeing: what a direction seen with noise, or not seen for a while, most probably was (chapter, section 3.2).

Law, per part and coordinate: directions move with random jerk and are seen with white noise,

    y_t = x_t + e_t,  e ~ N(0, s^2),      x_t - 3 x_{t-1} + 3 x_{t-2} - x_{t-3} ~ N(0, s^2 / lambda)

The smoother is the posterior mean of x given all of y (a third-order Whittaker smoother, Whittaker 1923; the fixed
interval Kalman smoother of that model). The one unknown ratio lambda is chosen by the marginal likelihood of what was
seen (restricted maximum likelihood; Wahba 1985), so clean eyes lead to no smoothing at all and nobody has to say how
noisy they are. Frames in which a part was hidden carry no weight and are bridged.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.ndimage import distance_transform_edt

from babbling.axes import BoolArray, FloatArray
from imitation.errors import ImitationError

ORDER = 3
COARSE, FINE = np.arange(-4.0, 9.0), np.array([-0.5, 0.0, 0.5])
"""Powers of ten tried for lambda: a first round, and a second around the best."""
FREQUENCIES = np.linspace(0, 0.5, 200)
"""Cycles per frame, for the share of white noise that passes the smoother."""
SHARPEST = 1e-5
"""Seeing noise is not taken for less than this, rad: nothing was ever measured better."""
CALM = 1.0
"""Pull towards rest of what is hidden, against one unit of random jerk (lambda): a bridge does not swing out."""


class Steady(NamedTuple):
    """directions (T, 3) unit vectors; standard deviations per axis, rad: noise of the seeing, doubt that is left after
    smoothing; trust (T,) in 0 .. 1."""

    directions: FloatArray
    noise: float
    doubt: float
    trust: FloatArray


def steady(name: str, seen: FloatArray, visible: BoolArray) -> Steady:
    """Smooth (T, 3) directions of which only `visible` (T,) ones count.

    Raises:
        ImitationError: seen in fewer than four frames.
    """
    if len(seen) <= ORDER and visible.all():  # too short for any jerk: nothing to smooth
        return Steady(seen, 0.0, 0.0, np.ones(len(seen)))
    weight = visible.astype(float)
    if weight.sum() <= ORDER:
        raise ImitationError(f"{name}: seen in {int(weight.sum())} frames only; at least {ORDER + 1} are needed")
    y = np.where(visible[:, None], seen, 0.0)
    best = max(COARSE, key=lambda power: _smooth(y, weight, 10.0**power)[1])
    best = max(best + FINE, key=lambda power: _smooth(y, weight, 10.0**power)[1])
    smooth, _, variance = _smooth(y, weight, 10.0**best)
    length = np.linalg.norm(smooth, axis=1, keepdims=True)
    if (length < 0.05).any():
        raise ImitationError(f"{name}: hidden too long, or its direction turned round while it was; show it again")
    noise = float(np.sqrt(variance))
    left = np.mean(1 / (1 + 10.0**best * (2 * np.sin(np.pi * FREQUENCIES)) ** (2 * ORDER)))
    trust = 1 / (1 + distance_transform_edt(~visible))  # falls off with the frames to the nearest in which it was seen
    return Steady(smooth / length, noise, noise * float(np.sqrt(left)), trust)


def _smooth(y: FloatArray, weight: FloatArray, ratio: float) -> tuple[FloatArray, float, float]:
    """Posterior mean for one lambda, its restricted log likelihood, and the noise variance."""
    count = len(y)
    bands = third_gram(count) * ratio
    bands[0] += weight
    hidden = weight == 0
    if hidden.any():
        calm = CALM * ratio * (hidden[1:] | hidden[:-1])
        bands[0, 1:] += calm
        bands[0, :-1] += calm
        bands[1, :-1] -= calm
    factor = cholesky_banded(bands, lower=True)
    mean = cho_solve_banded((factor, True), weight[:, None] * y)
    free = weight.sum() - ORDER
    misfit = float((weight[:, None] * y * (y - mean)).sum()) / 3
    variance = max(misfit / free, SHARPEST**2)
    likelihood = -free * np.log(variance) - misfit / variance
    likelihood += (count - ORDER) * np.log(ratio) - 2 * np.log(factor[0]).sum()
    return mean, float(likelihood), variance


def third_gram(count: int) -> FloatArray:
    """D'D of the third differences D of `count` numbers, lower banded (4, count)."""
    bands = np.zeros((ORDER + 1, count))
    stencil = np.array([-1.0, 3.0, -3.0, 1.0])
    for first in range(ORDER + 1):
        for second in range(first, ORDER + 1):
            bands[second - first, first : max(count - ORDER, 0) + first] += stencil[first] * stencil[second]
    return bands
