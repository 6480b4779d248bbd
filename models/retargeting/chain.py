"""Limb directions of HOAP-2 as functions of its joint angles, for many frames at once.

The body is the one Pinocchio reads from hoap2.xml. `directions` asks Pinocchio itself, frame by frame; a `Chain` takes
the same joint placements and axes and multiplies them out for all frames together, with their derivatives, which is
what inverse kinematics over whole movements needs. Tests hold the two against each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from models.hoap2 import ROBOT
from models.hoap2.facts import JOINTS
from models.hoap2.limbs import LIMBS, Segment
from models.motion.trajectory import JointTrajectory

Array = NDArray[np.float64]


@cache
def robot() -> pin.Model:
    """HOAP-2 as Pinocchio sees it, hung by its torso: the world frame is the torso's frame."""
    model = pin.buildModelFromMJCF(str(ROBOT))
    others = [number for number, name in enumerate(model.names) if number and name not in JOINTS]
    return pin.buildReducedModel(model, others, pin.neutral(model)) if others else model


def joints() -> tuple[str, ...]:
    """The 25 joint names in the order of the robot's file."""
    return tuple(robot().names)[1:]


def ranges() -> dict[str, tuple[float, float]]:
    """Joint -> lowest and highest angle, radians."""
    model = robot()
    return dict(zip(joints(), zip(model.lowerPositionLimit, model.upperPositionLimit, strict=True), strict=True))


def hoap2_directions(trajectory: JointTrajectory) -> dict[str, Array]:
    """Body part -> (T, 3) direction in the torso's frame, when HOAP-2 moves like `trajectory` (all 25 joints)."""
    model = robot()
    data = model.createData()
    segments = [segment for limb in LIMBS.values() for segment in limb.segments]
    bodies = [(number, model.getJointId(part.joint), np.array(part.axis)) for number, part in enumerate(segments)]
    found = np.empty((len(segments), len(trajectory.time), 3))
    for frame, posture in enumerate(trajectory.reordered(joints()).angles):
        pin.forwardKinematics(model, data, posture)
        for number, joint, axis in bodies:
            found[number, frame] = data.oMi[joint].rotation @ axis
    return {segment.part: found[number] for number, segment in enumerate(segments)}


@dataclass(frozen=True, eq=False)
class Chain:
    """One limb, from the body it hangs from outwards.

    placements (n, 3, 3): rotation of each joint's frame in the one before, at zero.
    axes (n, 3): unit axis of each joint in its own frame.
    carriers (S,): which joint carries each segment; vectors (S, 3): its direction in that joint's frame.
    low, high (n,): joint range, radians.
    """

    placements: Array
    axes: Array
    carriers: tuple[int, ...]
    vectors: Array
    low: Array
    high: Array

    def directions(self, angles: Array) -> tuple[Array, Array]:
        """Directions (T, S, 3) in the frame the limb hangs from, and their derivatives (T, S, 3, n), at (T, n)."""
        count, joints = angles.shape
        found = np.empty((count, len(self.carriers), 3))
        slope = np.zeros((count, len(self.carriers), 3, joints))
        pose = np.broadcast_to(np.eye(3), (count, 3, 3))
        turning = np.empty((count, joints, 3))
        for joint in range(joints):
            pose = pose @ self.placements[joint]
            turning[:, joint] = pose @ self.axes[joint]
            pose = pose @ rotations(self.axes[joint], angles[:, joint])
            for segment, carrier in enumerate(self.carriers):
                if carrier == joint:
                    found[:, segment] = pose @ self.vectors[segment]
                    moved = np.cross(turning[:, : joint + 1], found[:, segment, None])
                    slope[:, segment, :, : joint + 1] = moved.swapaxes(1, 2)
        return found, slope


def chain(joints: Sequence[str], segments: Sequence[Segment], margin: float = 0.0) -> Chain:
    """The chain of these joints and segments, out of Pinocchio's model; `margin` radians stay free at each stop."""
    model = robot()
    ids = [model.getJointId(name) for name in joints]
    places = [model.idx_qs[joint] for joint in ids]
    return Chain(
        np.array([model.jointPlacements[joint].rotation for joint in ids]),
        np.array([model.joints[joint].createData().S[3:] for joint in ids]).reshape(-1, 3),
        tuple(joints.index(segment.joint) for segment in segments),
        np.array([segment.axis for segment in segments], dtype=float),
        model.lowerPositionLimit[places] + margin,
        model.upperPositionLimit[places] - margin,
    )


def pose(joint: str, angles: Array) -> Array:
    """Rotations (T, 3, 3) in the torso's frame of the body that `joint`, one of those on the torso, turns."""
    model = robot()
    number = model.getJointId(joint)
    axis = np.asarray(model.joints[number].createData().S[3:]).ravel()
    return np.asarray(model.jointPlacements[number].rotation @ rotations(axis, angles))


def rotations(axis: Array, angles: Array) -> Array:
    """Rotation matrices (T, 3, 3) about one unit axis by (T,) radians (Rodrigues' formula)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sine, cosine = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    return np.asarray(np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross))
