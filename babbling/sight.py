"""What was learned of looking, asked in the terms of looking."""

from dataclasses import dataclass

import numpy as np

from babbling.axes import FloatArray
from babbling.body import Body
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel
from babbling.looking import Looking, LookingPilot, Retina


class Sight:
    """The forward model of looking, asked in the terms of looking.

    Args:
        reading: how saccades are read.
        forward_model: what babbling counted.
    """

    def __init__(self, reading: Looking, forward_model: ForwardModel) -> None:
        self.reading, self.forward_model = reading, forward_model

    def expect(self, things: FloatArray, posture: FloatArray, change: FloatArray, *, table: bool = True) -> FloatArray:
        """(..., C) where things (..., C) will be after a saccade of both motors from (..., 2) by (..., 2), pixels.

        Chained: motor 0 at the present posture of motor 1, then motor 1 at the new posture of motor 0. Without `table`
        the efference copy alone: the least-squares peer.
        """
        coordinates = self.reading.retina.coordinates
        here, place = np.asarray(things, float), np.asarray(posture, float).copy()
        for motor in range(2):
            context, action = self.reading.situate(here, place, np.asarray(change, float))
            moved = self.reading.straight(context, action)
            if table:
                moved = moved + self.forward_model.expected(tuple(np.nan_to_num(c) for c in context), action)
            mine = moved[..., motor * coordinates : (motor + 1) * coordinates]
            here = here + np.where(np.abs(change[..., motor, None]) > 0, mine, 0.0)
            place[..., motor] += change[..., motor]
        return here


@dataclass(frozen=True)
class LookingMind:
    """What oculomotor babbling leaves: pilot and forward model."""

    pilot: LookingPilot
    forward_model: ForwardModel
    minutes: float
    """Body time of the babbling, the pilot's not counted in."""

    @property
    def reading(self) -> Looking:
        """How saccades are read."""
        return self.pilot.reading

    @property
    def sight(self) -> Sight:
        """The forward model in the terms of looking."""
        return Sight(self.reading, self.forward_model)

    def check(self, body: Body) -> None:
        """Refuse to look with somebody else's head.

        Raises:
            BabblingError: another body, or other retinas.
        """
        if self.pilot.fingerprint != body.fingerprint:
            raise BabblingError(
                f"these eyes were learned by another body (fingerprint {self.pilot.fingerprint}, this body has "
                f"{body.fingerprint}); babble anew"
            )
        retina = Retina.of(body)
        if not (np.array_equal(retina.centre, self.pilot.retina.centre)):
            size = (2 * self.pilot.retina.half[:2] + 1).astype(int)
            raise BabblingError(
                f"these eyes were learned with retinas of {size[0]} x {size[1]} pixels, this body has others; "
                "babble anew or give the same size"
            )
