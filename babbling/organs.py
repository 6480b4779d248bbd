"""Organ identification: which of one's senses and motors belongs to which part that is seen (chapter, section 2.2).

After a single act one looks how far every part has turned. Counted over many acts this is a forward model without
context, one factor per part:

    P(amount turned of part p | motor m acted)          m = 0 .. F - 1, and F when nothing was moved

The mutual information between "m acted, or nothing did" and the amount says whether m moves p at all: the sparse
structure that makes a body of many joints tractable. Turned round by Eq. (1) the same table says which motor, and so
which part, somebody else has just moved (`imitation.correspondence.organ`).
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from babbling.axes import Axis, BoolArray, FloatArray, IntArray, same_axes
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel
from babbling.kinds import Numbers
from babbling.mirroring import ACT_S, HOLD_S, MirrorExperience, angles_between

EDGES_DEG = (1.0, 2.0, 4.0, 7.0, 12.0, 20.0, 35.0)
"""Amounts between two of these fall into one category; half a logarithmic step is about what acts differ by anyway."""
LABELS = tuple(f"{low:g}-{high:g} deg" for low, high in zip((0.0, *EDGES_DEG), (*EDGES_DEG, 180.0), strict=True))
IMAGINED = 0.5
"""Imagined visits of every category before any is seen (Jeffreys' prior), so that nothing is ruled out for good."""
LEAST_BITS = 0.35
"""Information from which a motor is first taken to move a part; the second look (`Organs.moves`) decides."""


@dataclass(frozen=True)
class Organs:
    """What acts showed.

    amounts: P(amount | motor or nothing), one factor per part. information: (P, F) bits.
    """

    amounts: Annotated[ForwardModel, Numbers("part")]
    information: Annotated[FloatArray, Numbers("part factor", "bit", low=0, high=64)]

    def __post_init__(self) -> None:
        if not same_axes(self.amounts.axes, empty_amounts(self.parts, self.information.shape[1]).axes):
            raise BabblingError("amounts turned are counted on other axes than organs need; look into the mirror anew")

    @property
    def parts(self) -> tuple[str, ...]:
        """P names."""
        return self.amounts.factors

    @property
    def moves(self) -> BoolArray:
        """(P, F) whether factor f moves part p.

        Two looks. The information picks clear movers; how they turn parts, and how the others do, then makes of every
        pair's acts a likelihood ratio: one clear turn outweighs several small ones.
        """
        moved, still = self._pooled(self.information >= LEAST_BITS)
        return np.asarray(self._counts[:, :-1] @ np.log(moved / still) > 0)

    def likelihood(self) -> FloatArray:
        """(P, F + 1, categories) P(amount | motor), the same for all pairs that move, and for all that do not.

        A motor acts a dozen times in a short babble, too seldom for a table of its own; all movers together act often.
        """
        moves = self.moves
        moved, still = self._pooled(moves)
        return np.asarray(np.where(self._with_nothing(moves)[..., None], moved, still))

    @property
    def _counts(self) -> FloatArray:
        return self.amounts.counts / self.amounts.unit

    def _pooled(self, moves: BoolArray) -> tuple[FloatArray, FloatArray]:
        """P(amount | moved) and P(amount | not moved)."""
        which = self._with_nothing(moves)
        moved, still = self._counts[which].sum(0) + IMAGINED, self._counts[~which].sum(0) + IMAGINED
        return moved / moved.sum(), still / still.sum()

    def _with_nothing(self, moves: BoolArray) -> BoolArray:
        return np.concatenate([moves, np.zeros((len(moves), 1), bool)], axis=1)


def categories(amounts: FloatArray) -> IntArray:
    """Category of (...) radians turned."""
    return np.asarray(np.searchsorted(np.deg2rad(EDGES_DEG), amounts, side="right").astype(np.int64))


def turned(before: FloatArray, after: FloatArray) -> FloatArray:
    """(...) radians between the means of (N, ..., 3) directions seen before and after."""
    first, second = before.mean(0), after.mean(0)
    first = first / np.linalg.norm(first, axis=-1, keepdims=True)
    second = second / np.linalg.norm(second, axis=-1, keepdims=True)
    return angles_between(first, second)


def empty_amounts(parts: tuple[str, ...], factors: int) -> ForwardModel:
    """The forward model of acts before any is seen."""
    labels = (*(f"motor {f}" for f in range(factors)), "nothing")
    motor = Axis.categorical("motor", labels, len(parts))
    return ForwardModel((), motor, Axis.categorical("amount", LABELS, len(parts)), factors=parts)


def find_organs(experience: MirrorExperience) -> Organs:
    """Count what every act turned.

    Raises:
        BabblingError: no act was completed, or nothing ever moved a part.
    """
    if not len(experience.acts):
        raise BabblingError("no single act was completed in front of the mirror; babble longer")
    factors, tick = experience.postures.shape[-1], experience.tick_s
    hold, act = round(HOLD_S / tick), round(ACT_S / tick)
    seen = experience.directions
    amounts = np.stack(
        [
            turned(seen[start - hold + 1 : start, copy], seen[start + act + 1 : start + act + hold, copy])
            for copy, start, _ in experience.acts
        ]
    )
    parts, model = len(experience.parts), empty_amounts(experience.parts, factors)
    model.observe((), np.repeat(experience.acts[:, 2:], parts, axis=1), categories(amounts))
    information = _information(model.counts / model.unit)
    if (information.max(1) < LEAST_BITS).any():
        part = experience.parts[int(np.argmax(information.max(1) < LEAST_BITS))]
        raise BabblingError(f"no motor was seen to move the {part}: babble longer in front of the mirror")
    return Organs(model, information)


def _information(counts: FloatArray) -> FloatArray:
    """(P, F) I(m acted or nothing did; amount), bits, both counted as equally likely; bias taken off (Miller 1955)."""
    acted, still = counts[:, :-1], counts[:, -1:]
    visits = np.maximum(np.minimum(acted.sum(-1), still.sum(-1)), 1)
    p = np.stack(np.broadcast_arrays(_shares(acted), _shares(still)), -1) / 2
    independent = p.sum(-1, keepdims=True) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        bits = np.where(p > 0, p * np.log2(p / independent), 0).sum((-1, -2))
    bias = (np.minimum(len(LABELS), 4) - 1) / (4 * visits * np.log(2))
    return np.asarray(np.maximum(bits - bias, 0))


def _shares(counts: FloatArray) -> FloatArray:
    return np.asarray(counts / np.maximum(counts.sum(-1, keepdims=True), 1))
