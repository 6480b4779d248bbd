"""A stage as an onlooker sees it: parts that move, balls where they hang, and where everybody's gaze goes."""

from collections.abc import Mapping
from typing import NamedTuple

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.biclops.room import CLOTHS, FACE_PREFIX, TEACHER
from models.robots import ROBOTS, head_of
from models.shapes import Part, parts

_SCENERY = ("front_wall", "back_wall", "left_wall", "right_wall", "floor")
_UNSEEN_GROUP = 5


class BallShape(NamedTuple):
    """A ball in the world."""

    place: FloatArray
    """(3,) m."""
    radius: float
    colour: FloatArray
    """(3,) 0 to 1."""


class Onlooked(NamedTuple):
    """T moments of a stage."""

    parts: list[Part]
    balls: Mapping[str, BallShape]
    gaze: tuple[FloatArray, FloatArray]
    """(T, 3) middle between our eyes and (T, 3) where they look."""
    teacher_gaze: tuple[FloatArray, FloatArray] | None
    """The same of the teacher's."""


def onlook(
    model: mujoco.MjModel,
    robot: str,
    angles: FloatArray,
    teacher: FloatArray | None,
    balls: Mapping[str, FloatArray],
) -> Onlooked:
    """A stage through (T, 2) postures of the head and the teacher's; balls at places of the table's frame."""
    facts, rest = head_of(robot), ROBOTS[robot].home
    home = model.key(rest).qpos if rest and model.nkey else np.zeros(model.nq)
    qpos = np.tile(home, (len(angles), 1))
    qpos[:, _columns(model, facts.motors)] = angles
    if teacher is not None:
        qpos[:, _columns(model, (f"{TEACHER}pan", f"{TEACHER}tilt"))] = teacher
    shown = model.geom_group.copy()
    cloths = [f"{TEACHER}{FACE_PREFIX}{cloth}" for cloth in CLOTHS]
    for geom in range(model.ngeom):
        name = model.geom(geom).name
        mocap = model.body_mocapid[model.geom_bodyid[geom]] >= 0
        if mocap or name in _SCENERY or (name in (*cloths, "table") and model.geom_rgba[geom][3] == 0):
            model.geom_group[geom] = _UNSEEN_GROUP
    try:
        moving = parts(model, qpos)
    finally:
        model.geom_group[:] = shown
    origin = np.array(facts.table)
    shapes = {
        name: BallShape(np.asarray(place) + origin, float(model.geom(name).size[0]), model.geom(name).rgba[:3].copy())
        for name, place in balls.items()
    }
    theirs = (TEACHER + "left_eye", TEACHER + "right_eye")
    return Onlooked(
        moving,
        shapes,
        _gazes(model, qpos, facts.eyes),
        _gazes(model, qpos, theirs) if teacher is not None else None,
    )


def _columns(model: mujoco.MjModel, joints: tuple[str, str]) -> list[int]:
    return [int(model.jnt_qposadr[model.joint(joint).id]) for joint in joints]


def _gazes(model: mujoco.MjModel, qpos: FloatArray, cameras: tuple[str, str]) -> tuple[FloatArray, FloatArray]:
    data = mujoco.MjData(model)
    starts, ways = np.empty((len(qpos), 3)), np.empty((len(qpos), 3))
    ids = [model.camera(name).id for name in cameras]
    for t, q in enumerate(qpos):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)
        starts[t] = data.cam_xpos[ids].mean(0)
        ways[t] = -data.cam_xmat[ids[0]].reshape(3, 3)[:, 2]
    return starts, ways
