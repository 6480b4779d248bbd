"""What was learned of looking, asked in the terms of looking."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from babbling.axes import FloatArray
from babbling.body import Body
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel, same_axes
from babbling.kinds import Numbers, kind
from babbling.looking import LookingPilot, Retina, copy_terms


@kind("eyes", "`imitate saccades` leaves such files")
@dataclass(frozen=True)
class LookingMind:
    """What oculomotor babbling leaves: pilot and forward model."""

    pilot: LookingPilot
    forward_model: Annotated[ForwardModel, Numbers("factor")]
    minutes: Annotated[float, Numbers(unit="min", low=0, high=1e6)]
    """Body time of the babbling, the pilot's not counted in."""

    def __post_init__(self) -> None:
        terms = copy_terms(*np.zeros((2 + len(self.pilot.reach.low), 1))).shape[-1]
        fits = same_axes(self.forward_model.axes, self.pilot.forward_model().axes)
        if not fits or self.pilot.line.shape[-1] != terms:
            raise BabblingError("the forward model has other axes than its pilot found; babble anew")

    def expect(self, things: FloatArray, posture: FloatArray, change: FloatArray, *, table: bool = True) -> FloatArray:
        """(..., C) where things (..., C) will be after a saccade of all motors from (..., M) by (..., M), pixels.

        Chained: each motor at the new postures of those before it and the present ones of those after it. Without
        `table` the efference copy alone: the least-squares peer.
        """
        pilot = self.pilot
        here, place = np.asarray(things, float), np.asarray(posture, float).copy()
        for motor in range(place.shape[-1]):
            context, action = pilot.situate(here, place, np.asarray(change, float))
            moved = pilot.straight(context, action)
            if table:
                moved = moved + self.forward_model.expected(tuple(np.nan_to_num(c) for c in context), action)
            here = here + np.where(np.abs(change[..., motor, None]) > 0, moved[..., pilot.motor == motor], 0.0)
            place[..., motor] += change[..., motor]
        return here

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
