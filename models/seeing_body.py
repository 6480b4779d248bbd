"""A head that looks: motor lines in, joint angles and what was found on its retinas out.

Each tick the run profile carries the set-points towards the commanded posture; at its end both eyes look. A tick as
long as a saccade gives a body that jumps from view to view; a tick of a video frame gives one that watches. How an
image becomes positions is given from outside (`perceive`): a body has retinas, seeing is the mind's.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from time import process_time
from timeit import repeat
from typing import Protocol

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.biclops.profile import profile
from models.biclops.room import TEACHER
from models.body import SimulatedBody
from models.errors import BodyError
from models.heads import squint
from models.loading import compiled
from models.renderers import open_eye
from models.retina import Image, RetinaOptions
from models.robots import ROBOTS, head_of
from models.senses import Channel, Senses
from models.wiring import Wiring


class Perceive(Protocol):
    """What is found on an image."""

    @property
    def labels(self) -> tuple[str, ...]:
        """K kinds of things."""

    @property
    def areas(self) -> bool:
        """Whether it measures areas too."""

    def __call__(self, image: Image) -> FloatArray:
        """(H, W, 3) bytes to (K, 2 or 3): u, v in pixels, area in square pixels; NaN for what is not seen."""


INNER_S = 0.02
"""Set-points are renewed every so often."""
TEACHER_MOTORS = (TEACHER + "pan", TEACHER + "tilt")


class SeeingBody:
    """`copies` heads on one stage, each with its own arrangement of balls and its own teacher's posture.

    Senses: `angle` of pan and tilt (rad); `place` of every kind of thing, (u, v) in the left eye and in the right;
    their `area` in both where `perceive` measures it.

    Args:
        model: a compiled `models.heads.stage`.
        robot: whose head it is.
        perceive: what is found on an image.
        retina: how both eyes see.
        renderer: how images are made.
        copies, tick_s, seed: as in `SimulatedBody`; `seed` is that of pixel noise.
        rest: pan and tilt to rest at, rad; None is the robot's own rest.
        scramble: seed of an unknown wiring of pan and tilt, or None for straight; eyes are never rewired.
        squinting: seed of how the eyes stand out of parallel, or None for parallel.

    Raises:
        BodyError: a scene without the robot's eyes, or a tick that is no whole number of 20 ms.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        robot: str,
        perceive: Perceive,
        *,
        retina: RetinaOptions | None = None,
        renderer: str = "rays",
        copies: int = 1,
        tick_s: float = 1.4,
        seed: int = 0,
        rest: tuple[float, float] | None = None,
        scramble: int | None = None,
        squinting: int | None = None,
    ) -> None:
        self.facts = head_of(robot)
        self.retina = retina or RetinaOptions()
        self.robot = robot
        self.tick_s, self._perceive = tick_s, perceive
        if squinting is not None:
            squint(model, robot, squinting)
        self._inner = round(tick_s / INNER_S)
        if self._inner < 1 or abs(self._inner * INNER_S - tick_s) > 1e-9:
            raise BodyError(f"a tick of {tick_s:g} s: it must be a whole number of {INNER_S:g} s")
        teacher = TEACHER_MOTORS if {model.joint(j).name for j in range(model.njnt)}.issuperset(TEACHER_MOTORS) else ()
        self.heads = SimulatedBody(
            model, name=robot, copies=copies, threads=1, tick_s=INNER_S, motors=self.facts.motors + teacher
        )
        self.eyes = [open_eye(model, eye, self.retina, renderer) for eye in self.facts.eyes]
        self._data, self.model = mujoco.MjData(model), model
        self.rest = np.asarray(self.facts.rest if rest is None else rest, float)
        self.motor_low, self.motor_high = self.heads.motor_low[:2], self.heads.motor_high[:2]
        width, height, eyes, things = self.retina.width, self.retina.height, ("left", "right"), perceive.labels
        size, most = (width - 1.0, height - 1.0), float(width * height)
        channels = [
            replace(self.heads.senses["angle"].only(self.facts.motors), labels=("pan", "tilt")),
            Channel("place", "image position", "px", things, 0.0, size, (eyes, ("u", "v"))),
            Channel("area", "area", "px^2", things, 0.0, most, (eyes,), suffix="area"),
        ]
        self.wiring = Wiring.straight(2, 2) if scramble is None else Wiring.scrambled(2, 2, scramble)
        seen = len(Senses(channels[1 : 2 + perceive.areas]))
        order = np.concatenate([self.wiring.sense, np.arange(2, 2 + seen)])
        self.senses = Senses(channels[: 2 + perceive.areas], order)
        self.sense_low, self.sense_high = self.senses.low, self.senses.high
        self.fingerprint = head_fingerprint(robot, scramble) + ("" if squinting is None else f" squint {squinting}")
        self.seed, self.time = seed, 0.0
        self.teacher_path: Callable[[float], FloatArray] | None = None
        """Seconds since `reset` to (B, 2) the teacher's pan and tilt, rad; None leaves it where it is."""
        self.images: list[tuple[Image, Image]] = []
        """What the eyes of each copy saw last."""
        self._rng = np.random.default_rng([seed, 0xE7E])
        self._angles = np.zeros((copies, len(self.heads.joints)))
        self._velocity = np.zeros((copies, 2))

    @property
    def copies(self) -> int:
        """B, how many heads there are."""
        return self.heads.copies

    @property
    def joint_angles(self) -> FloatArray:
        """(B, 2) true pan and tilt; for those who judge."""
        return self.heads.joint_angles[:, :2]

    @property
    def teacher_angles(self) -> FloatArray:
        """(B, 2) the teacher's true pan and tilt; for those who judge."""
        return self.heads.joint_angles[:, 2:]

    def place(self, ball: str, positions: FloatArray) -> None:
        """Put a ball (or the card) at (B, 3) or (3,) places of the table's frame, seen from the next look on."""
        body = int(self.model.body(ball).mocapid[0])
        if body < 0:
            raise BodyError(f"{ball!r} cannot be moved: it is no ball and no card")
        self.heads.batch.mocap_pos[:, body] = np.asarray(positions) + np.array(self.facts.table)

    def whereabouts(self, shapes: Sequence[str]) -> FloatArray:
        """(K, 3) m where these shapes of copy 0 are, in the table's frame; for stage directions."""
        data = self._view(0)
        return np.asarray([data.geom(shape).xpos - np.array(self.facts.table) for shape in shapes])

    def reset(self) -> FloatArray:
        """All heads to rest; (B, S) sensations. Balls stay; pixel noise starts over."""
        self._rng = np.random.default_rng([self.seed, 0xE7E])
        places = np.array(self.heads.batch.mocap_pos)
        self.heads.reset()
        self.heads.batch.mocap_pos[:] = places
        self._angles = self.heads.joint_angles.copy()
        self._angles[:, :2] = self.rest
        self.time = 0.0
        if self.teacher_path is not None:
            self._angles[:, 2:] = self.teacher_path(0.0)
        self.heads.batch.qpos[:] = self.heads.configurations(self._angles)
        self._velocity[:] = 0.0
        for _ in range(5):
            felt = self.heads.act(self.heads.command_angles(self._angles))
        return self._look(felt)

    def act(self, motors: FloatArray, *, look: bool = True) -> FloatArray:
        """Send (B, 2) motor lines, let the tick go by, look; (B, S) sensations. With eyes shut nothing is seen."""
        if np.shape(motors) != (self.copies, 2) or not np.isfinite(motors).all():
            raise BodyError(f"motor commands of shape {np.shape(motors)}: {(self.copies, 2)} finite numbers are needed")
        target = self.heads.commands(self._both(self.wiring.fractions(motors) / 2))[:, :2]
        for _ in range(self._inner):
            self.time += INNER_S
            self._angles[:, :2], self._velocity = profile(
                self._angles[:, :2], self._velocity, target, self.facts.max_speed, self.facts.max_acceleration, INNER_S
            )
            if self.teacher_path is not None:
                self._angles[:, 2:] = self.teacher_path(self.time)
            felt = self.heads.act(self.heads.command_angles(self._angles))
        return self._look(felt, shut=not look)

    def command_angles(self, angles: FloatArray) -> FloatArray:
        """Motor lines (B, 2) that command pan and tilt (B, 2), for baselines and stage directions."""
        return self.wiring.lines(2 * self.heads.command_angles(self._both(angles))[..., :2])

    def images_per_second(self, looks: int = 60) -> float:
        """How quickly one core makes images of what copy 0's left eye sees (processor time, the best of three)."""
        data, rng, number = self._view(0), np.random.default_rng(0), looks // 3
        took = repeat(lambda: self.eyes[0].see(data, rng), timer=process_time, repeat=3, number=number)
        return number / max(min(took), 1e-6)

    def _view(self, copy: int) -> mujoco.MjData:
        data = self._data
        data.qpos[:] = self.heads.batch.qpos[copy]
        data.mocap_pos[:] = self.heads.batch.mocap_pos[copy]
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_camlight(self.model, data)
        return data

    def _both(self, own: FloatArray) -> FloatArray:
        """(..., 2) values of our head beside zeros for the teacher's."""
        return np.concatenate([own, np.zeros((*np.shape(own)[:-1], self._angles.shape[1] - 2))], axis=-1)

    def _look(self, felt: FloatArray, shut: bool = False) -> FloatArray:
        readings = {"angle": self.heads.senses.read(felt, "angle", self.facts.motors)}
        if shut:
            return self.senses.vector(readings)
        self.images = []
        for copy in range(self.copies):
            data = self._view(copy)
            left, right = (eye.see(data, self._rng) for eye in self.eyes)
            self.images.append((left, right))
        seen = np.stack([[self._perceive(eye) for eye in pair] for pair in self.images]).swapaxes(1, 2)
        readings["place"] = seen[..., :2]
        if self._perceive.areas:
            readings["area"] = seen[..., 2]
        return self.senses.vector(readings)


def still(pose: FloatArray) -> Callable[[float], FloatArray]:
    """A teacher's path that stays at (B, 2) pan and tilt."""
    return lambda time: pose


@lru_cache(maxsize=4 * len(ROBOTS))
def head_fingerprint(robot: str, scramble: int | None = None) -> str:
    """Of the robot and its head alone, whatever it looks at."""
    return watching_body(robot, scramble=scramble).fingerprint


def watching_body(robot: str, *, copies: int = 1, scramble: int | None = None) -> SimulatedBody:
    """The head alone at a tick of 20 ms, its motors fed with set-points: for movements, not for jumps."""
    motors, model = head_of(robot).motors, compiled(ROBOTS[robot])
    return SimulatedBody(model, name=robot, copies=copies, threads=1, tick_s=INNER_S, motors=motors, scramble=scramble)
