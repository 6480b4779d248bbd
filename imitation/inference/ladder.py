"""The ladder of fallbacks: who decides where Eq. (1) cannot.

Eq. (1) with its prior; where that is 0/0, the forward model alone (a uniform prior); and a last resort that always
answers: the least-squares line of the same experience for measured axes, chance for categories. Which rungs there are
is data, the first that can decides, and every decision says its rung, so that whoever asks can count them.
"""

from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babbling.axes import BoolArray, FloatArray
from imitation.inference.bayes import Posterior, action_posterior


class Rung(IntEnum):
    """Who decides, from the top."""

    INVERSE = 0
    """The inverse model itself: Eq. (1) with its prior."""
    FORWARD_ALONE = 1
    """Eq. (1) with a uniform prior."""
    LINE = 2
    """The least-squares line; a last resort."""
    CHANCE = 3
    """All actions alike; a last resort."""


MEASURED = (Rung.INVERSE, Rung.LINE)
"""Where all axes are measured."""
CATEGORIES = (Rung.INVERSE, Rung.FORWARD_ALONE, Rung.CHANCE)
"""Where axes are categories."""


class Decision(NamedTuple):
    """What the ladder said."""

    posterior: Posterior
    """(..., A) the probability of the rung that decided (a line has none: it is as Eq. (1) left it); evidence and
    `informed` are always those of Eq. (1)."""
    rung: NDArray[np.int8]
    """(...) the `Rung` that decided."""


def descend(
    likelihood: FloatArray, prior: ArrayLike | None, ladder: Sequence[Rung], beyond: BoolArray | bool = False
) -> Decision:
    """Eq. (1) and, where it is 0/0, the next rung that can decide.

    Args:
        likelihood: (..., A) as in `action_posterior`.
        prior: (..., A), or None for uniform.
        ladder: the rungs from `INVERSE` down, with or without `FORWARD_ALONE`, to one last resort.
        beyond: (...) what no table knows (off its axes): the last resort decides.
    """
    bayes = action_posterior(likelihood, prior)
    undecided = np.logical_not(bayes.informed) | beyond
    rung = np.zeros(undecided.shape, np.int8)
    if not undecided.any():
        return Decision(bayes, rung)
    probability = bayes.probability
    rung[undecided] = ladder[-1]
    if Rung.FORWARD_ALONE in ladder:
        alone = action_posterior(likelihood)
        able = undecided & alone.informed & np.logical_not(beyond)
        probability = np.where(able[..., None], alone.probability, probability)
        rung[able] = Rung.FORWARD_ALONE
    probability = np.where((rung == Rung.CHANCE)[..., None], 1.0 / likelihood.shape[-1], probability)
    return Decision(Posterior(probability, bayes.evidence, bayes.informed), rung)
