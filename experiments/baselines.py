"""What a practical person would try first: send the demonstrated angles to the servos."""

import numpy as np
from numpy.typing import NDArray

from imitation.movement import approach
from models.body import SimulatedBody


def direct_replay(body: SimulatedBody, angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """(T, J) joint angles reached when the next demonstrated angles (T, J) are commanded at every tick.

    It is told the wiring, and comes into the movement by the same approach as the imitator.
    """
    body.reset()
    way = approach(body.joint_angles[0], angles, body.tick_s)
    commands = np.concatenate([way, angles, 2 * angles[-1:] - angles[-2:-1]])
    reached = np.empty_like(angles)
    for t in range(len(commands) - 1):
        if t >= len(way):
            reached[t - len(way)] = body.joint_angles[0]
        body.act(np.tile(body.command_angles(commands[t + 1]), (body.copies, 1)))
    return reached


def rmse_deg(reached: NDArray[np.float64], wanted: NDArray[np.float64]) -> float:
    """Root mean square over all frames and joints, degrees."""
    return float(np.rad2deg(np.sqrt(np.mean((reached - wanted) ** 2))))
