"""Humans of the CMU motion capture database (mocap.cs.cmu.edu), through dm_control's model of that skeleton."""

import os
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.teachers.amc import read_amc, write_amc
from models.teachers.anatomy import BodyPoses, perform
from models.teachers.performance import SIDES, Performance

BODY_OF = {"torso": "thorax", "pelvis": "root", "head": "head", "left_foot": "lfoot", "right_foot": "rfoot"}
ENDS_AT = {"shoulder": "humerus", "elbow": "radius", "wrist": "wrist", "hip": "femur", "knee": "tibia", "ankle": "foot"}


def perform_amc(path: str | os.PathLike[str]) -> Performance:
    """What is seen of a human in an `.amc` file, at every frame of the capture (120 Hz).

    The file is checked line by line first (models.teachers.amc), so what dm_control reads is always whole.
    Frames are kept as captured: Euler angles jump by a turn now and then, and only limb directions, which do not,
    may be put between frames.
    """
    from dm_control.suite.utils import parse_amc  # takes a second to load

    frames = read_amc(path)
    physics = _human()
    with tempfile.TemporaryDirectory() as folder:
        clean = Path(folder) / "checked.amc"
        write_amc(frames, clean)
        converted = parse_amc.convert(str(clean), physics, parse_amc.MOCAP_DT)
    qpos = converted.qpos.T
    time = np.arange(len(qpos)) * parse_amc.MOCAP_DT
    upright = np.zeros((1, qpos.shape[1]))
    upright[0, 3:7] = np.sqrt(0.5), np.sqrt(0.5), 0, 0  # the skeleton is drawn with y up
    return perform(Path(path).stem, "human (CMU)", time, _poses(physics, qpos), _poses(physics, upright))


@cache
def _human() -> Any:
    """dm_control's human, its physics."""
    from dm_control.suite import humanoid_CMU

    return humanoid_CMU.stand().physics


def _poses(physics: Any, qpos: FloatArray) -> BodyPoses:
    model, data = physics.model.ptr, physics.data.ptr
    landmarks = {f"{side}_{name}": f"{side[0]}{bone}" for side in SIDES for name, bone in ENDS_AT.items()}
    bodies = {name: model.body(bone).id for name, bone in (BODY_OF | landmarks).items()}
    ids = list(bodies.values())
    positions = np.empty((len(qpos), len(ids), 3))
    rotations = np.empty((len(qpos), len(ids), 3, 3))
    for frame, posture in enumerate(qpos):
        data.qpos[:] = posture
        mujoco.mj_kinematics(model, data)
        positions[frame] = data.xpos[ids]
        rotations[frame] = data.xmat[ids].reshape(-1, 3, 3)
    return BodyPoses(
        {name: rotations[:, number] for number, name in enumerate(bodies) if name in BODY_OF},
        {name: positions[:, number] for number, name in enumerate(bodies)},
    )
