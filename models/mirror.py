"""A mirror: where one's own body parts are seen to point, in one's own torso's frame.

The mirror belongs to the world. It shows a direction per part and nothing else: no joint, no length, no name of a
motor. Whoever looks has to find out by moving which sense goes with which part.
"""

from collections.abc import Iterator

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.body import SimulatedBody
from models.errors import BodyError
from models.robots import limbs_of
from models.teachers.performance import unit

TORSO = "torso"


class Mirror:
    """Shows every copy of a body its own limb directions.

    Args:
        body: who looks; its joints must be those of a robot with limbs.
        noise: standard deviation of what is seen, rad in each direction across the line of sight (see `blurred`).
        seed: randomness of that noise.

    Raises:
        BodyError: a body without limbs to show, or without a torso.
    """

    def __init__(self, body: SimulatedBody, noise: float = 0.0, seed: int = 0) -> None:
        limbs = limbs_of(body.name, body.joints)
        self.parts = tuple(limbs)
        self.noise = noise
        self._body, self._data = body, mujoco.MjData(body.model)
        self._rng = np.random.default_rng([seed, 0x3177])
        bodies = {body.model.body(i).name: i for i in range(body.model.nbody)}
        if TORSO not in bodies:
            raise BodyError(f"{body.name}: directions are seen from a torso, and no body of it is called {TORSO!r}")
        self._torso = bodies[TORSO]
        self._carriers = [self._carrier(int(body.model.joint(limbs[part].joint).bodyid[0])) for part in self.parts]
        self._axes = np.array([limbs[part].axis for part in self.parts], dtype=float)

    def _carrier(self, moved: int) -> int:
        """The body that a joint moves, as the torso sees it: of one held by its pelvis, what holds the torso."""
        above, model = self._torso, self._body.model
        while above and above != moved:
            above = int(model.body_parentid[above])
        return int(model.body_parentid[moved]) if above else moved

    def look(self) -> FloatArray:
        """(B, P, 3) unit vectors of all parts of all copies as they stand now, with noise."""
        return blurred(self._shown(np.asarray(self._body.batch.qpos)), self.noise, self._rng)

    def shown(self, angles: FloatArray) -> FloatArray:
        """(T, P, 3) true directions at (T, J) joint angles, for those who judge."""
        return self._shown(self._body.configurations(angles))

    def arrows(self, angles: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(T, P, 3) m where the parts begin in the world at (T, J) joint angles, and (T, P, 3) unit vectors along which
        they point there: for pictures."""
        placed = list(self._placed(self._body.configurations(angles)))
        begins, pointing, _ = (np.stack(each) for each in zip(*placed, strict=True))
        return begins, pointing

    def _shown(self, configurations: FloatArray) -> FloatArray:
        found = np.empty((len(configurations), len(self.parts), 3))
        for row, (_, pointing, torso) in enumerate(self._placed(configurations)):
            found[row] = pointing @ torso
        return found

    def _placed(self, configurations: FloatArray) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
        """Of every configuration (P, 3) where parts begin and point in the world, and the torso's (3, 3) rotation."""
        data = self._data
        for configuration in configurations:
            data.qpos[:] = configuration
            mujoco.mj_kinematics(self._body.model, data)
            turns = data.xmat.reshape(-1, 3, 3)
            pointing = np.einsum("pij,pj->pi", turns[self._carriers], self._axes)
            yield data.xpos[self._carriers], pointing, np.array(turns[self._torso])


def blurred(directions: FloatArray, noise: float, rng: np.random.Generator) -> FloatArray:
    """The same (..., 3) unit vectors seen with noise: unit(d + e), e ~ N(0, noise^2 I).

    Across the line of sight that is `noise` radians along either axis, so the mean angle off is sqrt(pi / 2) noise
    (3.8 degrees for 3). No noise gives the very same numbers.
    """
    if noise <= 0:
        return np.array(directions, dtype=float)
    return unit(directions + noise * rng.standard_normal(np.shape(directions)))
