"""Robots as teachers, those of example-robot-data and HOAP-2: which file, and what its joint names do not tell."""

import sysconfig
from dataclasses import dataclass, field
from functools import cache
from importlib import metadata
from pathlib import Path

import pinocchio as pin

from models.errors import unknown
from models.hoap2 import ROBOT as HOAP2
from models.teachers.performance import SIDES, TeacherError
from models.teachers.teacher import Teacher

DISTRIBUTION = "example-robot-data"


@dataclass(frozen=True)
class Robot:
    """A teacher's body as data.

    file: its URDF below example-robot-data's `robots` folder, or an MJCF of this project.
    told: landmark or body -> the joint to take where names and places would lead to another; {s} stands for the side
    in the URDF's spelling `sides`.
    """

    file: str
    told: dict[str, str] = field(default_factory=dict)
    sides: tuple[str, str] = SIDES

    def joints(self) -> dict[str, str]:
        """`told`, each side by itself."""
        both = {}
        for part, joint in self.told.items():
            if "{s}" not in joint:
                both[part] = joint
                continue
            both |= {f"{s}_{part}": joint.format(s=letter) for s, letter in zip(SIDES, self.sides, strict=True)}
        return both


ROBOTS: dict[str, Robot] = {
    "icub": Robot("icub_description/robots/icub.urdf", {"wrist": "{s}_wrist_pitch"}, ("l", "r")),
    "romeo": Robot("romeo_description/urdf/romeo_small.urdf", {"wrist": "{s}WristRoll"}, ("L", "R")),
    "human": Robot("human_description/robots/human.urdf", {"wrist": "{s}_wrist_Z"}),
    "g1": Robot(
        "g1_description/urdf/g1_29dof_rev_1_0.urdf", {"wrist": "{s}_wrist_pitch_joint", "head": "waist_pitch_joint"}
    ),
    "talos": Robot("talos_data/robots/talos_reduced.urdf"),
    "simple_humanoid": Robot(
        "simple_humanoid_description/urdf/simple_humanoid.urdf",
        {"wrist": "{s}ARM_WRIST_P", "head": "CHEST"},
        ("L", "R"),
    ),
    "hoap2": Robot(str(HOAP2), {"ankle": "{s}_leg_joint_6", "torso": "universe"}),
}
"""Name -> robot. G1 and the simple humanoid have no neck: their heads are their chests."""


@cache
def load(name: str) -> Teacher:
    """The robot as Pinocchio sees it: kinematics, masses, no meshes.

    Raises:
        TeacherError: an unknown name, or a file that is not installed.
    """
    if name not in ROBOTS:
        raise TeacherError(unknown("teacher", name, ROBOTS))
    robot = ROBOTS[name]
    if robot.file.endswith(".xml"):
        return Teacher.found(name, pin.buildModelFromMJCF(robot.file), robot.joints())
    path = folder() / robot.file
    if not path.is_file():
        raise TeacherError(f"{path}: no such file; install {DISTRIBUTION} 4.4 or newer again")
    return Teacher.found(name, pin.buildModelFromUrdf(str(path)), robot.joints())


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
