"""The run profile of a pan-tilt unit: how fast a commanded axis may move and how fast it may change its mind."""

import numpy as np
import numpy.typing as npt

from models.arrays import FloatArray


def profile(
    position: npt.ArrayLike,
    velocity: npt.ArrayLike,
    target: npt.ArrayLike,
    max_speed: npt.ArrayLike,
    max_acceleration: npt.ArrayLike,
    dt: float,
) -> tuple[FloatArray, FloatArray]:
    """One step of `dt` seconds of a trapezoidal move towards `target`: new position and velocity of the set-point.

    The axis speeds up at `max_acceleration` a until `max_speed` v, and brakes at a so as to stop on the target: a move
    of length D from rest lasts D/v + v/a when D >= v^2/a (a trapezoid) and 2 sqrt(D/a) otherwise (a triangle), to
    within two steps. In units of a dt and a dt^2: from a distance x the speed u = x/n + (n - 1)/2 lands in n steps
    that lose 1 each, n the least with x <= n (n + 1)/2. The target may change at any time; then a too fast axis
    overshoots and comes back, as a real one does. All arguments broadcast; angles in radians or metres alike.
    """
    position, velocity, acceleration = (np.asarray(x, float) for x in (position, velocity, max_acceleration))
    error = np.asarray(target, float) - position
    distance = np.abs(error) / (acceleration * dt**2)
    steps = np.maximum(np.ceil(0.5 * (np.sqrt(1.0 + 8.0 * distance) - 1.0)), 1.0)
    landing = (distance / steps + 0.5 * (steps - 1.0)) * acceleration * dt
    wanted = np.copysign(np.minimum(landing, max_speed), error)
    change = acceleration * dt
    new_velocity = np.clip(wanted, velocity - change, velocity + change)
    return position + new_velocity * dt, new_velocity
