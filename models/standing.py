"""A body on its own feet: free of its stand, on a floor, under gravity; it can be pushed, and it can fall."""

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from models.arrays import BoolArray, FloatArray, IntArray
from models.body import SimulatedBody
from models.errors import BodyError
from models.robots import Stance

FALLEN_DEG, FALLEN_HEIGHT = 50.0, 0.55
"""Hips that lean further, or are lower than this share of where they are at home, belong to one who has fallen."""
MOST_TILT_DEG, MOST_PUSH = 30.0, 500.0
"""Steepest floor, degrees, and strongest push, N: 70 times the weight of what is pushed is a collision."""


@dataclass(frozen=True)
class Individuals:
    """How copies of one robot differ from each other: each a draw of its own."""

    masses: float = 0.1
    """Every body's mass lies within this share of its own, evenly drawn."""
    friction: tuple[float, float] = (0.6, 1.0)
    """Sliding friction of everything it touches the floor with, evenly drawn."""
    first: int = 0
    """Copy b is individual `first` + b: masses and friction are its own wherever it appears."""

    def __post_init__(self) -> None:
        low, high = self.friction
        if not (0 <= self.masses < 1 and 0 < low <= high <= 2):
            raise BodyError(
                f"masses within {self.masses:g} and friction {low:g} to {high:g}: a share from 0 to 1, and friction "
                "above 0, up to 2"
            )


class StandingBody(SimulatedBody):
    """`SimulatedBody` on its own feet; wired as ever; it also feels its soles and how it turns.

    Args:
        model: compiled MJCF with a free root, a floor, and contacts.
        stance: what it stands with.
        individuals: how its copies differ.
        tilt_deg: slope of the floor, downhill forward and downhill left.
        how: see `SimulatedBody`.

    Raises:
        BodyError: a floor too steep; see `SimulatedBody`.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        stance: Stance,
        *,
        individuals: Individuals = Individuals(),
        tilt_deg: tuple[float, float] = (0.0, 0.0),
        **how: Any,
    ) -> None:
        self.stance, self._individuals = stance, dict[str, FloatArray]()
        slope = np.deg2rad(tilt_deg)
        if not (np.abs(tilt_deg) <= MOST_TILT_DEG).all():
            raise BodyError(f"a floor tilted by {tilt_deg} degrees: {MOST_TILT_DEG:g} at most")
        down = np.array([np.tan(slope[0]), np.tan(slope[1]), -1.0])
        model.opt.gravity[:] = down / np.linalg.norm(down) * np.linalg.norm(model.opt.gravity)
        self._hips, self._pushed = model.body(stance.hips).id, model.body(stance.pushed).id
        super().__init__(model, sensors=stance.sensors, **how)
        self._place, self._turn = self.batch.bind("xpos"), self.batch.bind("xmat")
        for name in ("body_mass", "body_inertia", "geom_friction"):
            self._individuals[name] = np.array(self.batch.expand(name))
        for copy in range(self.copies):
            rng = np.random.default_rng([individuals.first + copy, 0x57A2])
            share = 1 + individuals.masses * rng.uniform(-1, 1, model.nbody)
            self._individuals["body_mass"][copy] *= share
            self._individuals["body_inertia"][copy] *= share[:, None]
            self._individuals["geom_friction"][copy, :, 0] = rng.uniform(*individuals.friction)
        for name, values in self._individuals.items():
            self.batch.expand(name)[:] = values
        self.batch.set_const()
        self.reset()
        self._home = self._place[:, self._hips, 2].copy()
        self._feet = [model.body(foot).id for foot in stance.feet]
        self._floor = self._place[:, self._feet, 2].copy()

    def reset(self) -> FloatArray:
        """See `SimulatedBody`; nobody is pushed any more."""
        self.batch.xfrc_applied[:] = 0
        return super().reset()

    def push(self, force: FloatArray) -> None:
        """From now on (B, 3) or (3,) N act at the centre of mass of what is pushed, world axes; 0 lets go.

        Raises:
            BodyError: no force at all, or one beyond all bounds.
        """
        if not (np.abs(force) <= MOST_PUSH).all():
            raise BodyError(f"{self.name}: a push of {np.asarray(force).tolist()} N: {MOST_PUSH:g} N at most")
        self.batch.xfrc_applied[:, self._pushed, :3] = force

    @property
    def fallen(self) -> BoolArray:
        """(B,) who has fallen; for those who judge."""
        upright = self._turn[:, self._hips, 8]
        low = self._place[:, self._hips, 2] < FALLEN_HEIGHT * self._home
        return np.asarray((upright < np.cos(np.deg2rad(FALLEN_DEG))) | low)

    @property
    def lifted(self) -> FloatArray:
        """(B, 2) m that each foot is higher than at home; for those who judge."""
        return np.asarray(self._place[:, self._feet, 2] - self._floor)

    @property
    def configuration(self) -> FloatArray:
        """(B, nq) of the model now, its place and turn included: to draw it."""
        return np.array(self.batch.qpos)

    def touching(self, configurations: FloatArray) -> BoolArray:
        """(T,) whether parts of it touch each other in (T, nq) configurations; for those who judge."""
        data, found = mujoco.MjData(self.model), np.zeros(len(configurations), bool)
        for number, one in enumerate(configurations):
            data.qpos[:] = one
            mujoco.mj_fwdPosition(self.model, data)
            found[number] = (self.model.geom_bodyid[data.contact.geom] > 0).all(-1).any()
        return found

    def _awake(self) -> IntArray:
        """Who lies on the floor stays there."""
        return np.flatnonzero(~self.fallen)

    def _born(self, field: str) -> FloatArray:
        return self._individuals[field] if field in self._individuals else super()._born(field)
