"""What a babbler has learned of its own body: the pilot's findings and the counts, bound to the body that felt them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from babbling.axes import FloatArray
from babbling.body import Body, OfOneBody
from babbling.errors import BabblingError
from babbling.explanations import Explanations
from babbling.kinds import Numbers, kind
from babbling.loop import babble, bouts
from babbling.pilot import Pilot, begin


@dataclass(frozen=True)
class Temper:
    """How a mind acts on what it knows."""

    eagerness: Annotated[FloatArray, Numbers("motor", low=0, high=2, zero=False)]
    """(F,) share of the believed error to be undone within one tick, found by rehearsal
    (`imitation.acting.rehearsal`)."""
    trust: Annotated[FloatArray, Numbers("motor", low=0, high=100)]
    """(F,) exponent of the habit P(a | s) as the prior of Eq. (1): 1 trusts it, 0 is the uniform prior; found by
    rehearsal too."""
    simple: Annotated[FloatArray, Numbers("motor", low=0, high=1)]
    """(F,) 1 where the line alone is asked what to do, 0 where all explanations are: one may foretell better and yet be
    of no use backwards (where most of an action's effect comes a tick later, its inverse rings); rehearsal tells."""

    @classmethod
    def cautious(cls, factors: int) -> "Temper":
        """Before any rehearsal: half the error, little trust in habit."""
        return cls(np.full(factors, 0.5), np.full(factors, 0.1), np.zeros(factors))


@kind("mind", "make one with `imitate babble`")
@dataclass(frozen=True)
class Mind(OfOneBody):
    """Body schema, axes, dynamics (`pilot`) and forward model of one body."""

    fingerprint: str
    """Of the body that babbled; see `babbling.body.Body`."""
    seed: Annotated[int, Numbers(low=0, high=2**63)]
    pilot: Pilot
    forward_model: Explanations
    temper: Temper

    def __post_init__(self) -> None:
        if not self.forward_model.frame.same(self.pilot.frame):
            raise BabblingError("the forward model has another frame than its pilot found; babble anew")
        if len(self.pilot.schema.rate) != len(self.pilot.schema.posture):
            raise BabblingError("each motor needs a sense that says how fast it moves; babble anew")


def learn(
    body: Body, *, minutes: float, seed: int, after_bout: Callable[[int, Explanations], None] = lambda bout, model: None
) -> Mind:
    """Pilot and `minutes` of babbling (chapter, section 3.1): everything a mind knows of its body.

    Args:
        body: who babbles.
        minutes: body time over all copies, the pilot's not counted in.
        seed: randomness; the same seed gives the same mind, bit for bit.
        after_bout: see `babbling.loop.babble`.
    """
    plan = bouts(minutes, body)
    found, begun = begin(body, seed)
    model = babble(body, found, plan, seed, onto=begun, after_bout=after_bout)
    return Mind(body.fingerprint, seed, found, model, Temper.cautious(len(model.factors)))
