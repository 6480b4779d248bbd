"""Turning the body image round: the postures of one limb in which its parts point where they were seen to.

Every frame has a few candidate postures. Some are the most probable ones of a discrete library under Eq. (1),

    P(posture A_i | seen s_t) = c P(s_t | A_i) P(A_i | s_{t-1}),

with the learned P(s | A_i) and a prior that stays near the posture before and near comfort; one is comfort itself.
Each is then refined where the body image is smooth: damped Gauss-Newton steps on the same log posterior, inside the
range of the senses. The most probable path through the candidates (Viterbi 1967) is the answer.
"""

from typing import Protocol

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.body_image import COMFORT, Image
from imitation.correspondence.limbs import OwnLimb
from imitation.inference.bayes import action_posterior

NEAR = 0.35
"""rad: how far a posture of the library usually lies from the one before; from rest, `COMFORT`."""
COARSE = 0.3
"""rad: how far directions lie off in the nearest of the library's postures."""
STIFF = 3e-7
"""Pull to rest in the refinement, against squared errors of the first part: only felt where nothing seen decides."""
JUMP = 0.3
"""What a squared jump between frames (rad^2) counts in the path, against squared errors of the first part."""
CANDIDATES = 3
STEPS, TOLERANCE, GOOD = 30, 1e-5, 1e-5


class View(Protocol):
    """What is shown of S parts where some senses are, all others held."""

    @property
    def low(self) -> FloatArray:
        """(n,) least angles."""

    @property
    def high(self) -> FloatArray:
        """(n,) greatest."""

    @property
    def rest(self) -> FloatArray:
        """(n,) comfort."""

    def directions(self, angles: FloatArray, rows: IntArray) -> tuple[FloatArray, FloatArray]:
        """(N, S, 3) what is shown and (N, S, 3, n) slopes at (N, n) angles, for frames `rows` (N,)."""


class LimbView:
    """A limb as the body image shows it, the senses it does not decide held where they are."""

    def __init__(self, image: Image, limb: OwnLimb, parts: list[int], base: FloatArray, margin: float) -> None:
        self.image, self.factors, self.base = image, limb.factors, base
        self.numbers = parts
        self.parts = [image.images[image.parts[part]] for part in parts]
        self.low, self.high = image.low[limb.factors] + margin, image.high[limb.factors] - margin
        self.rest = np.clip(image.rest[limb.factors], self.low, self.high)

    def directions(self, angles: FloatArray, rows: IntArray) -> tuple[FloatArray, FloatArray]:
        """(N, S, 3) unit vectors and (N, S, 3, n) slopes at (N, n) angles, all else as in `rows` (N,) of the base."""
        postures = self.base[rows]
        postures[:, self.factors] = angles
        shown = np.empty((len(angles), len(self.parts), 3))
        slopes = np.empty((*shown.shape, len(self.factors)))
        for number, part in enumerate(self.parts):
            value, slope = part.slope(postures, self.factors)
            length = np.linalg.norm(value, axis=1)
            unit = value / length[:, None]
            along = np.einsum("ni,nij->nj", unit, slope)
            shown[:, number] = unit
            slopes[:, number] = (slope - unit[:, :, None] * along[:, None, :]) / length[:, None, None]
        return shown, slopes


def choose(view: LimbView, wanted: FloatArray, weights: FloatArray, doubt: FloatArray) -> FloatArray:
    """Postures (T, n) for wanted directions (T, S, 3).

    weights (T, S): of their squared errors; doubt (S,): standard deviation per axis of what is wanted, rad.
    """
    posterior, cells = _library(view, wanted, weights)
    count = len(wanted)
    rows = np.arange(count)
    angles, cost = refined(view, wanted, weights, np.tile(view.rest, (count, 1)), rows)
    found, costs = [angles], [cost]
    off = np.flatnonzero(cost > GOOD + 3 * weights @ doubt**2)
    if len(off):
        best = np.argsort(-posterior[off], axis=1)[:, : 4 * CANDIDATES : 4]
        for column in best.T:
            other, price = angles.copy(), np.full(count, np.inf)
            other[off], price[off] = refined(view, wanted, weights, cells[column], off)
            found.append(other)
            costs.append(price)
    return _path(np.array(found), np.array(costs))


