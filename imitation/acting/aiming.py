"""Where to aim, by Eq. (1): P(aim | kind, primitive, state wanted), one factor for each way of aiming."""

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.play import EAGER, MIDDLE, SPREAD, Play
from imitation.inference.bayes import action_posterior, joint_likelihood
from imitation.inference.selection import selection_rule


def aims(
    play: Play, kind: int, which: IntArray, states: IntArray, selection: str, rng: np.random.Generator
) -> FloatArray:
    """(N, 5) aims (see `babbling.play.AIMS`) for primitives that are to bring states about; -1: anywhere.

    P(aim | ...) = c P(state | kind, primitive, aim)^EAGER, the prior flat: what was tried often is not thereby better.
    """
    likely = joint_likelihood([play.aimed(kind, which, states)], [np.full((len(which), 5), EAGER)])
    posterior = action_posterior(likely).probability
    return np.asarray(MIDDLE + SPREAD * selection_rule(selection)(posterior, play.aims.action, rng))
