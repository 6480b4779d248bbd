"""The particle filter: beliefs of any shape, as weighted guesses (chapter 3.2 names it beside the Kalman filter).

A belief is P guesses of the state with weights; a step moves every guess by the system's own chance, weighs it by
how well it explains what was seen, and when few guesses carry all the weight, draws them anew by systematic
resampling. N. J. Gordon, D. J. Salmond, A. F. M. Smith (1993). Leading batch dimensions `...` hold independent filters.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from babbling.axes import FloatArray
from imitation.errors import ImitationError


class Particles(NamedTuple):
    """A belief: all that the next step needs."""

    states: FloatArray
    """(..., P, n)."""
    log_weights: FloatArray
    """(..., P), normalised: the exponentials sum to 1."""

    @property
    def weights(self) -> FloatArray:
        """(..., P), summing to 1."""
        return np.asarray(np.exp(self.log_weights))

    @property
    def mean(self) -> FloatArray:
        """E[s_t | z_1..t] (..., n)."""
        return np.asarray(np.einsum("...p,...pn->...n", self.weights, self.states))

    @property
    def covariance(self) -> FloatArray:
        """Cov[s_t | z_1..t] (..., n, n)."""
        away = self.states - self.mean[..., None, :]
        return np.asarray(np.einsum("...p,...pn,...pm->...nm", self.weights, away, away))


def gather(states: FloatArray) -> Particles:
    """Equally weighted guesses from states (..., P, n), such as draws from a prior."""
    return Particles(states, np.full(states.shape[:-1], -np.log(states.shape[-2])))


def step(
    rng: np.random.Generator,
    particles: Particles,
    move: Callable[[np.random.Generator, FloatArray], FloatArray] | None,
    log_likelihood: Callable[[FloatArray], FloatArray] | None,
    *,
    resample_below: float = 0.5,
) -> Particles:
    """One step: `move` draws s_t given s_{t-1}, `log_likelihood` gives log p(z_t | s_t) (..., P) of states (..., P, n).

    None for `move` leaves the guesses where they are (the first measurement), None for `log_likelihood` is a missing
    measurement. Filters whose effective size, 1 / sum of squared weights, falls below `resample_below` P draw anew.

    Raises:
        ImitationError: no guess explains the measurement at all (give the likelihood a share of clutter).
    """
    states, log_weights = particles
    if move is not None:
        states = move(rng, states)
    if log_likelihood is not None:
        joint = log_weights + log_likelihood(states)
        top = joint.max(axis=-1, keepdims=True)
        if not np.isfinite(top).all():
            raise ImitationError(
                "no particle explains the measurement (probability 0 everywhere); give the likelihood a share of "
                "clutter, or start more particles"
            )
        log_weights = joint - (top + np.log(np.exp(joint - top).sum(axis=-1, keepdims=True)))
    weights = np.exp(log_weights)
    poor = 1.0 / np.sum(weights**2, axis=-1) < resample_below * weights.shape[-1]
    if poor.any():
        chosen = systematic(rng, weights)
        drawn = np.take_along_axis(states, chosen[..., None], axis=-2)
        states = np.where(poor[..., None, None], drawn, states)
        log_weights = np.where(poor[..., None], -np.log(weights.shape[-1]), log_weights)
    return Particles(states, log_weights)


def systematic(rng: np.random.Generator, weights: FloatArray) -> npt.NDArray[np.intp]:
    """Indices (..., P) by systematic resampling: one uniform draw u per filter, then the weights' quantiles (i + u)/P.

    Guess j is drawn floor(P w_j) or ceil(P w_j) times, P w_j on average.
    """
    count = weights.shape[-1]
    flat = weights.reshape(-1, count)
    edges = np.cumsum(flat, axis=1)
    edges /= edges[:, -1:]
    places = (np.arange(count) + rng.random((len(flat), 1))) / count
    offset = np.arange(len(flat))[:, None]  # one long sorted line: filter k lies in [k, k + 1]
    found = np.searchsorted((edges + offset).ravel(), (places + offset).ravel(), side="right").reshape(flat.shape)
    return np.asarray(np.minimum(found - offset * count, count - 1).reshape(weights.shape))
