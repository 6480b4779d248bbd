"""The forward model of one's own movements: rival explanations, averaged by how well each foretold what happened.

Chapter, section 3.1: P(s_{t+1} | s_t, a_t) is learned from babbling. Which kind of law a joint obeys is not known, so
several are kept (`babbling.features`): lines in few and in many features, of the joint alone or of the whole body, and
a Dirichlet table that counts by how much the displacement departs from a joint's richest line, given rate and effort.
Each tells a mean m_e and an error s_e:

    E[w | x] = sum_e P_e m_e(x),     log P_e = sum over new experience of log N(w; m_e(x), s_e^2)  + const.

P_e is the evidence, accumulated prequentially: experience is foretold first and counted afterwards (Dawid 1984), so an
explanation that only fits what it has seen gains nothing. With little experience the simplest line wins; where the
world is not a line the table does. Lines are conjugate Gaussian, the table is Dirichlet; all counts are sums of
integers, so what was learned apart is merged by adding.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray, located, same_axes
from babbling.errors import BabblingError
from babbling.features import BEFORE, COLUMNS, LINES, Echo, along, names, weighing
from babbling.forward_model import ForwardModel
from babbling.frame import RIDGE, Frame, whole
from babbling.kinds import Numbers
from babbling.outlook import Outlook, Trusted
from babbling.regression import LinearFit

EXPLANATIONS = (*LINES, "table")
PRIOR_STRENGTH = 20.0
"""Pseudo-counts of the table's linear-Gaussian prior."""
BLOCK = 512
"""Experience is foretold and counted in blocks of at least so many transitions, and of a quarter of what is known."""
SURPRISE = 36.0  # squared error, in units of s_e^2, beyond which a transition says no more against an explanation
UNBELIEVED = 1e15  # nats of evidence against an explanation that is not to be asked
NOTICED = 1e-3  # an explanation that is less probable is not asked
_BEFORE, _OWN = len(BEFORE), len(COLUMNS)


