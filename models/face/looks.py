"""What a newborn's two eyes show of a face before it."""

from dataclasses import dataclass
from typing import Final

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.face import Face
from models.face.body import face_spec
from models.renderers import open_eye
from models.retina import Image, RetinaOptions
from models.servos import resting

RETINA: Final = RetinaOptions(320, 240, fovy_deg=30.0, noise=0.02)
EYES: Final = ("left", "right")
APART_M: Final = 0.036
"""Between a newborn's eyes."""
FOCAL_PX: Final = RETINA.height / 2 / float(np.tan(np.deg2rad(30.0) / 2))


@dataclass(frozen=True)
class View:
    """How a face stands before the eyes: m from them, and turned about its own axes, degrees."""

    distance: float = 0.3
    yaw_deg: float = 0.0
    pitch_deg: float = 0.0

    @property
    def straight(self) -> bool:
        """Whether it looks straight at one."""
        return self.yaw_deg == self.pitch_deg == 0


class Onlooker:
    """Two parallel eyes and a face before them; the eyes are level with the nose."""

    def __init__(self, face: Face, view: View) -> None:
        spec = face_spec(face)
        for name, side in zip(EYES, (0.5, -0.5), strict=True):
            spec.worldbody.add_camera(name=name, pos=(0, side * APART_M, 0), xyaxes=(0, -1, 0, 0, 0, 1))
        turn, yaw, pitch = np.zeros(4), np.zeros(4), np.zeros(4)
        mujoco.mju_axisAngle2Quat(yaw, (0, 0, 1), np.pi + np.deg2rad(view.yaw_deg))
        mujoco.mju_axisAngle2Quat(pitch, (0, 1, 0), np.deg2rad(view.pitch_deg))
        mujoco.mju_mulQuat(turn, yaw, pitch)
        size = face.proportions.size
        head = spec.body("head")
        head.pos = (view.distance + 0.05 * size, 0, 0.012 * size)  # its front is that far away, its nose at eye level
        head.quat = turn
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.rest = resting(self.model)
        self.eyes = tuple(open_eye(self.model, eye, RETINA) for eye in EYES)

    def look(self, configuration: FloatArray, rng: np.random.Generator) -> tuple[Image, Image]:
        """The left and the right eye's image of a (nq,) configuration of the face."""
        self.data.qpos[:] = configuration
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)
        left, right = (eye.see(self.data, rng) for eye in self.eyes)
        return left, right
