"""A linear-Gaussian account of one's own posture and rate: what a state estimate predicts with between two senses.

Law, per factor with posture q, rate v, efference copy (commanded posture) c and a slow bias d (gravity, stiction: what
rate and action alone do not explain):

    q' = q + k v + b_0 + b (c - q) + d + e_q        d' = PERSISTENCE d + e_d
    v' = g_0 + g_1 v + g_2 (c - q) + h d + e_v

Fitted by least squares to babbling. How much of the residual is slow is read off its autocorrelation.
"""

from typing import Annotated, NamedTuple

import numpy as np

from babbling.axes import FloatArray
from babbling.kinds import Numbers
from babbling.regression import regress
from babbling.schema import BodySchema

PERSISTENCE = 0.98
"""Per tick: a bias forgets half of itself in 34 ticks, about as long as a limb takes to come to another posture."""
SLOW_LAGS = range(4, 8)
"""Lags, ticks, at which what is left of the residual's autocorrelation counts as slow."""

MOST = 1e4
"""No coefficient of a body that moves within its ranges is larger."""


class LinearDynamics(NamedTuple):
    """x' = transition x + control c + offset + noise, x = (posture, rate, bias)."""

    transition: Annotated[FloatArray, Numbers("motor state:3 state:3", low=-MOST, high=MOST)]
    """(F, 3, 3)."""
    control: Annotated[FloatArray, Numbers("motor state:3", low=-MOST, high=MOST)]
    """(F, 3)."""
    offset: Annotated[FloatArray, Numbers("motor state:3", low=-MOST, high=MOST)]
    """(F, 3)."""
    noise: Annotated[FloatArray, Numbers("motor state:3 state:3", low=-MOST, high=MOST, covariance=True)]
    """(F, 3, 3) covariance per tick."""
    bias_variance: Annotated[FloatArray, Numbers("motor", low=0, high=MOST)]
    """(F,) stationary variance of the bias, posture units squared."""
    coasting: Annotated[FloatArray, Numbers("motor", "s", low=-MOST, high=MOST)]
    """(F,) k: displacement per tick and unit of rate when told to stay."""


def fit_dynamics(schema: BodySchema, motors: FloatArray, senses: FloatArray) -> LinearDynamics:
    """Least squares on (T, B, M) commands and (T + 1, B, S) sensations of smooth babbling."""
    q, v = senses[..., schema.posture], senses[..., schema.rate]
    action = schema.efference(motors) - q[:-1]
    x = np.stack([np.ones_like(action), v[:-1], action], -1)
    y = np.stack([q[1:] - q[:-1], v[1:]], -1)
    count, factors = action[..., 0].size, action.shape[-1]
    fit = regress(x.reshape(count, factors, 3), y.reshape(count, factors, 2))
    stay, coast, pull = np.moveaxis(fit.coefficients, -1, 0)
    covariance = fit.covariance * count / (count - 1)
    rest = (y - fit.mean(x))[..., 0]
    lagged = [np.mean(rest[lag:] * rest[:-lag], axis=(0, 1)) for lag in SLOW_LAGS]
    slow = np.clip(np.mean(lagged, axis=0) / np.mean(rest**2, axis=(0, 1)), 0.02, 0.98)
    bias = slow * covariance[:, 0, 0]
    transition, noise = np.zeros((factors, 3, 3)), np.zeros((factors, 3, 3))
    transition[:, :2, 0], transition[:, :2, 1] = [1, 0] - pull, coast
    transition[:, 0, 2], transition[:, 1, 2] = 1, covariance[:, 0, 1] / covariance[:, 0, 0]
    transition[:, 2, 2] = PERSISTENCE
    noise[:, :2, :2] = (1 - slow)[:, None, None] * covariance
    noise[:, 2, 2] = bias * (1 - PERSISTENCE**2)
    control, offset = (np.pad(part, ((0, 0), (0, 1))) for part in (pull, stay))
    return LinearDynamics(transition, control, offset, noise, bias, coast[:, 0])
