"""How raw experience is read as (context, action, outcome): the seam between senses and a forward model."""

from typing import NamedTuple, Protocol

from babbling.axes import FloatArray
from babbling.schema import BodySchema


class Transitions(NamedTuple):
    """What a forward model counts; NaN marks "nothing to learn here for this factor"."""

    context: tuple[FloatArray, ...]
    """One (N, F) array per context axis."""
    action: FloatArray
    """(N, F)."""
    outcome: FloatArray
    """(N, F)."""


class Reading(Protocol):
    """Turns sensations before, commands, and sensations after into transitions."""

    def transitions(self, before: FloatArray, motors: FloatArray, after: FloatArray) -> Transitions:
        """(N, S), (N, M), (N, S) in; `Transitions` out."""


class Proprioception:
    """A servo's own view: how far beyond coasting did the posture come, given its speed and how far it was told to go.

    Law, per factor with posture q, rate v, commanded posture c:
    context v, action a = c - q, outcome w = q' - q - k v: the displacement beyond coasting, where k is how far a body
    moving at unit rate drifts in one tick when it is told to stay (a servo brakes: k is well below the tick).
    """

    def __init__(self, schema: BodySchema, coasting: FloatArray) -> None:
        self.schema, self.coasting = schema, coasting

    def transitions(self, before: FloatArray, motors: FloatArray, after: FloatArray) -> Transitions:
        """See the class."""
        q, v = before[:, self.schema.posture], before[:, self.schema.rate]
        outcome = after[:, self.schema.posture] - q - v * self.coasting
        return Transitions((v,), self.schema.efference(motors) - q, outcome)
