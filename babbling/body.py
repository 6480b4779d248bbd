"""What babbling needs to know of a body: how many motors and senses, their ranges, and a way to act and feel."""

from typing import Protocol

from babbling.axes import FloatArray
from babbling.errors import BabblingError


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


class OfOneBody:
    """Whatever was learned with one body and is of no use to another."""

    fingerprint: str

    def check(self, body: Body) -> None:
        """Refuse to act with somebody else's body.

        Raises:
            BabblingError: the fingerprints differ.
        """
        if self.fingerprint != body.fingerprint:
            raise BabblingError(
                f"this was learned by another body (fingerprint {self.fingerprint}, this body has {body.fingerprint}): "
                "the same robot, wear and scramble are needed; babble anew"
            )