@dataclass(eq=False)
class Explanations:
    """Rival explanations of w, the displacement beyond coasting, of F factors; see the module.

    Begun with the pilot's frame by `empty`; learns by `observe`.
    """

    frame: Frame
    table: Annotated[ForwardModel, Numbers("motor")]
    """P(departure | rate, effort), on bent axes."""
    moments: Annotated[IntArray, Numbers("motor term term_", low=-(2.0**62), high=2.0**62)]
    """(F, C + 2 F + 1, C + 2 F + 1) `LinearGaussian.sums` of the columns and w."""
    evidence: Annotated[FloatArray, Numbers("motor explanation", "nat", low=-UNBELIEVED, high=UNBELIEVED)]
    """(F, E) log P_e, up to a constant."""
    squares: Annotated[FloatArray, Numbers("motor explanation", low=0, high=1e12)]
    """(F, E) sum of the squared errors of foretelling."""
    foretold: Annotated[FloatArray, Numbers("motor", low=0, high=1e15)]
    """(F,) transitions that were foretold."""

    def __post_init__(self) -> None:
        frame, factors = self.frame, len(self.table.factors)
        self.features, self.sums, self.paced = frame.features, frame.nothing(), np.zeros(factors, bool)
        if not same_axes(self.table.axes, (frame.rate, frame.effort, frame.departure)) or (
            self.moments.shape != self.sums.sums.shape or self.evidence.shape != (factors, len(EXPLANATIONS))
        ):
            raise BabblingError("the forward model was learned with other features; babble anew")
        self.sums.sums = self.moments

    @classmethod
    def empty(cls, frame: Frame, fingerprint: str) -> "Explanations":
        """Nothing counted yet."""
        factors, explanations = len(frame.bend), len(EXPLANATIONS)
        table = ForwardModel(
            (frame.rate,),
            frame.effort,
            frame.departure,
            factors=[f"motor {f}" for f in range(factors)],
            prior_strength=PRIOR_STRENGTH,
            fingerprint=fingerprint,
        )
        terms = 1 + frame.reach.shape[1]
        nothing = np.zeros((3, factors, explanations))
        return cls(frame, table, np.zeros((factors, terms, terms), np.int64), nothing[0], nothing[1], nothing[2, :, 0])

    @property
    def factors(self) -> tuple[str, ...]:
        """One label per factor, for people."""
        return self.table.factors

    @property
    def transitions(self) -> int:
        """How many transitions were learned, all factors together."""
        return int(self.sums.samples.sum())

    @property
    def outside(self) -> IntArray:
        """(F,) transitions that fell off the table's axes."""
        return self.table.outside

    # ---------------------------------------------------------------- learning

    def observe(
        self,
        columns: FloatArray,
        outcome: FloatArray,
        *,
        foretell: bool = True,
        after_block: Callable[[], None] = lambda: None,
    ) -> None:
        """Foretell, then count: (N, F, COLUMNS + 2 F) and (N, F), in the order in which they happened; whoever looks on
        (`after_block`) does so between two blocks, where all is consistent."""
        start = 0
        while start < len(outcome):
            size = max(BLOCK, int(self.sums.samples.min()) // 4)
            x, w = columns[start : start + size], outcome[start : start + size]
            if foretell and self.sums.samples.min() > 2 * len(COLUMNS):
                self._foretell(x, w)
            self.sums.observe(np.concatenate([x[..., 1:], w[..., None]], axis=-1), np.ones(w.shape, bool))
            rate, effort = self.frame.bent(x)
            self.table.observe((rate,), effort, w - (x[..., :_OWN] * self.frame.line).sum(-1))
            self._forget()
            start += size
            after_block()

    def _foretell(self, columns: FloatArray, outcome: FloatArray) -> None:
        error = (outcome[..., None] - self.foretold_by(columns)) ** 2
        variance = self.errors**2
        self.evidence -= (np.log(variance) / 2 + np.minimum(error / variance, SURPRISE) / 2).sum(0)
        self.squares += np.minimum(error, SURPRISE * variance).sum(0)
        self.foretold += len(outcome)

    def by_line(self, where: BoolArray) -> "Explanations":
        """The same, but that some factors (F,) are explained by the line of rate and action alone, and do by habit what
        they did at that rate: Eq. (1) with the whole of that prior is then the inverse of the line."""
        if not where.any():
            return self
        evidence = self.evidence.copy()
        evidence[where, 1:] = -UNBELIEVED
        return replace(self, evidence=evidence).by_pace(where | self.paced)

    def by_pace(self, where: BoolArray) -> "Explanations":
        """The same, but that some factors (F,) do by habit what they did at that rate, wherever that was."""
        if not where.any():
            return self
        found = replace(self)
        found.paced = where
        return found

    def merge(self, other: "Explanations") -> None:
        """Add what another one of the same pilot learned.

        Raises:
            BabblingError: another pilot's.
        """
        if not self.frame.same(other.frame):
            raise BabblingError("these forward models do not share their axes; only those of one pilot can be merged")
        self.table.merge(other.table)
        for mine, theirs in (
            (self.moments, other.moments), (self.evidence, other.evidence), (self.squares, other.squares),
            (self.foretold, other.foretold),
        ):  # fmt: skip
            mine += theirs
        self._forget()

    def fade(self, keep: float) -> None:
        """Let all that was counted and foretold so far weigh as much as this share of it: bodies change."""
        for counted in (self.moments, self.table.counts, self.table.moments.sums):
            counted[:] = np.rint(counted * keep)
        for told in (self.evidence, self.squares, self.foretold):
            told *= keep
        self.table.refresh()
        self._forget()

    def _forget(self) -> None:
        for known in ("lines", "errors", "weights", "habit", "averaged", "spread", "trusted"):
            vars(self).pop(known, None)

    # --------------------------------------------------------------- predicting

    @cached_property
    def lines(self) -> FloatArray:
        """(E, F, COLUMNS + 2 F) weights of each line; of the table, those of the line from which it departs."""
        fits = np.stack([*(whole(self.fit(name), name) for name in LINES), 0 * whole(self.fit("line"), "line")])
        fits[-1, :, :_OWN] = self.frame.line
        return fits

    def foretold_by(self, columns: FloatArray) -> FloatArray:
        """(N, F, E) m_e(x) of (N, F, COLUMNS + 2 F) features: what each explanation expects."""
        means = np.moveaxis(np.moveaxis(columns, 1, 0) @ np.moveaxis(self.lines, 0, 2), 0, 1)
        rate, effort = self.frame.bent(columns)
        means[..., -1] += self.table.at((rate,)).expected(effort)
        return means

    def fit(self, explanation: str) -> LinearFit:
        """The posterior of a line's weights."""
        return self.sums.fit(["outcome"], names(explanation, len(self.factors)), RIDGE)

    @cached_property
    def errors(self) -> FloatArray:
        """(F, E) s_e: what foretelling missed by so far (a block's worth of it what the lines leave of their own)."""
        own = np.stack([np.sqrt(self.fit(name).covariance[:, 0, 0]) for name in (*LINES, "gravity")], axis=-1)
        return np.asarray(np.sqrt((self.squares + BLOCK * own**2) / (self.foretold[:, None] + BLOCK)))

    @cached_property
    def weights(self) -> FloatArray:
        """(F, E) P_e."""
        likely = np.exp(self.evidence - self.evidence.max(1, keepdims=True))
        likely[likely < NOTICED * likely.sum(1, keepdims=True)] = 0
        return np.asarray(likely / likely.sum(1, keepdims=True))

    @cached_property
    def spread(self) -> FloatArray:
        """(F,) root of sum_e P_e s_e^2: how far off the average is expected to be."""
        return np.asarray(np.sqrt((self.weights * self.errors**2).sum(1)))

    @cached_property
    def habit(self) -> tuple[FloatArray, FloatArray]:
        """(F, BEFORE) weights of the line through the actions c - q that babbling took, and (F,) how far off it is; by
        pace alone where asked (`by_pace`): that one stays about the middle of one's range is no habit to share."""
        line, spread = np.zeros((len(self.factors), _BEFORE)), np.zeros(len(self.factors))
        told = [name for name in BEFORE[1:] if name != "before"]
        for inputs, where in ((told, ~self.paced), (["rate"], self.paced)):
            if where.any():
                fit = self.sums.fit(["action"], inputs, RIDGE)
                columns = np.array([0, *(COLUMNS.index(name) for name in inputs)])
                line[np.ix_(where, columns)] = fit.coefficients[where, 0]
                spread[where] = np.sqrt(fit.covariance[where, 0, 0])
        return line, spread

    @property
    def slope(self) -> FloatArray:
        """(F,) E[w] per unit of command, where plays and dead zones are taken up."""
        return np.asarray(self.averaged[:, _BEFORE:_OWN].sum(1))

    @cached_property
    def averaged(self) -> FloatArray:
        """(F, COLUMNS + 2 F) lines averaged: they are linear in their weights."""
        return np.asarray(np.einsum("fe,efx->fx", self.weights, self.lines))

    @cached_property
    def trusted(self) -> Trusted:
        """What is asked of the table: of the factors whose average it is part of."""
        [some] = np.nonzero(self.weights[:, -1])
        rate, effort = self.table.contexts[0], self.table.action
        return Trusted(some, self.weights[some, -1], rate.of(some), effort.of(some), self.table.mean[some])

    def at(self, posture: FloatArray, rate: FloatArray, echo: Echo) -> Outlook:
        """What may come of (..., F) postures and rates, given what earlier commands left."""
        before, table = self.features.before(posture, rate, echo), self.trusted
        lines, body = self.averaged[:, :_BEFORE], self.averaged[:, _OWN:]
        fixed = along(before, lines) + weighing(posture) @ body.T
        paces = np.arcsinh(before[..., table.factors, 1] / self.frame.bend[table.factors, 0])
        cells = located(len(table.factors), (table.rate,), (paces,))
        return Outlook(self, posture, echo, before, fixed, cells, along(before, self.frame.centre))
