"""Seeing what a face does: pose and relations together, from both eyes, as a Gaussian likelihood.

First a face that does nothing is looked at: from it come its proportions and its usual pose. Every later look is then
explained by the template with these proportions (Gauss-Newton on what both eyes show); what is left over tells how
surely each relation was seen, and which of them only together.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from babbling.axes import FloatArray
from imitation.errors import ImitationError
from imitation.seeing.face_marks import NUMBERS, POINTS, coverage, numbers
from imitation.seeing.face_template import APART_M, MOVING, POSE, REST, SHAPE, SPREAD, appear

SIGMA_PX: Final = 0.2
"""How far a number on an image is off, the template's own faults included."""
TONGUE_PX: Final = 0.3
"""The same of the tongue, whose shape is not known."""
BROW_PX: Final = 1.0
"""The same of brows to the side: skin hides one end or the other."""
GLIMPSE: Final = 0.12
"""Widths of the mouth, the square root of an area: less of the tongue between closed lips tells nothing."""
STILL: Final = np.array([1e-3, REST, 0.0, 0.0, 0.0, 0.0])
"""`MOVING` of a face that does nothing."""
USUAL: Final = np.r_[np.zeros(POSE), STILL]
DOUBT: Final = np.array([0.6, 0.6, 0.1, 6e-3, 6e-3, 6e-3, 1.0, 1.0, 0.6, 0.15, 0.5, 0.5])
"""How far a look may be from there: so weak that only what is hidden stays there; but a head hardly leaves its neck."""
LEAST, MOST = np.array([0.0, -0.8, -0.6, -0.5, -0.02, -0.4]), np.array([1.1, 1.0, 0.6, 0.5, 0.4, 0.4])
GAP, TIP = POSE, POSE + 1
"""Where "gap" and "beyond" stand in a look."""
INSIDE: Final = -0.1
"""Widths of the mouth beyond the lip: further back the tongue is in the dark."""
OPEN, BEYOND, SIDE = np.linspace(0.0, 1.0, 9), np.linspace(-0.2, 0.8, 9), np.linspace(-0.4, 0.4, 7)
"""Where jaw and tongue are looked for first."""
ABOUT: Final = np.array([-0.1, 0.0, 0.1])
"""About the gap that was found without the tongue."""
STARTS, APART, FAR, POOR = 3, 0.15, 30.0, 1.5
"""Places to start from, how far from each other, and standard deviations: as far as an error counts in choosing them,
and from which on a fit is tried from another one."""
STEP: Final = 1e-3
SCALE: Final = np.r_[np.full(POSE, 0.02), np.full(len(MOVING), 0.1)]
"""How far a step of the fit goes in each number."""
ROBUST, ROUNDS = 3.0, 25
"""Standard deviations from which on an error counts less; steps at most."""
ENOUGH: Final = 20
"""Of 36 numbers of both eyes, so many make a face."""


@dataclass(frozen=True, eq=False)
class Acquainted:
    """A face whose proportions one knows."""

    shape: FloatArray
    """(10,) see `SHAPE`."""
    pose: FloatArray
    """(6,) its usual pose."""
    focal_px: float


@dataclass(frozen=True, eq=False)
class Seen:
    """Relations that were seen: a Gaussian likelihood, without any prior."""

    relations: FloatArray
    """(8,) `babbling.relations.RELATIONS` that explain the look best."""
    information: FloatArray
    """(8, 8) inverse covariance; nothing about what is hidden."""
    tongue: bool
    """Whether the tongue was seen."""
    misses: float
    """Root mean square of what the template leaves unexplained, in its own standard deviations."""
    look: FloatArray
    """(12,) pose and `MOVING`, see `face_template`."""


def look_at(images: tuple[NDArray[np.uint8], NDArray[np.uint8]]) -> FloatArray:
    """(2, NUMBERS) of the left and the right eye's image, pixels from the middle of the image."""
    height, width = images[0].shape[:2]
    found = np.stack([numbers(coverage(image)) for image in images])
    found[:, :-1:2] -= (width - 1) / 2
    found[:, 1:-1:2] -= (height - 1) / 2
    return found


def acquaint(looks: FloatArray, focal_px: float) -> Acquainted:
    """Proportions and usual pose out of (N, 2, NUMBERS) looks at a face that does nothing.

    Raises:
        ImitationError: there is no face to be seen.
    """
    there = np.isfinite(looks)
    seen = np.where(there, looks, 0).sum(0) / np.where(there.any(0), there.sum(0), np.nan)
    there = np.isfinite(seen[:, : 2 * len(POINTS) - 2])
    if there.sum() < ENOUGH:
        raise ImitationError("no face is seen: eyes, nose and mouth are needed, in both eyes")
    average = np.array(list(SHAPE.values()))
    apart = max(float(np.nanmean(seen[0, :8:2] - seen[1, :8:2])), 1.0)
    ahead = APART_M * focal_px / apart
    start = np.r_[0, 0, 0, ahead, 0, -float(np.nanmean(seen[:, 1:6:2])) * ahead / focal_px, np.ones(len(average))]

    def missed(x: FloatArray) -> FloatArray:
        pose, shape = x[:POSE], x[POSE:] * average
        shown = appear(shape, pose, USUAL[None], focal_px, tongue=False)[0]
        off = (shown - seen)[:, : 2 * len(POINTS) - 2][there] / SIGMA_PX
        return np.asarray(np.r_[off, (x[POSE:] - 1) / np.r_[10, np.full(len(average) - 1, SPREAD)]])

    x = least_squares(missed, start, x_scale=np.r_[np.full(6, 0.05), np.full(len(average), 0.1)]).x
    return Acquainted(x[POSE:] * average, x[:POSE], focal_px)


