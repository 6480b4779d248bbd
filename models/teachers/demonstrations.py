"""Built-in demonstrations: a few postures each, and the minimum-jerk movement through them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from models.teachers import robots
from models.teachers.anatomy import perform
from models.teachers.performance import Performance

Array = NDArray[np.float64]
RATE_HZ = 50.0


@dataclass(frozen=True)
class Demonstration:
    """Postures of a robot and when it is in each.

    robot: a name of models.teachers.robots.ROBOTS. postures: (seconds, joint -> radians) in order, the first at 0;
    joints that a posture does not name keep their angle from the one before, zero at first.
    standing_on: the foot that stays where it is. about: one line for people.
    """

    about: str
    robot: str
    postures: tuple[tuple[float, Mapping[str, float]], ...]
    standing_on: str = "left"


ICUB_HANGING = {"l_shoulder_roll": 0.15, "r_shoulder_roll": 0.15, "l_elbow": 0.3, "r_elbow": 0.3}

DEMONSTRATIONS: dict[str, Demonstration] = {
    "icub-wave": Demonstration(
        "iCub raises its right arm and waves four times",
        "icub",
        (
            (0.0, ICUB_HANGING),
            (1.3, {"r_shoulder_pitch": -0.5, "r_shoulder_roll": 1.6, "r_shoulder_yaw": 0.2, "r_elbow": 1.4}),
            (1.7, {"r_elbow": 0.75, "neck_yaw": -0.3}),
            (2.1, {"r_elbow": 1.6}),
            (2.5, {"r_elbow": 0.75}),
            (2.9, {"r_elbow": 1.6}),
            (3.3, {"r_elbow": 0.75}),
            (3.7, {"r_elbow": 1.6}),
            (4.2, {"r_elbow": 1.0}),
            (5.4, {"r_shoulder_pitch": 0.0, "neck_yaw": 0.0, "r_shoulder_yaw": 0.0, **ICUB_HANGING}),
        ),
    ),
}
"""Name -> demonstration."""


def perform_builtin(name: str) -> Performance:
    """What is seen of a built-in demonstration, at RATE_HZ."""
    demonstration = DEMONSTRATIONS[name]
    time, angles = minimum_jerk(demonstration.postures)
    configurations = robots.postures(demonstration.robot, angles)
    moving = robots.motion(demonstration.robot, configurations, demonstration.standing_on)
    return perform(name, demonstration.robot, time, moving, robots.reference(demonstration.robot))


def minimum_jerk(postures: tuple[tuple[float, Mapping[str, float]], ...]) -> tuple[Array, dict[str, Array]]:
    """Times (T,) at RATE_HZ and joint -> angles (T,) through the postures, resting in each for an instant.

    Between two postures the share of the way gone is 10 s^3 - 15 s^4 + 6 s^5 (Flash and Hogan 1985).
    """
    moments = np.array([moment for moment, _ in postures])
    joints = sorted({joint for _, posture in postures for joint in posture})
    keys = np.zeros((len(postures), len(joints)))
    for number, (_, posture) in enumerate(postures):
        keys[number] = keys[number - 1] if number else 0
        for joint, angle in posture.items():
            keys[number, joints.index(joint)] = angle
    time = np.arange(round(moments[-1] * RATE_HZ) + 1) / RATE_HZ
    leg = np.clip(np.searchsorted(moments, time, side="right") - 1, 0, len(moments) - 2)
    share = np.clip((time - moments[leg]) / (moments[leg + 1] - moments[leg]), 0, 1)
    way = share**3 * (10 - 15 * share + 6 * share**2)
    angles = keys[leg] + way[:, None] * (keys[leg + 1] - keys[leg])
    return time, {joint: angles[:, number] for number, joint in enumerate(joints)}


def limits(robot: str) -> dict[str, tuple[float, float]]:
    """Joint -> lowest and highest angle a robot's URDF allows, radians."""
    model: pin.Model = robots.load(robot)
    return {
        name: (float(model.lowerPositionLimit[place]), float(model.upperPositionLimit[place]))
        for name, place in zip(list(model.names)[1:], list(model.idx_qs)[1:], strict=True)
    }
