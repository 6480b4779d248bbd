"""The body schema: which motor moves which sense, found by babbling alone (chapter, section 2.1; Figure 9).

A mind that has a motor vector and a sense vector, and knows neither, moves everything at random and asks of every pair
how much one tells about the other (mutual information). The sense that knows most about a motor is its *posture*
sense; the sense that follows the changes of that posture is its *rate* sense. A line through posture against command
gives the efference copy: what posture a command asks for.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy.optimize import linear_sum_assignment

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.errors import BabblingError
from babbling.kinds import Numbers
from babbling.regression import regress

Told = Callable[[FloatArray, FloatArray], tuple[FloatArray, float]]
BINS = 12
"""Of every variable, fewer where the pairs of bins would not get two samples each."""
HELD = 0.7
"""Least share of what a posture sense does that a command explains which asks for postures: servos reach 89 %, worn
ones too, pendulums and carts that are pushed about 11 to 61."""
LEAST_BITS = 0.1
"""A sense that knows less than this about a motor is not moved by it, however many samples say so."""
CHANGE = 40
"""Ticks over which a motor that moves by itself is seen to move something: weak servos take some to follow."""


@dataclass(frozen=True)
class BodySchema:
    """Factor f = motor f: its senses, its efference copy, its noise."""

    posture: Annotated[IntArray, Numbers("motor", low=0, index="sense")]
    """(F,) sense line that motor f moves."""
    rate: Annotated[IntArray, Numbers("rate_sense", low=0, index="sense")]
    """(F,) sense line that reports how fast it moves; (0,) where the senses are too few for that."""
    offset: Annotated[FloatArray, Numbers("motor", "rad")]
    """(F,) posture that command 0 asks for, sense units."""
    slope: Annotated[FloatArray, Numbers("motor", zero=False)]
    """(F,) posture per unit of command: commanded posture = offset + slope * motor."""
    noise: Annotated[FloatArray, Numbers("motor", "rad", low=0, zero=False)]
    """(F,) standard deviation of the posture sense: at rest, and of its resolution (a step of r has r / sqrt(12))."""
    rate_noise: Annotated[FloatArray, Numbers("rate_sense", "rad/s", low=0, zero=False)]
    """(F,) the same of the rate sense."""
    information: Annotated[FloatArray, Numbers("motor sense", "bit", low=0, high=64)]
    """(M, S) mutual information of motor and sense, bits: the picture of the body schema."""

    def efference(self, motors: FloatArray) -> FloatArray:
        """(..., F) postures that (..., F) commands ask for."""
        return np.asarray(self.offset + self.slope * motors)

    def motors(self, postures: FloatArray) -> FloatArray:
        """Inverse of `efference`."""
        return np.asarray((postures - self.offset) / self.slope)


def mutual_information(x: FloatArray, y: FloatArray, bins: int = BINS) -> FloatArray:
    """I(X_i; Y_j) = sum p log2 p / (p p) of quantile-binned columns, minus its bias under independence.

    Args:
        x, y: (N, I) and (N, J) samples.
        bins: bins per variable, equally filled.

    Returns:
        (I, J) bits, at least 0; the first-order bias (bins - 1)^2 / (2 N ln 2) (Miller 1955) is taken off.
    """

    def ranked(v: FloatArray) -> IntArray:
        cuts = np.quantile(v, np.arange(1, bins) / bins, axis=0)
        return np.stack([np.searchsorted(cuts[:, i], v[:, i], side="right") for i in range(v.shape[1])], 1)

    a, b = ranked(x), ranked(y)
    result = np.zeros((x.shape[1], y.shape[1]))
    for i in range(x.shape[1]):
        for j in range(y.shape[1]):
            p = np.bincount(a[:, i] * bins + b[:, j], minlength=bins * bins).reshape(bins, bins) / len(x)
            independent = p.sum(1, keepdims=True) * p.sum(0, keepdims=True)
            seen = p > 0
            result[i, j] = (p[seen] * np.log2(p[seen] / independent[seen])).sum()
    return np.asarray(np.maximum(result - (bins - 1) ** 2 / (2 * len(x) * np.log(2)), 0))


class Unfelt(BabblingError):
    """A motor that moves nothing that is felt, as far as could be told."""


def together(motors: FloatArray, senses: FloatArray) -> tuple[FloatArray, float]:
    """(M, S) bits that (T, B, S) senses tell about (T, B, M) commands that all change at once, and how many another
    copy's commands seem to tell: smooth movements are far fewer samples than ticks."""
    m, s = motors.reshape(-1, motors.shape[-1]), senses.reshape(-1, senses.shape[-1])
    bins = min(BINS, max(2, int(np.sqrt(len(m) / 2))))
    by_chance = [mutual_information(other.reshape(m.shape), s, bins).max() for other in _others(motors, s.shape[1])]
    return mutual_information(m, s, bins), max(LEAST_BITS, 1.1 * float(max(by_chance)))


def one_by_one(motors: FloatArray, senses: FloatArray) -> tuple[FloatArray, float]:
    """The same of commands that change in turn: bits between changes over `CHANGE` ticks, -log2(1 - r^2) / 2 of their
    correlation r; what a motor does not move then stands still, so that hardly anything seems so by chance."""
    x, y = ((v[CHANGE:] - v[:-CHANGE]).reshape(-1, v.shape[-1]) for v in (motors, senses))
    x, y = x - x.mean(0), y - y.mean(0)
    square = (x.T @ y) ** 2 / np.maximum(np.outer((x**2).sum(0), (y**2).sum(0)), 1e-300)
    return np.asarray(-np.log2(1 - np.minimum(square, 1 - 1e-9)) / 2), LEAST_BITS


