"""What a body risks while it moves: joints that run into their stops, servos that give all they have, parts that touch.

Counted by those who judge. On a stand, where contacts are off, parts that would touch are looked for in its posture.
"""

import copy
from typing import NamedTuple

import mujoco
import numpy as np

from models.arrays import BoolArray, FloatArray, IntArray
from models.body import SimulatedBody

STOP, IMPACT = 0.5, 30.0
"""How near the end of its range a joint is at its stop, and how fast it then comes to hit it: degrees and degrees a
second (mm of a slide)."""


class Risks(NamedTuple):
    """How much was risked so far, over all copies."""

    minutes: float
    """Body time."""
    stops_hit: int
    """How often a joint ran into the end of its range."""
    saturated_s: float
    """Seconds that a servo was asked for more than it has, all servos together."""
    touching_s: float
    """Seconds in which parts of the body touched, or would have."""

    def more(self, other: "Risks") -> "Risks":
        """Both together."""
        return Risks(
            self.minutes + other.minutes,
            self.stops_hit + other.stops_hit,
            self.saturated_s + other.saturated_s,
            self.touching_s + other.touching_s,
        )


class WatchedBody:
    """A body, and somebody who counts; see `babbling.body.Body`. It feels and does what the body alone would.

    A joint hits its stop in a tick in which it comes within `STOP` of it by `IMPACT` or faster, both by where it was at
    the tick's ends. A servo is saturated in a tick that begins with kp (command - q) - kv q' at its limit or beyond.
    Parts touch in a tick after which two of them do, of those that do not at rest.
    """

    def __init__(self, body: SimulatedBody) -> None:
        self.body, self._counts, model = body, np.zeros(4, int), body.model
        self.copies, self.tick_s, self.fingerprint = body.copies, body.tick_s, body.fingerprint
        self.motor_low, self.motor_high = body.motor_low, body.motor_high
        self.sense_low, self.sense_high = body.sense_low, body.sense_high
        self._low, self._high = body.joint_range.T
        self._near, self._fast = STOP / body.shown_scale, IMPACT * body.tick_s / body.shown_scale
        limits, servos = model.actuator_forcerange[body.actuators], body.actuators
        limited = model.actuator_forcelimited[servos].astype(bool)
        self._weakest, self._strongest = np.where(limited, limits.T, [[-np.inf], [np.inf]])
        self._kp, self._kv = model.actuator_gainprm[servos, 0], -model.actuator_biasprm[servos, 2]
        self._solid = copy.copy(model)
        self._solid.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        self._data, self._resting = mujoco.MjData(self._solid), set[tuple[int, int]]()
        body.reset()
        self._resting = self._pairs(body.batch.qpos[0])

    def reset(self) -> FloatArray:
        """See `SimulatedBody`; what was risked before still counts."""
        return self.body.reset()

    def act(self, motors: FloatArray) -> FloatArray:
        """See `SimulatedBody`."""
        before, speeds = self.body.joint_angles.copy(), self.body.joint_speeds.copy()
        felt = self.body.act(motors)
        asked = self._kp * (self.body.batch.ctrl[:, self.body.actuators] - before) - self._kv * speeds
        saturated = (asked <= self._weakest) | (asked >= self._strongest)
        hit, touching = self.hits(before, self.body.joint_angles), self.touching(self.body.batch.qpos)
        self._counts += [self.copies, hit.sum(), saturated.sum(), touching.sum()]
        return felt

    @property
    def risks(self) -> Risks:
        """Of all that it did since it is watched."""
        ticks, hits, saturated, touching = self._counts.tolist()
        return Risks(ticks * self.tick_s / 60, hits, saturated * self.tick_s, touching * self.tick_s)

    def hits(self, before: FloatArray, after: FloatArray) -> BoolArray:
        """(B, M) which joints hit a stop in the tick between these (B, M) postures."""
        moved = after - before
        low, high = after <= self._low + self._near, after >= self._high - self._near
        return np.asarray((low & (moved <= -self._fast)) | (high & (moved >= self._fast)))

    def touching(self, configurations: FloatArray) -> BoolArray:
        """(N,) whether parts touch in (N, nq) configurations that do not touch at rest."""
        return np.array([not self._pairs(one) <= self._resting for one in configurations], bool)

    def _pairs(self, configuration: FloatArray) -> set[tuple[int, int]]:
        """Bodies that touch."""
        self._data.qpos[:] = configuration
        mujoco.mj_kinematics(self._solid, self._data)
        mujoco.mj_comPos(self._solid, self._data)
        mujoco.mj_collision(self._solid, self._data)
        bodies: IntArray = self._solid.geom_bodyid[self._data.contact.geom]
        return {(min(pair), max(pair)) for pair in bodies.tolist()}
