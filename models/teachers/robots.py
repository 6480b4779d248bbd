"""Robots as teachers, those of example-robot-data and HOAP-2: which file, and where joints and body parts are in it.

Only names are declared here; directions come from anatomy (models.teachers.anatomy), so link axes and zero postures
of a file do not matter. Meshes are not read.
"""

import sysconfig
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from models.errors import unknown
from models.hoap2 import ROBOT as HOAP2
from models.motion.trajectory import JointTrajectory
from models.teachers.anatomy import BodyPoses, upright
from models.teachers.performance import SIDES, TeacherError

Array = NDArray[np.float64]
DISTRIBUTION = "example-robot-data"


@dataclass(frozen=True)
class Robot:
    """A teacher's body as data.

    file: its URDF below example-robot-data's `robots` folder, or an MJCF of this project.
    torso, pelvis, head: the joints that carry them; "universe" for the root body.
    landmarks: shoulder, elbow, ... -> joint whose origin it is; {s} stands for the side in the URDF's spelling.
    left, right: that spelling.
    foot: the joint that carries the foot, likewise.
    """

    file: str
    torso: str
    pelvis: str
    head: str
    left: str
    right: str
    shoulder: str
    elbow: str
    wrist: str
    hip: str
    knee: str
    ankle: str
    foot: str


ROBOTS: dict[str, Robot] = {
    "icub": Robot(
        file="icub_description/robots/icub.urdf",
        torso="torso_yaw",
        pelvis="universe",
        head="neck_yaw",
        left="l",
        right="r",
        shoulder="{s}_shoulder_yaw",
        elbow="{s}_elbow",
        wrist="{s}_wrist_pitch",
        hip="{s}_hip_yaw",
        knee="{s}_knee",
        ankle="{s}_ankle_pitch",
        foot="{s}_ankle_roll",
    ),
    "romeo": Robot(
        file="romeo_description/urdf/romeo_small.urdf",
        torso="TrunkYaw",
        pelvis="universe",
        head="HeadRoll",
        left="L",
        right="R",
        shoulder="{s}ShoulderYaw",
        elbow="{s}ElbowRoll",
        wrist="{s}WristRoll",
        hip="{s}HipPitch",
        knee="{s}KneePitch",
        ankle="{s}AnklePitch",
        foot="{s}AnkleRoll",
    ),
    "human": Robot(
        file="human_description/robots/human.urdf",
        torso="middle_thoracic_Y",
        pelvis="universe",
        head="middle_cervical_Y",
        left="left",
        right="right",
        shoulder="{s}_shoulder_Z",
        elbow="{s}_elbow_Z",
        wrist="{s}_wrist_Z",
        hip="{s}_hip_Z",
        knee="{s}_knee_Z",
        ankle="{s}_ankle_Z",
        foot="{s}_ankle_X",
    ),
    "g1": Robot(
        file="g1_description/urdf/g1_29dof_rev_1_0.urdf",
        torso="waist_pitch_joint",
        pelvis="universe",
        head="waist_pitch_joint",
        left="left",
        right="right",
        shoulder="{s}_shoulder_roll_joint",
        elbow="{s}_elbow_joint",
        wrist="{s}_wrist_pitch_joint",
        hip="{s}_hip_roll_joint",
        knee="{s}_knee_joint",
        ankle="{s}_ankle_pitch_joint",
        foot="{s}_ankle_roll_joint",
    ),
    "talos": Robot(
        file="talos_data/robots/talos_reduced.urdf",
        torso="torso_2_joint",
        pelvis="universe",
        head="head_2_joint",
        left="left",
        right="right",
        shoulder="arm_{s}_3_joint",
        elbow="arm_{s}_4_joint",
        wrist="arm_{s}_5_joint",
        hip="leg_{s}_3_joint",
        knee="leg_{s}_4_joint",
        ankle="leg_{s}_5_joint",
        foot="leg_{s}_6_joint",
    ),
    "simple_humanoid": Robot(
        file="simple_humanoid_description/urdf/simple_humanoid.urdf",
        torso="CHEST",
        pelvis="universe",
        head="CHEST",
        left="L",
        right="R",
        shoulder="{s}ARM_SHOULDER_P",
        elbow="{s}ARM_ELBOW",
        wrist="{s}ARM_WRIST_P",
        hip="{s}LEG_HIP_P",
        knee="{s}LEG_KNEE",
        ankle="{s}LEG_ANKLE_P",
        foot="{s}LEG_ANKLE_R",
    ),
    "hoap2": Robot(
        file=str(HOAP2),
        torso="universe",
        pelvis="body_joint_1",
        head="head_joint_2",
        left="left",
        right="right",
        shoulder="{s}_arm_joint_3",
        elbow="{s}_arm_joint_4",
        wrist="{s}_arm_joint_5",
        hip="{s}_leg_joint_3",
        knee="{s}_leg_joint_4",
        ankle="{s}_leg_joint_6",
        foot="{s}_leg_joint_6",
    ),
}
"""Name -> robot. G1 and the simple humanoid have no neck: their heads are their chests."""


