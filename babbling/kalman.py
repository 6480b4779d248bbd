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
from babbling.errors import BabblingError


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
    """N(mean, covariance) over the state: all that the next step needs; or of a whole sequence, time first."""

    mean: FloatArray
    """E[s_t | z_1..t] (..., n)."""
    covariance: FloatArray
    """Cov[s_t | z_1..t] (..., n, n)."""

    @classmethod
    def stacked(cls, beliefs: Sequence["Belief"]) -> "Belief":
        """(T, ..., n) and (T, ..., n, n) of T beliefs, one after the other."""
        return cls(*map(np.stack, zip(*beliefs, strict=True)))


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
    covariance = system.transition @ belief.covariance @ system.transition.mT + system.process_noise
    return Belief(mean, covariance)


def update(
    system: System, belief: Belief, measured: FloatArray, observed: bool | BoolArray = True
) -> tuple[Belief, FloatArray]:
    """The belief after a measurement (..., m), and the gain K = P H' S^-1 (..., n, m), 0 for missing numbers.

    `observed` broadcasts to (..., m): which of the numbers were measured at all (the others are ignored). The
    covariance is updated in Joseph's form, (1 - K H) P (1 - K H)' + K R K', which stays symmetric and positive.

    Raises:
        BabblingError: a number that was observed is not finite, or S is not positive definite.
    """
    measured = np.asarray(measured, float)
    there = np.broadcast_to(np.asarray(observed, bool), measured.shape)
    if not np.isfinite(measured[there]).all():
        raise BabblingError("an observed measurement is not finite; mark what is missing in `observed` instead")
    sensor, sensed = system.observation, system.observation_noise
    innovation = np.where(there, measured, 0.0) - _apply(sensor, belief.mean)
    missing = np.zeros(())
    if not there.all():  # otherwise what is believed alike stays alike, and is worked out once
        pattern = there[..., :, None] & there[..., None, :]
        sensor, sensed = np.where(there[..., :, None], sensor, 0.0), np.where(pattern, sensed, 0.0)
        innovation, missing = np.where(there, innovation, 0.0), np.where(pattern, 0.0, np.eye(measured.shape[-1]))
    cross = belief.covariance @ sensor.mT
    spread = sensor @ cross + sensed + missing
    try:
        np.linalg.cholesky(spread)
    except np.linalg.LinAlgError:
        raise BabblingError(
            "the innovation covariance is not positive definite; observation_noise needs a positive variance for "
            "every number that the state alone fixes"
        ) from None
    gain = np.asarray(np.linalg.solve(spread, cross.mT), float).mT
    rest = np.eye(belief.mean.shape[-1]) - gain @ sensor
    noise = gain @ sensed @ gain.mT
    covariance = rest @ belief.covariance @ rest.mT + noise
    return Belief(belief.mean + _apply(gain, innovation), covariance), gain


def smooth(system: System, filtered: Belief, predicted: Belief) -> Belief:
    """Beliefs that know the future as well, from those after (T, ...) measurements and those before them.

    The Rauch-Tung-Striebel pass backwards: C = P_t F' P_{t+1|t}^-1, m_t += C (m^s_{t+1} - m_{t+1|t}), and so on.
    """
    mean, covariance = filtered.mean.copy(), filtered.covariance.copy()
    for step in range(len(mean) - 2, -1, -1):
        ahead = predicted.covariance[step + 1]
        back = np.linalg.solve(ahead, system.transition @ covariance[step]).mT
        mean[step] += _apply(back, mean[step + 1] - predicted.mean[step + 1])
        covariance[step] += back @ (covariance[step + 1] - ahead) @ back.mT
    return Belief(mean, covariance)


def _apply(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    return np.asarray((matrix @ vector[..., None])[..., 0])
