"""The frame in which movements are explained: features, ranges and grids, found once by the pilot and then fixed.

The table counts departures, so it needs something fixed to depart from: a line through all features, fitted to the
pilot's experience. Its axes are even in arsinh(x / bend): fine where most of what happens is small, and as far out as
anything went.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from babbling.axes import Axis, FloatArray, same_axes
from babbling.features import BEFORE, COLUMNS, HINGES, PLAYS, Features, names
from babbling.kinds import Numbers
from babbling.regression import LinearFit, LinearGaussian

GRID = (15, 31, 41)
"""Grid points of rate, effort and departure."""
MARGIN, QUANTILE = 1.6, 0.9995
"""Ranges reach this many times the pilot's quantile: a fast movement must not fall off."""
LEAST = 1e-3
"""Least reach of a feature; one that the pilot never met does not grow out of nothing."""
RIDGE = 1e-4
"""Prior precision of a line's weights, in units of each feature's mean square and the noise's, per transition."""
_BENDS = slice(COLUMNS.index("squared") - 1, COLUMNS.index("squared") + HINGES)
_BEFORE, _PLAYS, _OWN = len(BEFORE), slice(len(BEFORE), len(BEFORE) + len(PLAYS)), slice(len(COLUMNS))


@dataclass(frozen=True)
class Frame:
    """What does not change any more while one learns."""

    features: Features
    reach: Annotated[FloatArray, Numbers("motor channel", low=0, zero=False)]
    """(F, C) largest size of each column but the first, and of w; larger values are cut."""
    line: Annotated[FloatArray, Numbers("motor column")]
    """(F, COLUMNS) the pilot's richest line of a joint's own, from which the table counts departures."""
    centre: Annotated[FloatArray, Numbers("motor before")]
    """(F, BEFORE) a line through the effort that babbling took: it is counted beyond that."""
    bend: Annotated[FloatArray, Numbers("motor bend", low=0, zero=False)]
    """(F, 2) rate and effort at which the table's axes turn from even to logarithmic."""
    rate: Annotated[Axis, Numbers("motor")]
    effort: Annotated[Axis, Numbers("motor")]
    departure: Annotated[Axis, Numbers("motor")]

    @classmethod
    def found(cls, features: Features, columns: FloatArray, outcome: FloatArray) -> "Frame":
        """From a pilot's (N, F, COLUMNS) features, whose shares are not known yet, and (N, F) outcomes."""
        channels = np.concatenate([columns[..., 1:], outcome[..., None]], axis=-1)
        reach = np.maximum(_most(channels), LEAST)
        # a pilot that hardly came past a bend says little of how far one gets: that is a matter of postures
        far = reach[:, COLUMNS.index("posture") - 1, None]
        reach[:, _BENDS] = np.maximum(np.concatenate([far**2, far - features.knots], axis=1), LEAST)
        sums = _sums(reach)
        sums.observe(channels, np.ones(outcome.shape, bool))
        line = whole(sums.fit(["outcome"], names("play", len(reach)), RIDGE), "play")
        effort = features.effort(columns[..., _PLAYS])
        told = np.concatenate([columns[..., 1:_BEFORE], effort[..., None]], axis=-1)
        ends = np.abs(told).max(0) + 1e-9
        usual = LinearGaussian((*BEFORE[1:], "effort"), -ends, ends)
        usual.observe(told, np.ones(outcome.shape, bool))
        centre = usual.fit(["effort"], BEFORE[1:], RIDGE).coefficients[:, 0]
        beyond = np.stack([columns[..., 1], effort - (columns[..., :_BEFORE] * centre).sum(-1)], axis=-1)
        bend = np.quantile(np.abs(beyond), 0.5, axis=0) + 1e-9
        ends = np.arcsinh(_most(beyond) / bend)
        most = _most((outcome - (columns[..., _OWN] * line[:, _OWN]).sum(-1))[..., None])[:, 0]
        return cls(
            features,
            reach,
            line[:, _OWN],
            centre,
            bend,
            Axis("rate", "1", -ends[:, 0], ends[:, 0], GRID[0]),
            Axis("effort", "1", -ends[:, 1], ends[:, 1], GRID[1]),
            Axis("departure", "rad", -most, most, GRID[2]),
        )

    def same(self, other: "Frame") -> bool:
        """Whether what was counted in both may be added."""
        axes = same_axes((self.rate, self.effort, self.departure), (other.rate, other.effort, other.departure))
        return axes and np.array_equal(self.line, other.line)

    def nothing(self) -> LinearGaussian:
        """Sums over the columns and w, before any experience."""
        return _sums(self.reach)

    def bent(self, columns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(..., F) rate and effort of (..., F, COLUMNS) features, on the table's axes."""
        effort = self.features.effort(columns[..., _PLAYS])
        beyond = effort - (columns[..., :_BEFORE] * self.centre).sum(-1)
        return np.arcsinh(columns[..., 1] / self.bend[:, 0]), np.arcsinh(beyond / self.bend[:, 1])


def whole(fit: LinearFit, name: str) -> FloatArray:
    """(F, COLUMNS + 2 F) weights of the line `name`, 0 for what it does not look at."""
    joints = len(fit.samples)
    columns = ("one", *names("gravity", joints))
    line = np.zeros((joints, len(columns)))
    line[:, [0, *(columns.index(column) for column in names(name, joints))]] = fit.coefficients[:, 0]
    return line


def shares(columns: FloatArray, outcome: FloatArray) -> FloatArray:
    """(F, J) how much of a command arrives through each play, by a line without dead zones."""
    told = np.concatenate([columns[..., 1 : _PLAYS.stop], outcome[..., None]], axis=-1)
    ends = np.abs(told).max(0) + 1e-9
    sums = LinearGaussian((*COLUMNS[1 : _PLAYS.stop], "outcome"), -ends, ends)
    sums.observe(told, np.ones(outcome.shape, bool))
    weights = sums.fit(["outcome"], COLUMNS[1 : _PLAYS.stop], RIDGE).coefficients[:, 0, _PLAYS]
    return np.asarray(weights / weights.sum(1, keepdims=True))


def _most(values: FloatArray) -> FloatArray:
    """(F, C) reach of (N, F, C) values."""
    return np.asarray(MARGIN * np.quantile(np.abs(values), QUANTILE, axis=0) + 1e-9)


def _sums(reach: FloatArray) -> LinearGaussian:
    return LinearGaussian((*names("gravity", len(reach)), "outcome"), -reach, reach)