def see(face: Acquainted, look: FloatArray) -> Seen:
    """What a face does on one (2, NUMBERS) look; see `look_at`."""
    tongue = bool((look[:, -1] > GLIMPSE * face.shape[0] / face.pose[3] * face.focal_px).all())
    fit = _Fit(face, look, tongue=False)
    dark = found = fit.solved(fit.begun(USUAL, {GAP: OPEN})[0])
    if tongue:
        lit = _Fit(face, look, tongue=True)
        starts = lit.begun(found, {GAP: found[GAP] + ABOUT, TIP: BEYOND, TIP + 1: SIDE})
        found = lit.solved(starts[0])
        for start in starts[1:]:
            if lit.misses(found) > POOR:
                found = min(found, lit.solved(start), key=lit.misses)
        fit, found = (lit, found) if found[TIP] > INSIDE else (fit, dark)
    return fit.seen(found)


class _Fit:
    """One look, explained."""

    def __init__(self, face: Acquainted, look: FloatArray, tongue: bool) -> None:
        self.face, self.look, self.tongue = face, look, tongue
        self.there = np.isfinite(look)
        if not tongue:
            self.there[:, 2 * len(POINTS) - 2 :] = False
        self.sigma = np.full((2, NUMBERS), SIGMA_PX)
        self.sigma[:, 6:10:2], self.sigma[:, 2 * len(POINTS) - 2 :] = BROW_PX, TONGUE_PX

    def off(self, looks: FloatArray) -> FloatArray:
        """(V, n) what (V, 12) looks leave unexplained, standard deviations."""
        looks = looks.copy()
        looks[:, POSE:] = np.clip(looks[:, POSE:], LEAST, MOST)
        shown = appear(self.face.shape, self.face.pose, looks, self.face.focal_px, self.tongue)
        return np.asarray(((shown - self.look) / self.sigma)[:, self.there])

    def begun(self, found: FloatArray, places: Mapping[int, FloatArray]) -> FloatArray:
        """(STARTS, 12) the best looks that have these numbers at these places, all else as found: where to start from,
        the best first, the others far from those before."""
        grid = np.stack(np.meshgrid(*places.values()), -1).reshape(-1, len(places))
        looks = np.tile(found, (len(grid), 1))
        looks[:, list(places)] = grid
        cost = np.minimum(np.abs(self.off(looks)), FAR).sum(1)
        starts = []
        for _ in range(STARTS):
            starts.append(looks[cost.argmin()])
            cost = np.where(np.abs(grid - starts[-1][list(places)]).max(1) < APART, np.inf, cost)
        return np.stack(starts)

    def misses(self, found: FloatArray) -> float:
        """Root mean square of what is left unexplained."""
        return float(np.sqrt(np.mean(self.off(found[None]) ** 2)))

    def solved(self, start: FloatArray) -> FloatArray:
        """(12,) the look that explains it best."""

        def missed(x: FloatArray) -> FloatArray:
            return np.asarray(np.r_[self.off(x[None])[0], (x - USUAL) / DOUBT])

        def slope(x: FloatArray) -> FloatArray:
            sides = self.off(np.vstack([x, x + STEP * np.eye(len(x))]))
            return np.vstack([(sides[1:] - sides[0]).T / STEP, np.diag(1 / DOUBT)])

        x = least_squares(missed, start, slope, x_scale=SCALE, loss="soft_l1", f_scale=ROBUST, max_nfev=ROUNDS).x
        return np.asarray(np.r_[x[:POSE], np.clip(x[POSE:], LEAST, MOST)])

    def seen(self, found: FloatArray) -> Seen:
        """As relations; what is unexplained makes all of it less sure."""
        rows = np.eye(len(found))
        sides = self.off(np.vstack([found + STEP * rows, found - STEP * rows]))
        slope = np.asarray((sides[: len(rows)] - sides[len(rows) :]).T / (2 * STEP))
        misses = self.misses(found)
        information = slope.T @ slope / max(misses, 1.0) ** 2
        return Seen(*_relations(found, information), self.tongue, misses, found)


def _relations(found: FloatArray, information: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(8,) relations and their (8, 8) information, the rest of the pose integrated out."""
    keep, lose = np.r_[np.arange(POSE, len(found)), 0, 1], np.arange(2, POSE)
    unit = np.r_[np.ones(len(MOVING)), np.full(2, np.pi / 2)]
    cross, rest = information[np.ix_(keep, lose)], information[np.ix_(lose, lose)]
    inner = information[np.ix_(keep, keep)] - cross @ np.linalg.solve(rest + np.diag(1 / DOUBT[lose] ** 2), cross.T)
    return found[keep] / unit, inner * np.outer(unit, unit)
