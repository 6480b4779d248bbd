"""Seeing one's own hands and forehead as one moves: what a mirror is for directions, for places."""

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.body import SimulatedBody
from models.errors import BodyError
from models.objects.playing import MIDDLE
from models.robots import ROBOTS


class Hands:
    """Shows every copy of a seated body where its hands and forehead are, (B, P, 3) m from `MIDDLE`, with noise.

    Args:
        body: who looks.
        seed: randomness of what is seen.
        noise: standard deviation in every direction, m.
        outline: whether elbows and shoulders are looked at too.

    Raises:
        BodyError: a body that does not sit.
    """

    def __init__(self, body: SimulatedBody, seed: int, noise: float = 0.003, outline: bool = False) -> None:
        robot = ROBOTS.get(body.name)
        if robot is None or robot.seat is None:
            able = [name for name, one in ROBOTS.items() if one.seat]
            raise BodyError(f"{body.name}: it has no seat; these have: {', '.join(able)}")
        more = robot.seat.outline if outline else ()
        self.parts, self.noise = (*robot.seat.parts, *more), noise
        self._sites = [body.model.site(part).id for part in robot.seat.parts]
        self._bodies = [body.model.body(part).id for part in more]
        self._body, self._data = body, mujoco.MjData(body.model)
        self._rng = np.random.default_rng([seed, 0x5167])

    def look(self) -> FloatArray:
        """(B, P, 3) m as they are now."""
        found = self.at(np.asarray(self._body.batch.qpos))
        return np.asarray(found + self.noise * self._rng.standard_normal(found.shape))

    def at(self, configurations: FloatArray) -> FloatArray:
        """(N, P, 3) m, without noise, in (N, nq) configurations."""
        found, data = np.empty((len(configurations), len(self.parts), 3)), self._data
        for row, configuration in enumerate(configurations):
            data.qpos[:] = configuration
            mujoco.mj_kinematics(self._body.model, data)
            found[row] = np.concatenate([data.site_xpos[self._sites], data.xpos[self._bodies]]) - MIDDLE
        return found
