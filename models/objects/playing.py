"""A robot that plays: at a table, before an object that every copy of it has its own specimen of."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import mujoco
import numpy as np

from models.arrays import BoolArray, FloatArray
from models.body import SimulatedBody
from models.errors import BodyError
from models.objects import Toy
from models.objects.scene import PREFIX, seated
from models.robots import Robot, Seat

PLACED: Final = (0.02, 0.03, 0.2)
"""m forward, m to the left, rad about the upright: how far from its usual place each piece is set down, at most."""
CLEAR: Final = 0.06
"""m that separate pieces are set apart, at least."""
MIDDLE: Final = (0.1, 0.0, 0.3)
"""m in the robot's world: places are told from here, before the chest and above the table."""
SETTLE_S: Final = 0.06
"""How long an object lies before anything is done to it."""


@dataclass(frozen=True)
class Specimens:
    """How specimens of one object, and who handles them, differ; each draw is that of the specimen's number."""

    masses: float = 0.1
    """Share by which pieces are heavier or lighter, at most."""
    friction: tuple[float, float] = (0.6, 1.0)
    """Least and most share of the sliding friction of everything that touches."""
    grip: tuple[float, float] = (4.0, 8.0)
    """N that a palm holds with at full effort."""
    placed: tuple[float, float, float] = PLACED

    def drawn(self, toy: Toy, numbers: Iterable[int]) -> list[dict[str, Any]]:
        """For each number: mass and friction factors, grip and stiction, N, and a generator for where pieces go."""
        found = []
        for number in numbers:
            rng = np.random.default_rng([number, 0x70E])
            mass, friction = 1 + self.masses * rng.uniform(-1, 1), rng.uniform(*self.friction)
            stiction = float(np.exp(rng.uniform(*np.log(toy.stiction))))
            grip = rng.uniform(*self.grip)
            found.append({"mass": mass, "friction": friction, "stiction": stiction, "grip": grip, "rng": rng})
        return found


def pieces(model: mujoco.MjModel) -> list[int]:
    """Bodies of the object that stand on the table by themselves."""
    on_table = (body for body in range(1, model.nbody) if model.body_parentid[body] == 0)
    return [body for body in on_table if model.body(body).name.startswith(PREFIX)]


def lay(model: mujoco.MjModel, laid: Iterable[FloatArray]) -> None:
    """Stand pieces where `PlayBody.laid` says, one copy's (pieces, 7)."""
    for piece, place in zip(pieces(model), laid, strict=False):
        model.body_pos[piece], model.body_quat[piece] = place[:3], place[3:]


