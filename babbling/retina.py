"""Where eyes stand among the senses."""

from typing import Annotated, NamedTuple

from babbling.axes import FloatArray
from babbling.body import Body
from babbling.kinds import Numbers


class Retina(NamedTuple):
    """Which sense lines are image coordinates: a baby is born with eyes, not with what they tell."""

    first: Annotated[int, Numbers(low=1, high=1000)]
    """Sense line of the first thing's first coordinate; before it stand the motors' senses."""
    coordinates: Annotated[int, Numbers(low=2, high=4)]
    """C, coordinates of one thing: u and v in one eye or in both."""
    centre: Annotated[FloatArray, Numbers("coordinate", "px")]
    """(C,) middle of the image along each coordinate, pixels."""
    half: Annotated[FloatArray, Numbers("coordinate", "px", low=0, zero=False)]
    """(C,) half of the image along each coordinate, pixels."""

    @classmethod
    def of(cls, body: Body, coordinates: int = 4) -> "Retina":
        """The usual layout: posture senses of the motors, then (u, v) in the left and right eye for each thing."""
        motors = len(body.motor_low)
        low, high = (v[motors : motors + coordinates] for v in (body.sense_low, body.sense_high))
        return cls(motors, coordinates, (low + high) / 2, (high - low) / 2)

    def things(self, senses: FloatArray) -> FloatArray:
        """(..., S) senses to (..., K, C) coordinates from the image's middle, NaN unseen."""
        seen = senses[..., self.first :]
        return seen.reshape(*seen.shape[:-1], -1, self.coordinates) - self.centre
