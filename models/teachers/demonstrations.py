"""Built-in demonstrations as data, a few postures each: known without any robot being loaded."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from models.errors import unknown
from models.teachers.performance import SIDES, TeacherError


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


ICUB_RELAXED = {"l_shoulder_roll": 0.2, "r_shoulder_roll": 0.2, "l_elbow": 0.35, "r_elbow": 0.35}
ROMEO_RELAXED = {
    **{"LShoulderPitch": 1.5, "LShoulderYaw": 0.15, "LElbowRoll": -1.0, "LElbowYaw": -0.35},
    **{"RShoulderPitch": 1.5, "RShoulderYaw": -0.15, "RElbowRoll": 1.0, "RElbowYaw": 0.35},
}
HUMAN_RELAXED = {**{"left_shoulder_X": 0.12, "left_elbow_Z": 0.25}, **{"right_shoulder_X": 0.12, "right_elbow_Z": 0.25}}
G1_RELAXED = {
    **{"left_shoulder_roll_joint": 0.15, "left_elbow_joint": 1.2},
    **{"right_shoulder_roll_joint": -0.15, "right_elbow_joint": 1.2},
}
TALOS_RELAXED = {
    **{"arm_left_2_joint": 0.15, "arm_left_4_joint": -0.4},
    **{"arm_right_2_joint": -0.15, "arm_right_4_joint": -0.4},
}
SIMPLE_RELAXED = {**{"LARM_SHOULDER_R": 0.15, "LARM_ELBOW": -0.3}, **{"RARM_SHOULDER_R": -0.15, "RARM_ELBOW": -0.3}}


def _both(joints: Mapping[str, float], spellings: tuple[str, str]) -> dict[str, float]:
    """The same angles for a left and a right joint, {s} standing for the side."""
    return {joint.format(s=side): angle for joint, angle in joints.items() for side in spellings}


_G1_SQUAT = _both(
    {"{s}_hip_pitch_joint": -0.95, "{s}_knee_joint": 1.6, "{s}_ankle_pitch_joint": -0.65}
    | {"{s}_shoulder_pitch_joint": -1.4, "{s}_elbow_joint": 1.4},
    SIDES,
) | {"left_shoulder_roll_joint": 0.45, "right_shoulder_roll_joint": -0.45}
_G1_STAND = dict.fromkeys(_G1_SQUAT, 0.0) | _both({"{s}_shoulder_pitch_joint": -0.3, "{s}_elbow_joint": 0.6}, SIDES)

DEMONSTRATIONS: dict[str, Demonstration] = {
    "icub-wave": Demonstration(
        "iCub raises its right arm and waves",
        "icub",
        (
            (0.0, ICUB_RELAXED),
            (1.4, {"r_shoulder_pitch": -0.5, "r_shoulder_roll": 1.6, "r_shoulder_yaw": -0.4, "r_elbow": 1.4}),
            (1.8, {"r_elbow": 0.85, "neck_yaw": -0.4}),
            (2.2, {"r_elbow": 1.5}),
            (2.6, {"r_elbow": 0.85}),
            (3.0, {"r_elbow": 1.5}),
            (3.4, {"r_elbow": 0.85}),
            (3.8, {"r_elbow": 1.5}),
            (4.2, {"r_elbow": 1.1}),
            (5.6, {"r_shoulder_pitch": 0.0, "r_shoulder_yaw": 0.0, "neck_yaw": 0.0, **ICUB_RELAXED}),
        ),
    ),
    "icub-reach": Demonstration(
        "iCub bends forward, reaches out with its left hand and looks at it, then with both",
        "icub",
        (
            (0.0, ICUB_RELAXED),
            (0.5, {"neck_yaw": 0.35, "neck_pitch": -0.35}),
            (1.6, {"torso_pitch": 0.35, "l_shoulder_pitch": -1.1, "l_shoulder_roll": 0.3, "l_elbow": 0.6}),
            (2.2, {"l_shoulder_pitch": -1.4, "l_elbow": 0.2}),
            (3.4, {"neck_yaw": 0.0, "r_shoulder_pitch": -1.3, "r_shoulder_roll": 0.35, "r_elbow": 0.3}),
            (4.2, {"l_elbow": 1.3, "r_elbow": 1.3, "torso_pitch": 0.15}),
            (5.6, {"l_shoulder_pitch": 0.0, "r_shoulder_pitch": 0.0, "torso_pitch": 0.0, "neck_pitch": 0.0}),
            (6.2, ICUB_RELAXED),
        ),
    ),
    "romeo-bow": Demonstration(
        "Romeo bows from the hips with its right hand on its chest",
        "romeo",
        (
            (0.0, ROMEO_RELAXED),
            (1.2, {"RShoulderPitch": 1.1, "RShoulderYaw": -0.1, "RElbowRoll": 0.9, "RElbowYaw": 1.4}),
            (2.2, {"LHipPitch": -0.9, "RHipPitch": -0.9, "NeckPitch": 0.5, "LShoulderPitch": 1.7}),
            (2.8, {}),
            (4.0, {"LHipPitch": 0.0, "RHipPitch": 0.0, "NeckPitch": 0.0, "LShoulderPitch": 1.5}),
            (5.2, ROMEO_RELAXED),
        ),
    ),
    "human-raise": Demonstration(
        "a human raises both arms overhead, bends its elbows and lowers them",
        "human",
        (
            (0.0, HUMAN_RELAXED),
            (1.3, _both({"{s}_shoulder_Z": 1.5, "{s}_shoulder_X": 0.35, "{s}_elbow_Z": 0.4}, SIDES)),
            (2.2, _both({"{s}_shoulder_Z": 2.7, "{s}_elbow_Z": 0.2}, SIDES) | {"middle_cervical_Z": -0.25}),
            (2.8, _both({"{s}_elbow_Z": 1.2}, SIDES)),
            (3.4, _both({"{s}_elbow_Z": 0.2}, SIDES)),
            (4.2, _both({"{s}_shoulder_Z": 1.4, "{s}_shoulder_X": 0.6}, SIDES) | {"middle_cervical_Z": 0.0}),
            (5.4, _both({"{s}_shoulder_Z": 0.0}, SIDES) | HUMAN_RELAXED),
        ),
    ),
    "g1-squat": Demonstration(
        "G1 squats twice with its arms stretched forward, the second time fast",
        "g1",
        (
            (0.0, G1_RELAXED),
            (1.5, _G1_SQUAT),
            (2.7, _G1_STAND),
            (3.5, _G1_SQUAT),
            (4.3, _G1_STAND),
            (5.2, _both({"{s}_shoulder_pitch_joint": 0.0}, SIDES) | G1_RELAXED),
        ),
    ),
    "talos-salute": Demonstration(
        "Talos salutes with its right hand and turns its head",
        "talos",
        (
            (0.0, TALOS_RELAXED),
            (
                1.2,
                {"arm_right_1_joint": 0.3, "arm_right_2_joint": -1.4, "arm_right_3_joint": -0.9}
                | {"arm_right_4_joint": -2.1},
            ),
            (2.0, {"head_2_joint": 0.6}),
            (2.8, {"head_2_joint": -0.3, "head_1_joint": 0.2}),
            (3.2, {"head_2_joint": 0.0, "head_1_joint": 0.0}),
            (4.2, {"arm_right_1_joint": 0.0, "arm_right_3_joint": 0.0, **TALOS_RELAXED}),
        ),
    ),
    "simple-step": Demonstration(
        "the simple humanoid lifts its right knee, kicks, and swings its arms against it",
        "simple_humanoid",
        (
            (0.0, SIMPLE_RELAXED),
            (
                1.0,
                {"RLEG_HIP_P": -1.0, "RLEG_KNEE": 1.4, "RLEG_ANKLE_P": 0.2}
                | {"LARM_SHOULDER_P": -0.9, "LARM_ELBOW": -1.1, "RARM_SHOULDER_P": 0.5},
            ),
            (1.5, {"RLEG_HIP_P": -1.1, "RLEG_KNEE": 0.3}),
            (2.0, {"RLEG_HIP_P": -0.9, "RLEG_KNEE": 1.5}),
            (
                3.0,
                {"RLEG_HIP_P": 0.3, "RLEG_KNEE": 0.5, "RLEG_ANKLE_P": 0.3, "WAIST_P": 0.25}
                | {"LARM_SHOULDER_P": 0.4, "LARM_ELBOW": -0.3, "RARM_SHOULDER_P": -0.9, "RARM_ELBOW": -1.1},
            ),
            (
                4.2,
                {"RLEG_HIP_P": 0.0, "RLEG_KNEE": 0.0, "RLEG_ANKLE_P": 0.0, "WAIST_P": 0.0}
                | {"LARM_SHOULDER_P": 0.0, "RARM_SHOULDER_P": 0.0}
                | SIMPLE_RELAXED,
            ),
        ),
    ),
}
"""Name -> demonstration."""


def find(name_or_path: str | os.PathLike[str]) -> Demonstration | None:
    """The built-in demonstration of this name; None for what looks like a path.

    Raises:
        TeacherError: neither.
    """
    name, path = str(name_or_path), Path(name_or_path)
    if name not in DEMONSTRATIONS and not (path.suffix or len(path.parts) > 1 or os.path.exists(path)):
        raise TeacherError(unknown("demonstration", name, DEMONSTRATIONS) + ", or the path of an .amc or .bvh file")
    return DEMONSTRATIONS.get(name)
