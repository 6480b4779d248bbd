"""Which part does somebody else move? Organ identification comes before matching (chapter, section 2.2).

Eq. (1) on the table that one's own single acts left (`babbling.organs`): how far every part has turned is the outcome,

    P(motor m | amounts seen) = c prod_p P(amount of p | m) P(m),

and the organ is the part whose own motors share most of that posterior. Own motors of a part are those that move it
but no part nearer the torso (the elbow for the forearm; the shoulder, which moves both, for the upper arm).
"""

from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.organs import Organs, categories, turned
from imitation.inference.bayes import action_posterior

EDGE_S = 0.12
"""Time at the beginning and at the end of an act over which directions are averaged."""
FORGIVING = 0.01
"""Share of acts in which a part of somebody else turns in a way one's own acts never showed."""


class Organ(NamedTuple):
    """part: number of the part identified, -1 for nothing; probability (P + 1,) over parts and nothing."""

    part: int
    probability: FloatArray


def owners(moves: BoolArray) -> IntArray:
    """(F,) the part each factor belongs to: of those it moves the one that fewest factors move; -1 for none."""
    sizes = np.where(moves, moves.sum(1, keepdims=True), np.inf)
    nearest: IntArray = np.where(moves.any(0), sizes.argmin(0), -1)
    return nearest


def identify(organs: Organs, seen: FloatArray, tick_s: float) -> Organ:
    """What moved in (T, P, 3) directions of one act; NaN where a part is not seen."""
    edge = max(round(EDGE_S / tick_s), 1)
    amounts = turned(seen[:edge], seen[-edge:])
    there = np.isfinite(amounts)
    likelihood = organs.likelihood()
    likelihood = (1 - FORGIVING) * likelihood + FORGIVING / likelihood.shape[-1]
    bins = categories(np.where(there, amounts, 0.0))
    each = np.take_along_axis(likelihood, bins[:, None, None], axis=2)[..., 0]  # (P, F + 1)
    log = np.log(each[there]).sum(0)
    owner = owners(organs.moves)
    prior = np.zeros(len(owner) + 1)
    for part in range(len(organs.parts)):  # every part, and nothing, is as likely beforehand
        prior[:-1][owner == part] = 1 / max((owner == part).sum(), 1)
    prior[-1] = 1.0
    posterior = action_posterior(np.exp(log - log.max()), prior / prior.sum()).probability
    shares = np.array([*(posterior[:-1][owner == part].sum() for part in range(len(organs.parts))), posterior[-1]])
    best = int(shares.argmax())
    return Organ(best if best < len(organs.parts) else -1, shares)
