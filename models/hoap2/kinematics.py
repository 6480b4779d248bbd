"""Where HOAP-2's body parts point at given joint angles, by Pinocchio's forward kinematics of hoap2.xml."""

from functools import cache

import numpy as np
import pinocchio as pin

from models.arrays import FloatArray
from models.hoap2 import ROBOT
from models.hoap2.facts import JOINTS
from models.hoap2.limbs import SEGMENTS


@cache
def robot() -> pin.Model:
    """HOAP-2 as Pinocchio sees it, hung by its torso: the world frame is the torso's frame."""
    model = pin.buildModelFromMJCF(str(ROBOT))
    others = [number for number, name in enumerate(model.names) if number and name not in JOINTS]
    return pin.buildReducedModel(model, others, pin.neutral(model)) if others else model


def ranges() -> tuple[FloatArray, FloatArray]:
    """(25,) lowest and highest joint angles, radians."""
    model = robot()
    return np.array(model.lowerPositionLimit), np.array(model.upperPositionLimit)


def directions(angles: FloatArray) -> FloatArray:
    """(T, P, 3) unit vectors of SEGMENTS' parts in the torso's frame, at (T, 25) angles in the order of JOINTS."""
    model = robot()
    data = model.createData()
    carriers = [(model.getJointId(segment.joint), np.array(segment.axis)) for segment in SEGMENTS.values()]
    found = np.empty((len(angles), len(carriers), 3))
    for frame, posture in enumerate(angles):
        pin.forwardKinematics(model, data, posture)
        for number, (joint, axis) in enumerate(carriers):
            found[frame, number] = data.oMi[joint].rotation @ axis
    return found