class PlayBody(SimulatedBody):
    """`SimulatedBody` on its seat before an object; wired as ever; its palms hold as hard as they are told to.

    Args:
        robot, seat: who plays.
        toy: with what; None for an empty table.
        busy: whether its palms are bound to its chest.
        table: m, height of the table's top where it is not the usual one.
        further: m that the object stands further away than usual.
        specimens: how copies differ.
        how: see `SimulatedBody`.

    Raises:
        BodyError: see `models.objects.scene.seated`.
    """

    def __init__(
        self,
        robot: Robot,
        seat: Seat,
        toy: Toy | None,
        *,
        busy: bool = False,
        table: float | None = None,
        further: float = 0.0,
        specimens: Specimens = Specimens(),
        **how: Any,
    ) -> None:
        model = seated(robot, seat, toy, table).compile()
        self.table = seat.table * robot.size if table is None else table
        """m, height of its top."""
        self.robot, self.seat, self.toy, self.busy, self._specimens = robot, seat, toy, busy, specimens
        self._further = further
        self._points: FloatArray | None = None
        super().__init__(model, sensors=tuple(f"{part}_touch" for part in seat.parts), **how)
        sites = [*seat.parts, *([f"{PREFIX}a", f"{PREFIX}b"] if toy else [])]
        self._sites = [model.site(site).id for site in sites]
        self._grips = [model.actuator(f"{hand}_grip").id for hand in seat.hands]
        self._bound = self.batch.bind("eq_active")
        self._points = self.batch.bind("site_xpos")
        names = [model.joint(j).name for j in range(model.njnt)]
        self._joints = {name.removeprefix(PREFIX): model.joint(name) for name in names if name.startswith(PREFIX)}
        self._pieces = pieces(model)
        numerics = [model.numeric(i).name for i in range(model.nnumeric)]
        self._together = f"{PREFIX}together" in numerics
        self.stiction = self.grip_n = np.zeros(self.copies)
        self.set_out(0)

    def set_out(self, first: int | Sequence[int]) -> FloatArray:
        """Specimens `first` and following, or these B, each set down in a place of its own, everybody at rest; (B, S)
        sensations."""
        if self.toy is None:
            return self.reset()
        numbers = range(first, first + self.copies) if isinstance(first, int) else first
        drawn = self._specimens.drawn(self.toy, numbers)
        self.stiction, self.grip_n = (np.array([one[key] for one in drawn]) for key in ("stiction", "grip"))
        bodies = np.isin(self.model.body_rootid, self._pieces)
        geoms = bodies[self.model.geom_bodyid]
        for name, factor, ours in (
            ("body_mass", "mass", bodies), ("body_inertia", "mass", bodies), ("geom_friction", "friction", geoms),
        ):  # fmt: skip
            share = np.where(ours, np.array([[one[factor]] for one in drawn]), 1.0)
            born = getattr(self.model, name)
            self.batch.expand(name)[:] = born * share.reshape(*share.shape, *(1,) * (born.ndim - 1))
        self.batch.expand("actuator_gainprm")[:, self._grips, 0] = self.grip_n[:, None]
        if "stiction" in self._joints:
            self.batch.expand("dof_frictionloss")[:, int(self._joints["stiction"].dofadr[0])] = self.stiction
        self._where = [self._placed(one["rng"]) for one in drawn]
        body_pos, body_quat = self.batch.expand("body_pos"), self.batch.expand("body_quat")
        for copy, places in enumerate(self._where):
            for piece, (place, turn) in zip(self._pieces, places, strict=True):
                body_pos[copy, piece], body_quat[copy, piece] = place, turn
        self.batch.set_const()
        return self.reset()

    def reset(self) -> FloatArray:
        """See `SimulatedBody`; the object is put back where it was set out."""
        super().reset()
        if self._points is None:
            return self._feel()
        self.batch.ctrl[:, self._grips] = 0
        self.batch.qfrc_applied[:] = 0
        self._bound[:] = self.busy
        for copy, places in enumerate(self._where if self.toy else ()):
            for piece, (place, turn) in zip(self._pieces, places, strict=True):
                first = self.model.body_jntadr[piece]
                if first >= 0 and self.model.jnt_type[first] == int(mujoco.mjtJoint.mjJNT_FREE):
                    at = self.model.jnt_qposadr[first]
                    self.batch.qpos[copy, at : at + 7] = (*place, *turn)
        self.batch.step(nstep=round(SETTLE_S / self.model.opt.timestep), stage=self._stage)
        return self._feel()

    def grip(self, efforts: FloatArray) -> None:
        """From now on (B, 2) palms hold with these shares of their strength, 0 to 1."""
        self.batch.ctrl[:, self._grips] = np.clip(efforts, 0, 1)

    def tug(self, newtons: FloatArray) -> None:
        """From now on (B,) N pull the ends of an object apart: for those who test its friction.

        Raises:
            BodyError: an object that is not held together by friction.
        """
        if "stiction" not in self._joints:
            raise BodyError(f"{self.name}: nothing is held together by dry friction here")
        self.batch.qfrc_applied[:, int(self._joints["stiction"].dofadr[0])] = newtons

    @property
    def apart(self) -> FloatArray:
        """(B,) m that the ends of an object have been drawn apart; for those who judge."""
        return np.array(self.batch.qpos[:, int(self._joints["stiction"].qposadr[0])])

    @property
    def places(self) -> FloatArray:
        """(B, 3 + 2, 3) m from `MIDDLE` where its parts and the object's a and b are; for those who judge, or see with
        noise."""
        assert self._points is not None
        return np.asarray(self._points[:, self._sites] - MIDDLE)

    @property
    def signal(self) -> BoolArray:
        """(B,) whether the object shines or buzzes."""
        if self.toy is None or "switch" not in self._joints:
            return np.zeros(self.copies, bool)
        return np.asarray(self.batch.qpos[:, int(self._joints["switch"].qposadr[0])] > self.toy.on)

    @property
    def configuration(self) -> FloatArray:
        """(B, nq) of the model now, the object included: to draw it."""
        return np.array(self.batch.qpos)

    @property
    def laid(self) -> FloatArray:
        """(B, pieces, 7) place, m, and turn of every piece as it was set out: to draw it."""
        if self.toy is None:
            return np.empty((self.copies, 0, 7))
        return np.array([[np.concatenate(piece) for piece in places] for places in self._where])

    def _placed(self, rng: np.random.Generator) -> list[tuple[FloatArray, FloatArray]]:
        """Place and turn of every piece, drawn until separate ones are clear of each other."""
        for _ in range(1000):
            draws = rng.uniform(-1, 1, (len(self._pieces), 3)) * self._specimens.placed
            draws = draws[:1].repeat(len(draws), 0) if self._together else draws
            found = [self._moved(piece, draw) for piece, draw in zip(self._pieces, draws, strict=True)]
            middles = np.array([place[:2] for place, _ in found])
            gaps = [np.linalg.norm(middles[i] - middles[j]) for i in range(len(found)) for j in range(i)]
            if self._together or min(gaps, default=np.inf) > CLEAR:
                return found
        raise BodyError(f"{self.toy and self.toy.folder.name}: its pieces cannot be set down {CLEAR:g} m apart")

    def _moved(self, piece: int, draw: FloatArray) -> tuple[FloatArray, FloatArray]:
        """About the first piece's middle when all are set down as one, about its own otherwise."""
        born, quat = self.model.body_pos[piece], self.model.body_quat[piece]
        about = self.model.body_pos[self._pieces[0]] if self._together else born
        turn, spun, place = np.array([np.cos(draw[2] / 2), 0, 0, np.sin(draw[2] / 2)]), np.empty(4), np.empty(3)
        mujoco.mju_mulQuat(spun, turn, quat)
        mujoco.mju_rotVecQuat(place, born - about, turn)
        return about + place + (draw[0] + self._further, draw[1], 0.0), spun
