"""Which part does somebody else move? Organ identification comes before matching (chapter, section 2.2).

Two questions, each Eq. (1) on what one's own single acts left (`babbling.organs`). *Did anything move?* How far every
part has turned is the outcome of the table that was counted,

    P(motor m | amounts seen) = c prod_p P(amount of p | m) P(m),       m = 0 .. F - 1, or nothing.

*Which part was it?* Others' acts are larger or smaller than one's own, are seen through another haze, and have other
parts moving along, so size and noise of the act are unknown: amounts = a + b (whether m moves p) + noise, with b > 0.
With Zellner's unit-information prior on b, and a and the noise integrated out, the likelihood of m needs only the
correlation r of the amounts with what m moves (Liang et al. 2008, J Am Stat Assoc 103:410; n amounts, g = n):

    P(amounts | m) ~ (1 + n)^((n - 2) / 2) (1 + n (1 - r^2))^(-(n - 1) / 2).

The organ is the part whose own motors share most of the posterior. Own motors of a part are those that move it but no
part nearer the torso (the elbow for the forearm; the shoulder, which moves both, for the upper arm).
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
    return np.asarray(np.where(moves.any(0), sizes.argmin(0), -1))


def edge_ticks(tick_s: float) -> int:
    """Ticks at either end of an act that are averaged."""
    return max(round(EDGE_S / tick_s), 1)


def identify(organs: Organs, seen: FloatArray, tick_s: float) -> Organ:
    """What moved in (T, P, 3) directions of one act; NaN where a part is not seen."""
    edge = edge_ticks(tick_s)
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
    nothing = action_posterior(np.exp(log - log.max()), prior / prior.sum()).probability[-1]
    moved = action_posterior(
        pattern_likelihood(amounts[there], organs.moves[there]), prior[:-1] / prior[:-1].sum()
    ).probability
    shares = np.array([*((1 - nothing) * moved[owner == part].sum() for part in range(len(organs.parts))), nothing])
    best = int(shares.argmax())
    return Organ(best if best < len(organs.parts) else -1, shares)


def pattern_likelihood(amounts: FloatArray, moves: BoolArray) -> FloatArray:
    """(F,) likelihood of (N,) amounts, rad, up to a factor; each motor moves (N, F) parts, how far and how noisily is
    unknown; see above."""
    x, y = np.pad(moves, ((0, 1), (0, 0))).astype(float), np.pad(amounts, (0, 1))  # the torso last
    n, x, y = len(y), x - x.mean(0), y - y.mean()
    length = np.linalg.norm(x, axis=0) * np.linalg.norm(y)
    r = np.clip(np.divide(y @ x, length, out=np.zeros_like(length), where=length > 1e-12), 0.0, 1.0)
    return np.asarray((1.0 + n) ** ((n - 2) / 2) * (1 + n * (1 - r**2)) ** (-(n - 1) / 2))
