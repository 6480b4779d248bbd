"""Some motors of a body as a body of its own: the rest holds still at home."""

import numpy as np
from numpy.typing import NDArray

from models.body import SimulatedBody
from models.errors import BodyError, unknown

FloatArray = NDArray[np.float64]


class PartOfBody:
    """The named motors of a `SimulatedBody`, their angle and speed senses; same door, fewer lines.

    Raises:
        BodyError: a motor that the body does not have, or scrambled wiring (a part needs to know which lines are its).
    """

    def __init__(self, whole: SimulatedBody, motors: tuple[str, ...]) -> None:
        for name in motors:
            if name not in whole.joints:
                raise BodyError(unknown("joint with a motor", name, whole.joints))
        self.whole = whole
        self._lines = np.array([whole.joints.index(name) for name in motors])
        count = len(whole.joints)
        if not np.array_equal(whole.wiring.sense, np.arange(2 * count)):
            raise BodyError("a part of a body with scrambled wiring cannot be told from the rest; wire it straight")
        self._senses = np.concatenate([self._lines, count + self._lines])
        self.motor_low, self.motor_high = whole.motor_low[self._lines], whole.motor_high[self._lines]
        self.sense_low, self.sense_high = whole.sense_low[self._senses], whole.sense_high[self._senses]
        self.tick_s = whole.tick_s
        self.fingerprint = whole.fingerprint
        self._home = whole.command_angles(whole.joint_angles)

    @property
    def copies(self) -> int:
        """B, how many bodies there are."""
        return self.whole.copies

    @property
    def joint_angles(self) -> FloatArray:
        """(B, M) true angles; for those who judge."""
        return self.whole.joint_angles[:, self._lines]

    def reset(self) -> FloatArray:
        """All copies to rest; (B, S) sensations."""
        return self.whole.reset()[:, self._senses]

    def act(self, motors: FloatArray) -> FloatArray:
        """Hold (B, M) motor lines for one tick; (B, S) sensations."""
        command = self._home.copy()
        command[:, self._lines] = motors
        return self.whole.act(command)[:, self._senses]

    def command_angles(self, angles: FloatArray) -> FloatArray:
        """Motor lines (B, M) that command these angles (B, M)."""
        full = np.zeros((*np.shape(angles)[:-1], len(self.whole.joints)))
        full[..., self._lines] = angles
        return self.whole.command_angles(full)[..., self._lines]
