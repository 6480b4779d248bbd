"""Selection rules: one action out of a posterior (chapter, section 3.2), beside each other.

MAP takes the most probable action, probability matching draws one, the posterior mean minimises the expected squared
error. On a categorical axis they return a category number; on a measured axis a value between grid points.
"""

from collections.abc import Callable

import numpy as np

from babbling.axes import Axis, FloatArray, IntArray
from babbling.errors import unknown
from imitation.errors import ImitationError

Rule = Callable[[FloatArray, Axis, np.random.Generator], FloatArray]
"""(..., F, A) posterior, the action axis, randomness -> (..., F) actions in the axis' unit (category numbers)."""


def select_mean(probability: FloatArray, axis: Axis, rng: np.random.Generator) -> FloatArray:
    """E[a] = sum_i p_i A_i; refuses categories, which have no mean.

    Raises:
        ImitationError: the axis is categorical.
    """
    if axis.is_categorical:
        raise ImitationError(
            f"selection 'mean': actions {axis.labels} are categories and have no mean; use map or matching"
        )
    return np.asarray((probability * axis.points).sum(-1))


def select_map(probability: FloatArray, axis: Axis, rng: np.random.Generator) -> FloatArray:
    """argmax_i p_i; ties are broken by the generator. On a measured axis the peak of the parabola through the logs of
    the best grid point and its two neighbours, never more than half a step away: the maximum of the density whose knots
    the grid holds.
    """
    best = _argmax(probability, rng)
    if axis.is_categorical:
        return best.astype(float)
    inner = np.clip(best, 1, axis.size - 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        three = np.log(np.take_along_axis(probability, inner[..., None] + np.arange(-1, 2), -1))
        left, top, right = three[..., 0], three[..., 1], three[..., 2]
        shift = (left - right) / (2 * (left - 2 * top + right))
    usable = (inner == best) & np.isfinite(shift)
    return np.asarray(axis.low + (best + np.where(usable, shift, 0.0)) * axis.step)


def select_matching(probability: FloatArray, axis: Axis, rng: np.random.Generator) -> FloatArray:
    """Draw i with probability p_i; on a measured axis, then a place under grid point i's hat."""
    threshold = rng.random((*probability.shape[:-1], 1))
    drawn = np.minimum(
        (np.cumsum(probability, -1) <= threshold * probability.sum(-1, keepdims=True)).sum(-1), axis.size - 1
    )
    if axis.is_categorical:
        return np.asarray(drawn.astype(float))
    place = drawn + rng.triangular(-1.0, 0.0, 1.0, drawn.shape)
    return np.asarray(axis.low + np.clip(place, 0, axis.size - 1) * axis.step)


def _argmax(probability: FloatArray, rng: np.random.Generator) -> IntArray:
    top = probability.max(-1, keepdims=True)
    ties = probability >= top
    tied = np.count_nonzero(ties) > top.size  # the generator is asked only where it decides
    return np.asarray((np.where(ties, rng.random(probability.shape), -1.0) if tied else probability).argmax(-1))


SELECTION: dict[str, Rule] = {"mean": select_mean, "map": select_map, "matching": select_matching}


def selection_rule(name: str) -> Rule:
    """The rule of this name.

    Raises:
        ImitationError: there is none.
    """
    if name not in SELECTION:
        raise ImitationError(unknown("selection", name, SELECTION))
    return SELECTION[name]
