"""What a practical person would try first: send the demonstrated angles to the servos."""

from collections.abc import Callable

import numpy as np

from babbling.axes import FloatArray
from imitation.acting.movement import approach
from models.body import SimulatedBody


def direct_replay(body: SimulatedBody, angles: FloatArray) -> FloatArray:
    """(T, J) joint angles reached when the next demonstrated angles (T, J) are commanded at every tick."""
    return replay_commands(body, angles, lambda whole: np.concatenate([whole[1:], 2 * whole[-1:] - whole[-2:-1]]))


def replay_commands(
    body: SimulatedBody,
    angles: FloatArray,
    commands_for: Callable[[FloatArray], FloatArray],
) -> FloatArray:
    """(T, J) joint angles reached by commands computed beforehand, without looking.

    It is told the wiring, and comes into the movement by the same approach as the imitator; `commands_for` sees the
    approach and the movement, (N, J), and gives the command to hold during each of those ticks.
    """
    body.reset()
    way = approach(body.joint_angles[0], angles, body.tick_s, *body.joint_range.T)
    commands = commands_for(np.concatenate([way, angles]))
    reached = np.empty_like(angles)
    for t, command in enumerate(commands):
        if t >= len(way):
            reached[t - len(way)] = body.joint_angles[0]
        body.act(np.tile(body.command_angles(command), (body.copies, 1)))
    return reached
