"""The Kalman filter and its smoother: exact beliefs about a hidden linear-Gaussian state.

    s_t = F s_{t-1} + w,   w ~ N(0, Q)          n numbers that matter (chapter 3.2: the state s_t)
    z_t = H s_t + v,       v ~ N(0, R)          m numbers that are measured (the input I_t)

Every array may carry leading batch dimensions `...` that broadcast: many independent filters (joints, features) at
once. A measurement may be missing, wholly or number by number: `observed` says what was there; nothing is NaN.
R. E. Kalman (1960); the smoother is that of Rauch, Tung and Striebel (1965).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray
from imitation.errors import ImitationError


class System(NamedTuple):
    """A linear-Gaussian system."""

    transition: FloatArray
    """F (..., n, n)."""
    process_noise: FloatArray
    """Q (..., n, n)."""
    observation: FloatArray
    """H (..., m, n)."""
    observation_noise: FloatArray
    """R (..., m, m)."""


class Belief(NamedTuple):
    """N(mean, covariance) over the state: all that the next step needs."""

    mean: FloatArray
    """E[s_t | z_1..t] (..., n)."""
    covariance: FloatArray
    """Cov[s_t | z_1..t] (..., n, n)."""


class UpdateInfo(NamedTuple):
    """What a measurement said, for those who look on."""

    innovation: FloatArray
    """z - H mean (..., m); 0 where nothing was observed."""
    innovation_covariance: FloatArray
    """S = H P H' + R (..., m, m); rows and columns of missing numbers are those of the identity."""
    gain: FloatArray
    """K = P H' S^-1 (..., n, m); 0 for missing numbers."""
    log_likelihood: FloatArray
    """log p(z_t | z_1..t-1) (...); 0 when nothing was observed."""
    surprise: FloatArray
    """Squared Mahalanobis distance of the innovation (...), chi-square with as many degrees as numbers observed."""


class Filtered(NamedTuple):
    """A whole sequence, T steps, time first."""

    mean: FloatArray
    """E[s_t | z_1..t] (T, ..., n)."""
    covariance: FloatArray
    """(T, ..., n, n)."""
    predicted_mean: FloatArray
    """E[s_t | z_1..t-1] (T, ..., n)."""
    predicted_covariance: FloatArray
    """(T, ..., n, n)."""

    @classmethod
    def of(cls, beliefs: Sequence[Belief], predictions: Sequence[Belief]) -> "Filtered":
        """From the beliefs after each measurement, and those before it."""
        columns = [column for kind in (beliefs, predictions) for column in zip(*kind, strict=True)]
        return cls(*map(np.stack, columns))


class Smoothed(NamedTuple):
    """Beliefs that know the future as well."""

    mean: FloatArray
    """E[s_t | z_1..T] (T, ..., n)."""
    covariance: FloatArray
    """(T, ..., n, n)."""


def constant_velocity(dt: float, *, acceleration: float, noise: float, axes: int = 2) -> System:
    """`axes` positions that keep their velocity but for white acceleration; state (positions, velocities), n = 2 axes.

    `acceleration` is the standard deviation of the acceleration held during each step (unit/s^2), `noise` that of
    measured positions (unit).
    """
    one, zero = np.eye(axes), np.zeros((axes, axes))
    push = np.vstack([0.5 * dt**2 * one, dt * one])
    transition = np.block([[one, dt * one], [zero, one]])
    return System(transition, acceleration**2 * push @ push.T, np.hstack([one, zero]), one * noise**2)


def predict(system: System, belief: Belief, push: FloatArray | None = None) -> Belief:
    """One step ahead: mean F m (+ a known `push` (..., n), such as a command's effect), covariance F P F' + Q."""
    mean = _apply(system.transition, belief.mean)
    if push is not None:
        mean = mean + push
    covariance = system.transition @ belief.covariance @ _transpose(system.transition) + system.process_noise
    return Belief(mean, covariance)


def update(
    system: System, belief: Belief, measured: FloatArray, observed: bool | BoolArray = True
) -> tuple[Belief, UpdateInfo]:
    """The belief after a measurement (..., m).

    `observed` broadcasts to (..., m): which of the numbers were measured at all (the others are ignored). The
    covariance is updated in Joseph's form, (1 - K H) P (1 - K H)' + K R K', which stays symmetric and positive.

    Raises:
        ImitationError: a number that was observed is not finite, or S is not positive definite.
    """
    measured = np.asarray(measured, float)
    there = np.broadcast_to(np.asarray(observed, bool), measured.shape)
    if not np.isfinite(measured[there]).all():
        raise ImitationError("an observed measurement is not finite; mark what is missing in `observed` instead")
    pattern = there[..., :, None] & there[..., None, :]
    sensor = np.where(there[..., :, None], system.observation, 0.0)
    expected = _apply(system.observation, belief.mean)
    innovation = np.where(there, np.where(there, measured, 0.0) - expected, 0.0)
    cross = belief.covariance @ _transpose(sensor)
    spread = sensor @ cross + np.where(pattern, system.observation_noise, np.eye(measured.shape[-1]))
    try:
        root = np.linalg.cholesky(spread)
    except np.linalg.LinAlgError:
        raise ImitationError(
            "the innovation covariance is not positive definite; observation_noise needs a positive variance for "
            "every number that the state alone fixes"
        ) from None
    gain = _transpose(np.asarray(np.linalg.solve(spread, _transpose(cross)), float))
    rest = np.eye(belief.mean.shape[-1]) - gain @ sensor
    noise = gain @ np.where(pattern, system.observation_noise, 0.0) @ _transpose(gain)
    covariance = rest @ belief.covariance @ _transpose(rest) + noise
    surprise = np.sum(np.linalg.solve(root, innovation[..., None])[..., 0] ** 2, axis=-1)
    log_det = 2.0 * np.sum(np.log(np.diagonal(root, axis1=-2, axis2=-1)), axis=-1)
    log_likelihood = -0.5 * (surprise + log_det + there.sum(axis=-1) * np.log(2.0 * np.pi))
    mean = belief.mean + _apply(gain, innovation)
    return Belief(mean, covariance), UpdateInfo(innovation, spread, gain, log_likelihood, surprise)


def smooth(system: System, filtered: Filtered) -> Smoothed:
    """The Rauch-Tung-Striebel pass backwards: C = P_t F' P_{t+1|t}^-1, m_t += C (m^s_{t+1} - m_{t+1|t}), and so on."""
    mean, covariance = filtered.mean.copy(), filtered.covariance.copy()
    for step in range(len(mean) - 2, -1, -1):
        ahead = filtered.predicted_covariance[step + 1]
        back = _transpose(np.linalg.solve(ahead, system.transition @ covariance[step]))
        mean[step] += _apply(back, mean[step + 1] - filtered.predicted_mean[step + 1])
        covariance[step] += back @ (covariance[step + 1] - ahead) @ _transpose(back)
    return Smoothed(mean, covariance)


def _apply(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _transpose(matrix: FloatArray) -> FloatArray:
    return np.swapaxes(matrix, -1, -2)