def _library(view: LimbView, wanted: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(T, K) Eq. (1) over the library's (K, n) postures; the prior is carried on from the frame before."""
    cells = np.clip(view.image.library[:, view.factors], view.low, view.high)
    at_rest = np.tile(view.base.mean(0), (len(cells), 1))
    at_rest[:, view.factors] = cells
    importance = np.sqrt(weights / weights.max())  # what lies further out decides less, but does decide
    log_likelihood = np.zeros((len(wanted), len(cells)))
    for number, (part, image) in enumerate(zip(view.numbers, view.parts, strict=True)):
        shown = image.expected(at_rest)
        shown /= np.linalg.norm(shown, axis=1, keepdims=True)
        spread = view.image.doubt[:, part] + COARSE**2
        misses = 2 - 2 * wanted[:, number] @ shown.T  # |a - b|^2 of unit vectors
        log_likelihood -= importance[:, number, None] * (misses / spread + 3 * np.log(spread)) / 2
    likelihood = np.exp(log_likelihood - log_likelihood.max(1, keepdims=True))
    comfort = np.exp(-((cells - view.rest) ** 2).sum(1) / (2 * COMFORT**2))
    near = comfort * np.exp(-((cells[:, None] - cells) ** 2).sum(-1) / (2 * NEAR**2))
    near /= near.sum(1, keepdims=True)
    prior = comfort = comfort / comfort.sum()
    posterior = np.empty_like(likelihood)
    for t, likely in enumerate(likelihood):
        one = action_posterior(likely, prior)
        if not one.informed:  # nothing near the posture before explains what is seen: start anew from comfort
            one = action_posterior(likely, comfort)
        posterior[t] = one.probability
        prior = one.probability @ near if one.informed else comfort
    return posterior, cells


def refined(
    view: View,
    wanted: FloatArray,
    weights: FloatArray,
    start: FloatArray,
    rows: IntArray,
    stiff: float = STIFF,
) -> tuple[FloatArray, FloatArray]:
    """Damped Gauss-Newton from (N, n) postures for frames `rows`: optimum inside the range, and its cost (N,).

    Cost: sum_s w_s |direction_s - wanted_s|^2 + stiff |angles - rest|^2. A sense that leans on the end of its range is
    held there for the step (projected Newton; Bertsekas 1982).
    """
    angles, size = start.copy(), start.shape[1]

    def cost_of(trial: FloatArray, which: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        shown, slope = view.directions(trial, rows[which])
        miss = shown - wanted[rows[which]]
        cost = (weights[rows[which]] * (miss**2).sum(-1)).sum(-1) + stiff * ((trial - view.rest) ** 2).sum(1)
        return cost, miss, slope

    active = np.arange(len(angles))
    cost, miss, slope = cost_of(angles, active)
    damping = np.full(len(angles), 1e-2)
    while_left = STEPS
    while len(active) and while_left:
        while_left -= 1
        here = angles[active]
        weighted = (slope[active] * weights[rows[active]][:, :, None, None]).reshape(len(active), -1, size)
        flat = slope[active].reshape(len(active), -1, size)
        gradient = (weighted.swapaxes(1, 2) @ miss[active].reshape(len(active), -1, 1))[..., 0]
        gradient += stiff * (here - view.rest)
        held = ((here <= view.low) & (gradient > 0)) | ((here >= view.high) & (gradient < 0))
        matrix = weighted.swapaxes(1, 2) @ flat
        matrix = np.where(held[:, :, None] | held[:, None, :], 0.0, matrix)
        diagonal = np.einsum("nii->ni", matrix)
        lift = damping[active, None] * (diagonal + 1e-2 * diagonal.max(1, keepdims=True)) + stiff + held
        step = np.linalg.solve(matrix + lift[:, :, None] * np.eye(size), np.where(held, 0, gradient)[..., None])
        trial = np.clip(here - step[..., 0], view.low, view.high)
        found = cost_of(trial, active)
        better = found[0] < cost[active]
        moved = active[better]
        drop = cost[moved] - found[0][better]
        angles[moved], cost[moved] = trial[better], found[0][better]
        miss[moved], slope[moved] = found[1][better], found[2][better]
        damping[active] *= np.where(better, 0.2, 6.0)
        going = damping[active] < 1e8
        going[better] &= drop > TOLERANCE * cost[moved] + 1e-12
        active = active[going]
    return angles, cost


def _path(found: FloatArray, costs: FloatArray) -> FloatArray:
    """Through one of C candidates per frame, (C, T, n) at costs (C, T), the path of least cost + JUMP |change|^2."""
    total, back = costs[:, 0], np.zeros(costs.shape, int)
    for t in range(1, costs.shape[1]):
        ways = total[:, None] + JUMP * ((found[None, :, t] - found[:, None, t - 1]) ** 2).sum(-1)
        back[:, t] = ways.argmin(0)
        total = ways.min(0) + costs[:, t]
    at = np.empty(costs.shape[1], int)
    at[-1] = int(total.argmin())
    for t in range(costs.shape[1] - 1, 0, -1):
        at[t - 1] = back[at[t], t]
    return np.asarray(found[at, np.arange(costs.shape[1])])
