"""The head in its room, with whoever and whatever it is to look at."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco

from models.biclops import FACE, ROBOT

TEACHER = "teacher_"
"""Prefix of everything that belongs to the head on the other side."""
FACE_PREFIX = "face_"
CLOTHS = ("blindfold", "headband")
FEATURES = ("left_eye", "right_eye", "nose", "left_ear", "right_ear")
"""The coloured parts of a face, as geoms of face.xml."""


@dataclass(frozen=True)
class Ball:
    """A coloured ball to look at: centre and radius in metres, red, green, blue in 0..1."""

    name: str
    position: tuple[float, float, float]
    rgb: tuple[float, float, float]
    radius: float = 0.02


def seat_teacher(scene: mujoco.MjSpec, place: mujoco.MjsSite, distance: float) -> None:
    """Put a teacher's head on `place`, moved `distance` metres ahead of its own position along x.

    The teacher is the same machine wearing the face, its joints and servos `teacher_pan`, `teacher_tilt`, its features
    `teacher_face_nose` and so on (`FEATURES`).
    """
    other = mujoco.MjSpec.from_file(str(ROBOT))
    other.attach(mujoco.MjSpec.from_file(str(FACE)), site=other.site("face"), prefix=FACE_PREFIX)
    place.pos = (distance, place.pos[1], place.pos[2])
    scene.attach(other, site=place, prefix=TEACHER)


def hang_balls(scene: mujoco.MjSpec, balls: Sequence[Ball]) -> None:
    """Add balls to a scene, each a mocap body of its name."""
    kind, look = mujoco.mjtGeom.mjGEOM_SPHERE, {"group": 2, "contype": 0, "conaffinity": 0}
    for ball in balls:
        body = scene.worldbody.add_body(name=ball.name, pos=ball.position, mocap=True)
        body.add_geom(name=ball.name, type=kind, size=(ball.radius, 0.0, 0.0), rgba=(*ball.rgb, 1.0), **look)


def wear_cloth(model: mujoco.MjModel, cloth: str | None) -> None:
    """Put one of `CLOTHS` on the teacher's head, or take it off again (None). It is seen from the next look on."""
    for name in CLOTHS:
        model.geom(f"{TEACHER}{FACE_PREFIX}{name}").rgba[3] = float(name == cloth)
