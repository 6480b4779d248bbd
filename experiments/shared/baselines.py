"""What a practical person would try first: send the demonstrated angles to the servos."""

import numpy as np

from babbling.axes import FloatArray
from imitation.acting.movement import approach
from models.body import SimulatedBody


def direct_replay(body: SimulatedBody, angles: FloatArray) -> FloatArray:
    """(T, J) joint angles reached when the next demonstrated angles (T, J) are commanded at every tick.

    It is told the wiring, and comes into the movement by the same approach as the imitator.
    """
    body.reset()
    way = approach(body.joint_angles[0], angles, body.tick_s, *body.joint_range.T)
    ahead = np.concatenate([way, angles, 2 * angles[-1:] - angles[-2:-1]])[1:]
    reached = np.empty_like(angles)
    for t, command in enumerate(ahead, -len(way)):
        if t >= 0:
            reached[t] = body.joint_angles[0]
        body.act(np.tile(body.command_angles(command), (body.copies, 1)))
    return reached
