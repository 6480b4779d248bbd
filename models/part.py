"""Some motors of a body as a body of its own: the rest holds still at home."""

import numpy as np

from models.arrays import FloatArray
from models.body import SimulatedBody
from models.errors import BodyError, unknown
from models.senses import Senses


class PartOfBody:
    """The named motors of a `SimulatedBody`, their angle and speed senses, in that order; same door, fewer lines.

    Raises:
        BodyError: a motor that the body does not have.
    """

    def __init__(self, whole: SimulatedBody, motors: tuple[str, ...]) -> None:
        for name in motors:
            if name not in whole.joints:
                raise BodyError(unknown("joint with a motor", name, whole.joints))
        self.whole = whole
        self._joints = np.array([whole.joints.index(name) for name in motors])
        self._motors = whole.wiring.motor[self._joints]
        self.senses = Senses([whole.senses[name].only(motors) for name in ("angle", "speed")])
        self._lines = np.concatenate([whole.senses.lines(name, motors) for name in self.senses.channels])
        self.motor_low, self.motor_high = whole.motor_low[self._motors], whole.motor_high[self._motors]
        self.sense_low, self.sense_high = self.senses.low, self.senses.high
        self.tick_s = whole.tick_s
        self.fingerprint = whole.fingerprint
        self.motor_labels = tuple(motors)  # for people only
        self._home = whole.command_angles(whole.joint_angles)

    @property
    def copies(self) -> int:
        """B, how many bodies there are."""
        return self.whole.copies

    @property
    def joint_angles(self) -> FloatArray:
        """(B, M) true angles; for those who judge."""
        return self.whole.joint_angles[:, self._joints]

    def reset(self) -> FloatArray:
        """All copies to rest; (B, S) sensations."""
        return np.take(self.whole.reset(), self._lines, axis=-1)

    def act(self, motors: FloatArray) -> FloatArray:
        """Hold (B, M) motor lines for one tick; (B, S) sensations."""
        command = self._home.copy()
        command[:, self._motors] = motors
        return np.take(self.whole.act(command), self._lines, axis=-1)

    def command_angles(self, angles: FloatArray) -> FloatArray:
        """Motor lines (B, M) that command these angles (B, M)."""
        full = np.zeros((*np.shape(angles)[:-1], len(self.whole.joints)))
        full[..., self._joints] = angles
        return self.whole.command_angles(full)[..., self._motors]