def find_schema(
    motors: FloatArray,
    senses: FloatArray,
    resting: FloatArray,
    low: FloatArray,
    high: FloatArray,
    tick_s: float,
    told: Told = together,
) -> BodySchema:
    """Body schema from a slow babble and a moment of rest.

    Args:
        motors: (T, B, M) commands.
        senses: (T, B, S) sensations at the end of each tick.
        resting: (R, B, S) sensations while nothing moves.
        low, high: (S,) ranges of the senses.
        tick_s: control tick.
        told: how senses tell about motors: `together` or `one_by_one`, as these moved.

    Raises:
        BabblingError: a motor that moves nothing that is felt.
    """
    m, s = motors.reshape(-1, motors.shape[-1]), senses.reshape(-1, senses.shape[-1])
    information, chance = told(motors, senses)
    rows, posture = linear_sum_assignment(-information)
    if len(rows) < m.shape[1]:
        raise BabblingError(f"{m.shape[1]} motors but only {s.shape[1]} senses: each motor needs a sense that it moves")
    weak = information[rows, posture] < chance
    if weak.any():
        dead = int(np.argmax(weak))
        raise Unfelt(
            f"motor {dead} moves nothing that is felt: at most {information[dead].max():.2f} bit with any sense, where "
            f"chance alone explains {chance:.2f}; connect it, leave it out, or babble longer"
        )
    rate = posture[:0]
    if s.shape[1] >= 2 * m.shape[1]:
        posture, rate = _rates(senses, posture, tick_s)
    noise = np.sqrt(resting.var(axis=0).mean(0) + resolution(s) ** 2 / 12)
    room = 0.06 * (high - low)[posture]
    away = (s[:, posture] > low[posture] + room) & (s[:, posture] < high[posture] - room)
    told_by = np.stack([np.ones_like(m), m, s[:, rate]][: 2 + (rate.size > 0)], -1)
    offset, slope = _efference(told_by, s[:, posture], away)
    held = _held(told_by, s[:, posture], away, noise[posture] ** 2, noise[rate] ** 2)
    if held.min() < HELD:
        free = int(np.argmin(held))
        raise BabblingError(
            f"motor {free} asks for no posture: what it is told explains {max(held[free], 0):.0%} of the sense that it "
            f"moves most, a servo's at least {HELD:.0%}; torques and speeds need position servos around them"
        )
    return BodySchema(posture, rate, offset, slope, noise[posture], noise[rate], information)


def _rates(senses: FloatArray, posture: IntArray, tick_s: float) -> tuple[IntArray, IntArray]:
    """(F,) posture and rate senses: those that go with the postures' own changes. Where a "posture" goes with another
    sense's changes (r > 0.5), more than any goes with its own, it was the rate of that one."""
    change = (np.diff(senses, axis=0) / tick_s).reshape(-1, senses.shape[-1])
    level = senses[1:].reshape(-1, senses.shape[-1])
    with np.errstate(invalid="ignore", divide="ignore"):
        both = (change - change.mean(0)).T @ (level - level.mean(0)) / len(level)
        follow = np.nan_to_num(both / np.outer(change.std(0), level.std(0)))
    np.fill_diagonal(follow, -1)
    whose = follow[:, posture].argmax(0)
    mistaken = (follow[whose, posture] > np.maximum(follow[posture].max(1), 0.5)) & ~np.isin(whose, posture)
    posture = np.where(mistaken, whose, posture)
    follow[:, posture] = -1
    return posture, np.asarray(linear_sum_assignment(-follow[posture])[1])


def _others(motors: FloatArray, senses: int) -> list[FloatArray]:
    """(T, B, M) commands of other copies, which cannot have moved these senses; one copy alone: of another time.

    As many as give a few hundred pairs of strangers, to know how far chance goes.
    """
    copies, pairs = motors.shape[1], motors.shape[2] * senses
    if copies == 1:
        return [np.roll(motors, len(motors) // 2, axis=0)]
    return [np.roll(motors, shift, axis=1) for shift in range(1, min(copies, 2 + 300 // pairs))]


def resolution(senses: FloatArray) -> FloatArray:
    """(S,) finest step between two different readings in (N, S) sensations; 1e-6 at least."""
    steps = np.diff(np.sort(senses, axis=0), axis=0)
    return np.asarray(np.maximum(np.where(steps > 1e-9, steps, np.inf).min(axis=0, initial=1.0), 1e-6))


def _efference(told_by: FloatArray, postures: FloatArray, away: BoolArray) -> tuple[FloatArray, FloatArray]:
    """posture = offset + slope motor - lag rate, by least squares where the posture is away from its ends.

    Samples that a fit misses by far are cut commands (beyond what the drive accepts) and are left out of the next.
    """
    fit = regress(told_by, postures[..., None], keep=away, outlier=3.0, rounds=4)
    if (fit.samples < 10).any():
        stuck = int(np.argmin(fit.samples))
        raise BabblingError(f"motor {stuck}: its posture sense never leaves the ends of its range")
    return fit.coefficients[:, 0, 0], fit.coefficients[:, 0, 1]


def _held(
    told_by: FloatArray, postures: FloatArray, away: BoolArray, noise: FloatArray, rate_noise: FloatArray
) -> FloatArray:
    """(F,) share of the variance of postures away from their ends that such a line explains, of what is not noise."""
    fit = regress(told_by, postures[..., None], keep=away)
    if rate_noise.size:
        noise = noise + fit.coefficients[:, 0, 2] ** 2 * rate_noise
    left = np.maximum(fit.covariance[:, 0, 0] - noise, 0)
    return np.asarray(1 - left / np.nanvar(np.where(away, postures, np.nan), axis=0))
