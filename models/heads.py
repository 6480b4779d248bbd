"""The stage that a head that sees looks at.

Every stage has its eyes 0.198 m above a table whose frame is x forward, y left, z up from the table's point below the
eyes: the height of the Biclops's cameras. What is said about balls and the teacher is said in that frame.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Final

import mujoco
import numpy as np

from models.biclops.room import Ball, hang_balls, seat_teacher
from models.loading import compiled, hung
from models.retina import camera_id
from models.robots import ROBOTS, head_of
from models.servos import resting

CARD: Final = "card"
"""A grey card that can be held before a face: a mocap body, parked where nobody sees it."""
PARKED: Final = (0.0, 0.0, -5.0)
TOE_IN_DEG: Final = (1.0, 3.0)
ASKEW_DEG: Final = 1.0
"""How far each eye of a head that squints is turned towards the other; how far it nods and rolls at most."""


def stage(robot: str, *, teacher: bool = False, distance: float = 0.8, balls: Sequence[Ball] = ()) -> mujoco.MjSpec:
    """The robot at its table, with balls, a teacher opposite and a card to hide it; positions in the table's frame.

    Raises:
        BodyError: see `head_of`, `models.biclops.room`.
    """
    facts = head_of(robot)
    origin = np.array(facts.table)
    moved = [replace(ball, position=tuple((np.array(ball.position) + origin).tolist())) for ball in balls]
    if facts.room is None:
        scene = _welded(hung(ROBOTS[robot]), facts.motors)
        _surround(scene, origin)
    else:
        scene = mujoco.MjSpec.from_file(str(facts.room))
    if teacher:
        seat_teacher(scene, scene.site("opposite"), distance)
    hang_balls(scene, moved)
    if teacher:
        body = scene.worldbody.add_body(name=CARD, pos=PARKED, mocap=True)
        body.add_geom(
            name=CARD, type=mujoco.mjtGeom.mjGEOM_BOX, size=(0.002, 0.16, 0.13), rgba=(0.5, 0.5, 0.52, 1), group=2,
            contype=0, conaffinity=0,
        )  # fmt: skip
    return scene


@lru_cache(maxsize=len(ROBOTS))
def camera_facts(robot: str) -> tuple[float, float]:
    """Vertical field of view, degrees, and half the distance between the eyes, m."""
    model = compiled(ROBOTS[robot])
    left, right = (camera_id(model, eye) for eye in head_of(robot).eyes)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return float(model.cam_fovy[left]), float(np.linalg.norm(data.cam_xpos[left] - data.cam_xpos[right]) / 2)


def clear_away(model: mujoco.MjModel, thing: str) -> None:
    """Make a piece of scenery invisible: a geom of alpha 0 is not there for any eye."""
    model.geom(thing).rgba[3] = 0.0


def squint(model: mujoco.MjModel, robot: str, seed: int) -> None:
    """Turn both eyes out of parallel, each about its own middle by angles of its own: `TOE_IN_DEG`, `ASKEW_DEG`."""
    rng = np.random.default_rng([seed, 0x5C1])
    for eye, inwards in zip(head_of(robot).eyes, (-1, 1), strict=True):
        nod, roll = rng.uniform(-ASKEW_DEG, ASKEW_DEG, 2)
        turn = np.deg2rad([nod, inwards * rng.uniform(*TOE_IN_DEG), roll])  # of a camera: x right, y up, z back
        mujoco.mju_quatIntegrate(model.cam_quat[camera_id(model, eye)], turn, 1.0)


def _welded(scene: mujoco.MjSpec, moving: Sequence[str]) -> mujoco.MjSpec:
    """All but these joints fixed where they are at rest: whoever sits still and looks about needs no others, and a head
    of two joints takes a tenth of the time of a whole humanoid."""
    model = scene.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = resting(model)
    mujoco.mj_kinematics(model, data)
    for body in scene.bodies:
        still = [joint for joint in body.joints if joint.name not in moving]
        if not still:
            continue
        parent = int(model.body_parentid[body.id])
        place, turn = np.zeros(3), np.zeros(4)
        mujoco.mju_negPose(place, turn, data.xpos[parent], data.xquat[parent])
        mujoco.mju_mulPose(body.pos, body.quat, place, turn, data.xpos[body.id], data.xquat[body.id])
        body.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
        for joint in still:
            scene.delete(joint)
    gone = {model.joint(j).name for j in range(model.njnt)}.difference(moving)
    idle = {motor.name for motor in scene.actuators if motor.target in gone}
    of_none = [sensor for sensor in scene.sensors if sensor.objname in gone | idle]
    for thing in [*of_none, *(scene.actuator(name) for name in idle), *scene.keys]:  # keys: it is born as it rests
        scene.delete(thing)
    return scene


def _surround(scene: mujoco.MjSpec, origin: np.ndarray) -> None:
    """A table, a place opposite and muted walls around a robot that stands in the open."""
    scene.worldbody.add_site(name="opposite", pos=origin, quat=(0, 0, 0, 1))
    for name, size, pos, rgba in (
        ("table", (0.9, 0.8, 0.02), (1.1, 0.0, float(origin[2]) - 0.02), (0.50, 0.47, 0.44, 1)),
        ("front_wall", (0.05, 2.5, 1.5), (2.5, 0, 0.75), (0.66, 0.67, 0.66, 1)),
        ("back_wall", (0.05, 2.5, 1.5), (-2.5, 0, 0.75), (0.64, 0.64, 0.62, 1)),
        ("left_wall", (2.5, 0.05, 1.5), (0, 2.5, 0.75), (0.62, 0.63, 0.64, 1)),
        ("right_wall", (2.5, 0.05, 1.5), (0, -2.5, 0.75), (0.63, 0.62, 0.62, 1)),
    ):
        scene.worldbody.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_BOX, size=size, pos=pos, rgba=rgba, contype=0, conaffinity=0
        )
    scene.visual.headlight.ambient = (0.35, 0.35, 0.35)
    scene.visual.headlight.diffuse = (0.25, 0.25, 0.25)
    scene.visual.headlight.specular = (0.0, 0.0, 0.0)
