"""What babbling needs to know of a body: how many motors and senses, their ranges, and a way to act and feel."""

from typing import Protocol

from babbling.axes import FloatArray


class Body(Protocol):
    """Many copies of one body behind one door: motor commands in, sensations out, one control tick at a time.

    Nothing else may be asked of a body: no names that mean anything, no kinematics, no masses.
    """

    @property
    def copies(self) -> int:
        """B, how many copies act at once."""

    @property
    def motor_low(self) -> FloatArray:
        """(M,) least command of each motor."""

    @property
    def motor_high(self) -> FloatArray:
        """(M,) greatest command of each motor."""

    @property
    def sense_low(self) -> FloatArray:
        """(S,) least reading of each sense."""

    @property
    def sense_high(self) -> FloatArray:
        """(S,) greatest reading of each sense."""

    @property
    def tick_s(self) -> float:
        """Duration of one control tick, s."""

    @property
    def fingerprint(self) -> str:
        """Differs between bodies that feel different: a forward model belongs to one fingerprint."""

    def reset(self) -> FloatArray:
        """All copies back to rest; returns their (B, S) sensations. The same each time but for sensor noise."""

    def act(self, motors: FloatArray) -> FloatArray:
        """(B, M) commands, held for one tick; returns the (B, S) sensations at its end."""
