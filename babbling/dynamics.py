"""A linear-Gaussian account of one's own posture and rate: what a state estimate predicts with between two senses.

Law, per factor with posture q, rate v, efference copy (commanded posture) c and a slow bias d (gravity, stiction: what
rate and action alone do not explain):

    q' = q + k v + b_0 + b (c - q) + d + e_q        d' = PERSISTENCE d + e_d
    v' = g_0 + g_1 v + g_2 (c - q) + h d + e_v

Fitted by least squares to babbling. How much of the residual is slow is read off its autocorrelation.
"""

from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray
from babbling.schema import BodySchema

PERSISTENCE = 0.98
"""Per tick: a bias forgets half of itself in 34 ticks, about as long as a limb takes to come to another posture."""
SLOW_LAGS = range(4, 8)
"""Lags, ticks, at which what is left of the residual's autocorrelation counts as slow."""


class LinearDynamics(NamedTuple):
    """x' = transition x + control c + offset + noise, x = (posture, rate, bias)."""

    transition: FloatArray
    """(F, 3, 3)."""
    control: FloatArray
    """(F, 3)."""
    offset: FloatArray
    """(F, 3)."""
    noise: FloatArray
    """(F, 3, 3) covariance per tick."""
    bias_variance: FloatArray
    """(F,) stationary variance of the bias, posture units squared."""
    coasting: FloatArray
    """(F,) k: displacement per tick and unit of rate when told to stay."""


def fit_dynamics(schema: BodySchema, motors: FloatArray, senses: FloatArray) -> LinearDynamics:
    """Least squares on (T, B, M) commands and (T + 1, B, S) sensations of smooth babbling."""
    q, v = senses[..., schema.posture], senses[..., schema.rate]
    action = schema.efference(motors) - q[:-1]
    factors = q.shape[-1]
    transition, control, offset = np.zeros((factors, 3, 3)), np.zeros((factors, 3)), np.zeros((factors, 3))
    noise, bias, coasting = np.zeros((factors, 3, 3)), np.zeros(factors), np.zeros(factors)
    for f in range(factors):
        x = np.stack([np.ones_like(action[..., f]), v[:-1, :, f], action[..., f]], -1)
        y = np.stack([q[1:, :, f] - q[:-1, :, f], v[1:, :, f]], -1)
        beta = np.linalg.lstsq(x.reshape(-1, 3), y.reshape(-1, 2), rcond=None)[0]
        residual = y - x @ beta
        covariance = np.cov(residual.reshape(-1, 2).T)
        displacement = residual[..., 0]
        lagged = [np.mean(displacement[lag:] * displacement[:-lag]) for lag in SLOW_LAGS]
        slow = float(np.clip(np.mean(lagged) / np.mean(displacement**2), 0.02, 0.98))
        bias[f], coasting[f] = slow * covariance[0, 0], beta[1, 0]
        transition[f] = [
            [1 - beta[2, 0], beta[1, 0], 1],
            [-beta[2, 1], beta[1, 1], covariance[0, 1] / covariance[0, 0]],
            [0, 0, PERSISTENCE],
        ]
        control[f] = [beta[2, 0], beta[2, 1], 0]
        offset[f] = [beta[0, 0], beta[0, 1], 0]
        noise[f, :2, :2] = (1 - slow) * covariance
        noise[f, 2, 2] = bias[f] * (1 - PERSISTENCE**2)
    return LinearDynamics(transition, control, offset, noise, bias, coasting)
