"""What may come of acting here: the forward model (`babbling.explanations`) at some state, asked for many commands."""

from typing import NamedTuple, Protocol

import numpy as np

from babbling.axes import Axis, BoolArray, Cells, FloatArray, IntArray
from babbling.features import BEFORE, COLUMNS, PLAYS, Echo, Features, along
from babbling.forward_model import ForwardModel
from babbling.frame import Frame

_PLAYS = slice(len(BEFORE), len(BEFORE) + len(PLAYS))
_DEAD = slice(_PLAYS.stop, len(COLUMNS))


class Trusted(NamedTuple):
    """The part of the table that is asked: of the K factors whose average it is part of."""

    factors: IntArray
    """(K,) which."""
    weights: FloatArray
    """(K,) P_e of the table."""
    rate: Axis
    effort: Axis
    mean: FloatArray
    """(K, rates, efforts) expected departures."""


class Averaged(Protocol):
    """Rival explanations as one (`babbling.explanations.Explanations`)."""

    frame: Frame
    features: Features
    table: ForwardModel

    @property
    def averaged(self) -> FloatArray:
        """(F, COLUMNS + 2 F) lines, averaged."""

    @property
    def habit(self) -> tuple[FloatArray, FloatArray]:
        """(F, BEFORE) line through what babbling did, and (F,) how far off it is."""

    @property
    def trusted(self) -> Trusted:
        """What is asked of the table."""


class Outlook(NamedTuple):
    """The forward model at some state: all that does not depend on the action has been worked out."""

    explanations: Averaged
    posture: FloatArray
    """(..., F)."""
    echo: Echo
    before: FloatArray
    """(..., F, BEFORE)."""
    fixed: FloatArray
    """(..., F) what is expected of no effort at all."""
    cells: Cells
    """Where the rates of the `Trusted` factors lie in the table."""
    centre: FloatArray
    """(..., F) the effort that one is used to here."""

    def expected(self, command: FloatArray) -> FloatArray:
        """(n..., ..., F) E[w | x] of commands."""
        known, plays = self.explanations, self._plays(command)
        effort = known.features.effort(plays)
        mean = self.fixed + along(plays, known.averaged[:, _PLAYS])
        mean += along(known.features.dead(effort), known.averaged[:, _DEAD])
        if len(some := known.trusted.factors):
            there = self._cells(mean.ndim).on(known.trusted.effort, self._bent(effort, some))
            mean[..., some] += known.trusted.weights * there.read(known.trusted.mean)
        return np.asarray(mean)

    @property
    def usual(self) -> FloatArray:
        """(..., F) the action c - q that one is used to here."""
        return np.asarray(along(self.before, self.explanations.habit[0]))

    def familiarity(self, command: FloatArray) -> FloatArray:
        """(..., F) visits that the cell nearest to (..., F) commands had while babbling."""
        known, every = self.explanations, np.arange(command.shape[-1])
        paces = np.arcsinh(self.before[..., 1] / known.frame.bend[:, 0])
        return known.table.at((paces,)).familiarity(self._bent(self._effort(command), every))

    def beyond(self, command: FloatArray) -> BoolArray:
        """(..., F) where (..., F) commands are off the table's axes, and the table is trusted."""
        known, found = self.explanations, np.zeros(command.shape, bool)
        if len(some := known.trusted.factors):
            there = self._cells(command.ndim).on(known.trusted.effort, self._bent(self._effort(command), some))
            found[..., some] = ~there.inside
        return found

    def _cells(self, ndim: int) -> Cells:
        return self.cells.ahead(ndim - self.fixed.ndim)

    def _effort(self, command: FloatArray) -> FloatArray:
        return self.explanations.features.effort(self._plays(command))

    def _plays(self, command: FloatArray) -> FloatArray:
        return self.explanations.features.plays(self.echo, command) - self.posture[..., None]

    def _bent(self, effort: FloatArray, some: IntArray) -> FloatArray:
        """(..., K) efforts of some factors, on the table's axis."""
        bend = self.explanations.frame.bend[some, 1]
        return np.asarray(np.arcsinh((effort[..., some] - self.centre[..., some]) / bend))