@cache
def load(name: str) -> pin.Model:
    """The robot as Pinocchio sees it: kinematics, masses, no meshes."""
    if name not in ROBOTS:
        raise TeacherError(unknown("teacher", name, ROBOTS))
    if ROBOTS[name].file.endswith(".xml"):
        return pin.buildModelFromMJCF(ROBOTS[name].file)
    path = folder() / ROBOTS[name].file
    if not path.is_file():
        raise TeacherError(f"{path}: no such file; install {DISTRIBUTION} 4.4 or newer again")
    return pin.buildModelFromUrdf(str(path))


@cache
def folder() -> Path:
    """The `robots` folder that the installed example-robot-data brought along."""
    places = [Path(sysconfig.get_paths()["purelib"])]
    try:
        places.insert(0, Path(str(metadata.distribution(DISTRIBUTION).locate_file(""))))
    except metadata.PackageNotFoundError:
        pass
    for place in places:
        robots = place / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
        if robots.is_dir():
            return robots
    raise TeacherError(f"{DISTRIBUTION} is not installed; install it with the project's other requirements")


def postures(name: str, trajectory: JointTrajectory) -> Array:
    """Configurations (T, nq) of a robot that moves like this; joints that are not named stay at zero."""
    model = load(name)
    found = np.tile(pin.neutral(model), (len(trajectory.time), 1))
    for joint, values in zip(trajectory.joints, trajectory.angles.T, strict=True):
        if joint not in list(model.names)[1:]:
            raise TeacherError(f"teacher {name}: {unknown('joint', joint, list(model.names)[1:])}")
        found[:, model.idx_qs[model.getJointId(joint)]] = values
    return found


def motion(name: str, configurations: Array, standing_on: str = "left") -> BodyPoses:
    """Poses of a robot's body parts through time, (T, nq) configurations, with one foot resting where it stands.

    The world's x is where the upright robot faces, z is up; its ankles stand at the origin. `standing_on` names the
    foot that stays put.
    """
    robot, model = ROBOTS[name], load(name)
    data = model.createData()
    spelling = dict(zip(SIDES, (robot.left, robot.right), strict=True))
    bodies = {"torso": robot.torso, "pelvis": robot.pelvis, "head": robot.head}
    landmarks = {}
    for side, letter in spelling.items():
        bodies[f"{side}_foot"] = robot.foot.format(s=letter)
        for landmark in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle"):
            landmarks[f"{side}_{landmark}"] = str(getattr(robot, landmark)).format(s=letter)
    ids = {part: model.getJointId(joint) for part, joint in (bodies | landmarks).items()}
    for part, number in ids.items():
        if number >= model.njoints:
            raise TeacherError(f"teacher {name}: the URDF has no joint {(bodies | landmarks)[part]!r} for {part}")
    anchor = ids[f"{standing_on}_foot"]
    pin.forwardKinematics(model, data, pin.neutral(model))
    ankles = np.mean([data.oMi[ids[f"{side}_ankle"]].translation for side in SIDES], axis=0)
    facing = upright({part: data.oMi[number].translation for part, number in ids.items()}).T
    stand = pin.SE3(facing, -facing @ ankles) * data.oMi[anchor]
    positions = {part: np.empty((len(configurations), 3)) for part in ids}
    rotations = {part: np.empty((len(configurations), 3, 3)) for part in bodies}
    for frame, configuration in enumerate(configurations):
        pin.forwardKinematics(model, data, configuration)
        root = stand * data.oMi[anchor].inverse()
        for part, number in ids.items():
            pose = root * data.oMi[number]
            positions[part][frame] = pose.translation
            if part in rotations:
                rotations[part][frame] = pose.rotation
    return BodyPoses(rotations, positions)


def reference(name: str) -> BodyPoses:
    """The robot standing upright: all joints at zero."""
    return motion(name, pin.neutral(load(name))[None])


def limits(name: str) -> dict[str, tuple[float, float]]:
    """Joint -> lowest and highest angle that a robot's file allows, radians."""
    model = load(name)
    return {
        joint: (float(model.lowerPositionLimit[place]), float(model.upperPositionLimit[place]))
        for joint, place in zip(list(model.names)[1:], list(model.idx_qs)[1:], strict=True)
    }
