"""What cameras show of a robot at its table: images, and nothing else."""

from dataclasses import dataclass
from typing import Any, Final

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.errors import BodyError
from models.objects import Toy
from models.objects.playing import PlayBody, lay
from models.objects.scene import LIT, OFF, PREFIX, seated
from models.renderers import open_eye
from models.retina import Image, RetinaOptions
from models.robots import Robot, Seat

OWN: Final = RetinaOptions(320, 200, fovy_deg=100.0, noise=0.02)
"""Of one's own eyes: a wide field, for a table at arm's length is seen over one's own chest."""
OTHER: Final = RetinaOptions(320, 240, fovy_deg=40.0, noise=0.02)
"""Of one who watches from some way off."""
EYES: Final = ("left_eye", "right_eye")
AMBIENT, HEADLIGHT = 0.35, 0.5


@dataclass(frozen=True)
class Room:
    """From where a robot at its table is watched, and what stands behind it."""

    place: tuple[float, float, float] = (0.75, 0.0, 0.5)
    """m in the robot's world: of the camera, or the middle between two."""
    at: tuple[float, float, float] = (0.08, 0.0, 0.29)
    """m, what it looks at."""
    apart: float = 0.045
    """m between two parallel cameras; 0 for one: television."""
    table: tuple[float, float, float] = (0.62, 0.6, 0.57)
    """Red, green, blue."""
    wall: tuple[float, float, float] = (0.8, 0.8, 0.8)
    """Of all that is behind."""

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of its cameras, the left one first."""
        return ("watching_left", "watching_right") if self.apart else ("watching",)

    def furnish(self, spec: mujoco.MjSpec) -> None:
        """Put cameras into a scene, and colour its table.

        Raises:
            BodyError: a camera where it looks, or straight above or below.
        """
        ahead = np.subtract(self.at, self.place)
        right = np.cross(ahead, (0, 0, 1.0))
        if np.linalg.norm(right) < 1e-6:
            raise BodyError(f"a camera at {self.place} cannot look at {self.at}: it must look across, not up or down")
        right /= np.linalg.norm(right)
        back = -ahead / np.linalg.norm(ahead)
        turn = np.empty(4)
        mujoco.mju_mat2Quat(turn, np.column_stack([right, np.cross(back, right), back]).ravel())
        for name, side in zip(self.cameras, (-0.5, 0.5) if self.apart else (0.0,), strict=True):
            spec.worldbody.add_camera(name=name, pos=self.place + side * self.apart * right, quat=turn)
        spec.geom("table").rgba[:3] = self.table


class Retinas:
    """Images of a seated robot and its object, from its own two eyes or from a room.

    Args:
        robot, seat: who sits there.
        toy: what stands before it.
        table: m, height of the table's top where it is not the usual one.
        room: from where; None for its own eyes.
        options: of every camera; None for `OWN` or `OTHER`.
        renderer: see `models.renderers`.

    Raises:
        BodyError: see `models.objects.scene.seated` and `Room.furnish`.
    """

    def __init__(
        self,
        robot: Robot,
        seat: Seat,
        toy: Toy | None = None,
        table: float | None = None,
        *,
        room: Room | None = None,
        options: RetinaOptions | None = None,
        renderer: str = "rays",
    ) -> None:
        spec = seated(robot, seat, toy, table)
        if room is not None:
            room.furnish(spec)
        self._model = model = spec.compile()
        if room is not None:
            model.vis.rgba.haze[:3] = room.wall
        model.vis.headlight.ambient[:], model.vis.headlight.diffuse[:] = AMBIENT, HEADLIGHT
        self._data = mujoco.MjData(model)
        cameras, usual = (EYES, OWN) if room is None else (room.cameras, OTHER)
        self.eyes = [open_eye(model, camera, options or usual, renderer) for camera in cameras]
        self._lamp = toy and toy.glows and (model.geom(f"{PREFIX}a").id, int(model.joint(f"{PREFIX}switch").qposadr[0]))
        self._on = toy.on if toy else 0.0

    @classmethod
    def of(cls, body: PlayBody, **how: Any) -> "Retinas":
        """Of this body's scene; nothing else is taken from it."""
        return cls(body.robot, body.seat, body.toy, body.table, **how)

    def see(
        self, configuration: FloatArray, rng: np.random.Generator, laid: FloatArray | tuple[()] = ()
    ) -> list[Image]:
        """What every camera shows.

        Args:
            configuration: (nq,) of a `PlayBody`.
            rng: of the retinas' noise.
            laid: (pieces, 7) its `PlayBody.laid`, where pieces do not stand where they are born.
        """
        model, data = self._model, self._data
        data.qpos[:] = configuration
        lay(model, laid)
        if self._lamp:
            geom, switch = self._lamp
            model.geom_rgba[geom, :3] = LIT if configuration[switch] > self._on else OFF
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)
        return [eye.see(data, rng) for eye in self.eyes]
