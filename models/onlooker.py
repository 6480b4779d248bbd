"""A stage as an onlooker sees it: parts that move, balls where they hang, and where everybody's gaze goes."""

from collections.abc import Mapping
from typing import NamedTuple

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.biclops.room import TEACHER
from models.robots import head_of
from models.servos import resting
from models.shapes import Part, parts

_SCENERY = ("front_wall", "back_wall", "left_wall", "right_wall", "floor")


class Onlooked(NamedTuple):
    """T moments of a stage."""

    parts: list[Part]
    gaze: tuple[FloatArray, FloatArray]
    """(T, 3) middle between our eyes and (T, 3) where they look, on average."""
    teacher_gaze: tuple[FloatArray, FloatArray] | None
    """The same of the teacher's."""


def onlook(
    model: mujoco.MjModel, robot: str, angles: FloatArray, teacher: FloatArray | None, balls: Mapping[str, FloatArray]
) -> Onlooked:
    """A stage through (T, 2) postures of the head and the teacher's; balls at (3,) or (T, 3), in the table's frame."""
    facts = head_of(robot)
    qpos = np.tile(resting(model), (len(angles), 1))
    qpos[:, _columns(model, facts.motors)] = angles
    if teacher is not None:
        qpos[:, _columns(model, (f"{TEACHER}pan", f"{TEACHER}tilt"))] = teacher
    hung = {name: place + np.array(facts.table) for name, place in balls.items()}
    return Onlooked(
        parts(model, qpos, _SCENERY, hung),
        _gazes(model, qpos, facts.eyes),
        None if teacher is None else _gazes(model, qpos, (TEACHER + "left_eye", TEACHER + "right_eye")),
    )


def _columns(model: mujoco.MjModel, joints: tuple[str, str]) -> list[int]:
    return [int(model.joint(joint).qposadr[0]) for joint in joints]


def _gazes(model: mujoco.MjModel, qpos: FloatArray, cameras: tuple[str, str]) -> tuple[FloatArray, FloatArray]:
    data = mujoco.MjData(model)
    starts, ways = np.empty((len(qpos), 3)), np.empty((len(qpos), 3))
    ids = [model.camera(name).id for name in cameras]
    for t, q in enumerate(qpos):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)
        starts[t] = data.cam_xpos[ids].mean(0)
        ways[t] = -data.cam_xmat[ids].reshape(2, 3, 3)[:, :, 2].mean(0)
    return starts, ways
