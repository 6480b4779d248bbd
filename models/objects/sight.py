"""Seeing one's own hands and forehead as one moves: what a mirror is for directions, for places."""

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.body import SimulatedBody
from models.errors import BodyError
from models.objects.playing import MIDDLE
from models.robots import ROBOTS


class Hands:
    """Shows every copy of a seated body where its hands and forehead are, (B, 3, 3) m from `MIDDLE`, with noise.

    Args:
        body: who looks.
        seed: randomness of what is seen.
        noise: standard deviation in every direction, m.

    Raises:
        BodyError: a body that does not sit.
    """

    def __init__(self, body: SimulatedBody, seed: int, noise: float = 0.003) -> None:
        robot = ROBOTS.get(body.name)
        if robot is None or robot.seat is None:
            able = [name for name, one in ROBOTS.items() if one.seat]
            raise BodyError(f"{body.name}: it has no seat; these have: {', '.join(able)}")
        self.parts, self.noise = robot.seat.parts, noise
        self._sites = [body.model.site(part).id for part in self.parts]
        self._body, self._data = body, mujoco.MjData(body.model)
        self._rng = np.random.default_rng([seed, 0x5167])

    def look(self) -> FloatArray:
        """(B, 3, 3) m as they are now."""
        found, data = np.empty((self._body.copies, len(self.parts), 3)), self._data
        for copy, configuration in enumerate(np.asarray(self._body.batch.qpos)):
            data.qpos[:] = configuration
            mujoco.mj_kinematics(self._body.model, data)
            found[copy] = data.site_xpos[self._sites] - MIDDLE
        return found + self.noise * self._rng.standard_normal(found.shape)
