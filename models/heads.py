"""Heads that see: which robots can look about, and the stage they look at.

Every stage has its eyes 0.198 m above a table whose frame is x forward, y left, z up from the table's point below the
eyes: the height of the Biclops's cameras. What is said about balls and the teacher is said in that frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

import mujoco
import numpy as np

from models import biclops, hoap2
from models.biclops.facts import CAMERA_HEIGHT, MAX_ACCELERATION_DEG_S2, MAX_SPEED_DEG_S, PAN_HEIGHT
from models.biclops.room import Ball, hang_balls, room, seat_teacher
from models.errors import BodyError, unknown
from models.hoap2.make_stand import TORSO_HEIGHT

EYE_HEIGHT: Final = PAN_HEIGHT + CAMERA_HEIGHT
"""Metres of the eyes above the table."""
CARD: Final = "card"
"""A grey card that can be held before a face: a mocap body, parked where nobody sees it."""
PARKED: Final = (0.0, 0.0, -5.0)


@dataclass(frozen=True)
class HeadFacts:
    """What an experiment has to know to put a robot's head before something."""

    robot: Path
    """MJCF of the robot where its head is free to move."""
    motors: tuple[str, str]
    """Actuators (and joints) of pan and tilt."""
    home: str
    """Keyframe to rest at."""
    max_speed: tuple[float, float]
    """rad/s, of the run profile."""
    max_acceleration: tuple[float, float]
    """rad/s^2, of the run profile."""
    table: tuple[float, float, float]
    """Origin of the table's frame in the robot's world, m."""
    eyes: tuple[str, str] = ("left_eye", "right_eye")


HEADS: MappingProxyType[str, HeadFacts] = MappingProxyType(
    {
        "biclops": HeadFacts(
            robot=biclops.ROBOT,
            motors=("pan", "tilt"),
            home="home",
            max_speed=(np.deg2rad(MAX_SPEED_DEG_S[0]), np.deg2rad(MAX_SPEED_DEG_S[1])),
            max_acceleration=(np.deg2rad(MAX_ACCELERATION_DEG_S2[0]), np.deg2rad(MAX_ACCELERATION_DEG_S2[1])),
            table=(0.0, 0.0, 0.0),
        ),
        # eyes at waist + neck + tilt axis - 5 mm; speed as in its MJCF; acceleration: a fifth of a second to top speed
        "hoap2": HeadFacts(
            robot=hoap2.STAND,
            motors=("head_joint_1", "head_joint_2"),
            home="home",
            max_speed=(4.0, 4.0),
            max_acceleration=(20.0, 20.0),
            table=(0.0, 0.0, TORSO_HEIGHT + 0.090 + 0.081 - 0.005 - EYE_HEIGHT),
        ),
    }
)
"""Robots with a head that sees."""


def head_facts(robot: str) -> HeadFacts:
    """The head of this robot.

    Raises:
        BodyError: no such robot, or one that cannot see.
    """
    if robot not in HEADS:
        raise BodyError(unknown("robot with eyes", robot, HEADS))
    return HEADS[robot]


def stage(
    robot: str, *, teacher: bool = False, distance: float = 0.8, balls: Sequence[Ball] = (), card: bool = False
) -> mujoco.MjSpec:
    """The robot at its table, with a teacher opposite, balls and a card on request; positions in the table's frame.

    Raises:
        BodyError: see `head_facts`, `models.biclops.room`.
    """
    facts = head_facts(robot)
    origin = np.array(facts.table)
    moved = [replace(ball, position=tuple((np.array(ball.position) + origin).tolist())) for ball in balls]
    if robot == "biclops":
        scene = room(teacher=teacher, distance=distance, balls=moved)
    else:
        scene = _around(mujoco.MjSpec.from_file(str(facts.robot)), origin)
        if teacher:
            seat_teacher(scene, scene.worldbody.add_site(name="opposite", pos=origin, quat=(0, 0, 0, 1)), distance)
        hang_balls(scene, moved)
    if card:
        body = scene.worldbody.add_body(name=CARD, pos=PARKED, mocap=True)
        body.add_geom(
            name=CARD, type=mujoco.mjtGeom.mjGEOM_BOX, size=(0.002, 0.16, 0.13), rgba=(0.5, 0.5, 0.52, 1), group=2,
            contype=0, conaffinity=0,
        )  # fmt: skip
    return scene


def clear_away(model: mujoco.MjModel, thing: str) -> None:
    """Make a piece of scenery invisible: a geom of alpha 0 is not there for any eye."""
    model.geom(thing).rgba[3] = 0.0


def check_sees(model: mujoco.MjModel, eyes: Sequence[str]) -> None:
    """Refuse a scene without the cameras that are to be looked through.

    Raises:
        BodyError: no such camera.
    """
    from models.retina import camera_id

    for eye in eyes:
        camera_id(model, eye)


def _around(scene: mujoco.MjSpec, origin: np.ndarray) -> mujoco.MjSpec:
    """A table and muted walls around a robot that stands in the open."""
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
    return scene
