"""What is seen of a teacher: built-in demonstrations by minimum-jerk movements, robots that move, files."""

import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from models.arrays import FloatArray
from models.files import checked
from models.motion.trajectory import JointTrajectory
from models.teachers import robots
from models.teachers.anatomy import perform as show
from models.teachers.bvh import perform_bvh
from models.teachers.cmu import perform_amc
from models.teachers.demonstrations import DEMONSTRATIONS, find
from models.teachers.performance import Performance, TeacherError

RATE_HZ = 50.0
CAPTURES = {".amc": perform_amc, ".bvh": perform_bvh}
"""Motion capture -> what is seen of it."""


def perform(name_or_path: str | os.PathLike[str]) -> Performance:
    """What is seen of a teacher: the name of a built-in demonstration, or the path of an `.amc` or `.bvh` file."""
    if find(name_or_path) is not None:
        return perform_builtin(str(name_or_path))
    path = Path(name_or_path)
    if path.suffix.lower() in CAPTURES:
        return CAPTURES[path.suffix.lower()](path)
    checked(path)
    raise TeacherError(
        f"{path}: only {' and '.join(CAPTURES)} files show a teacher; joint trajectories are read by models.motion"
    )


def perform_builtin(name: str) -> Performance:
    """What is seen of a built-in demonstration, at RATE_HZ."""
    return perform_motion(DEMONSTRATIONS[name].robot, joint_motion(name), DEMONSTRATIONS[name].standing_on)


def joint_motion(name: str) -> JointTrajectory:
    """The teacher's own joint angles in a built-in demonstration, at RATE_HZ."""
    time, joints, angles = minimum_jerk(DEMONSTRATIONS[name].postures)
    return JointTrajectory(name, time, joints, angles)


def perform_motion(robot: str, trajectory: JointTrajectory, standing_on: str = "left") -> Performance:
    """What is seen of a robot of models.teachers.robots.ROBOTS that moves like this; joints not named stay at zero."""
    teacher = robots.load(robot)
    moving = teacher.motion(teacher.postures(trajectory), standing_on)
    return show(trajectory.name, robot, trajectory.time, moving, teacher.reference)


def minimum_jerk(
    postures: tuple[tuple[float, Mapping[str, float]], ...],
) -> tuple[FloatArray, tuple[str, ...], FloatArray]:
    """Times (T,) at RATE_HZ, joint names and angles (T, J) through the postures, resting in each for an instant.

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
    return time, tuple(joints), keys[leg] + way[:, None] * (keys[leg + 1] - keys[leg])
