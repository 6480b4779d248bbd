"""Peers of the averaged model in the very same loop: simpler ways to choose an action, fitted to the same babbling."""

from collections.abc import Sequence

import numpy as np

from babbling.axes import FloatArray
from babbling.explanations import Explanations
from babbling.frame import RIDGE
from imitation.inference.inverse import Term
from imitation.inference.moving import Decided, Here


class ForwardLine:
    """w = b_0 + b_1 v + b_2 a by least squares, solved for a; it also expects that."""

    def __init__(self, model: Explanations) -> None:
        self.weights = model.fit("line").coefficients[:, 0]

    def choose(self, here: Here, wanted: FloatArray, terms: Sequence[Term], rng: np.random.Generator) -> Decided:
        """See `MovingInverse`; it knows nothing of other terms."""
        stay, coast, pull = self.weights.T
        return Decided.bare((wanted - stay - coast * here.rate) / pull)

    def expect(self, here: Here, command: FloatArray) -> FloatArray:
        """See `MovingInverse`."""
        stay, coast, pull = self.weights.T
        return np.asarray(stay + coast * here.rate + pull * (command - here.posture))


class InverseLine(ForwardLine):
    """a = b_0 + b_1 v + b_2 w by least squares; it expects what the forward line does."""

    def __init__(self, model: Explanations) -> None:
        super().__init__(model)
        self.inverse = model.sums.fit(["action"], ["rate", "outcome"], RIDGE).coefficients[:, 0]

    def choose(self, here: Here, wanted: FloatArray, terms: Sequence[Term], rng: np.random.Generator) -> Decided:
        """See `MovingInverse`."""
        stay, coast, pull = self.inverse.T
        return Decided.bare(stay + coast * here.rate + pull * wanted)
