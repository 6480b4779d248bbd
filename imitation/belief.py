"""The believed state of one's own body: a Kalman filter per factor over posture, rate and slow bias.

Chapter, section 3.2: states are estimated from raw senses by Kalman filtering. Prediction comes from the efference copy
through the dynamics learned by babbling, correction from the senses with the noise they showed at rest; no gain is set
by hand. The bias is what the body does and the forward model did not expect: the felt error of the match-to-target loop
(Figure 9), slowly learned while moving.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray
from babbling.dynamics import LinearDynamics
from babbling.schema import BodySchema


class Belief(NamedTuple):
    """N(mean, covariance) over x = (posture, rate, bias)."""

    mean: FloatArray
    """(B, F, 3)."""
    covariance: FloatArray
    """(F, 3, 3) the same for all copies: it depends on the model, not on what was felt."""


Expectation = Callable[[FloatArray, FloatArray], FloatArray]
"""(B, F) rate and action to (B, F) expected displacement beyond coasting."""


class StateEstimate:
    """Kalman filter with the learned dynamics.

    Args:
        schema: the noise of the senses.
        dynamics: the linear account of posture and rate.
        expectation: what the forward model expects of an action. Where it departs from the line (stiction), the
            prediction departs with it, the rate as it would under a bias of that size; None keeps to the line. The
            covariances are the line's (an extended Kalman filter whose Jacobian is the average one).
    """

    def __init__(self, schema: BodySchema, dynamics: LinearDynamics, expectation: Expectation | None = None) -> None:
        self.dynamics, self.expectation = dynamics, expectation
        self.noise = np.zeros((len(schema.noise), 2, 2))
        self.noise[:, 0, 0], self.noise[:, 1, 1] = schema.noise**2, schema.rate_noise**2

    def start(self, posture: FloatArray, rate: FloatArray) -> Belief:
        """Belief after the first (B, F) senses: they are all there is, and the bias is unknown."""
        covariance = np.zeros((posture.shape[1], 3, 3))
        covariance[:, :2, :2] = self.noise
        covariance[:, 2, 2] = self.dynamics.bias_variance
        return Belief(np.stack([posture, rate, np.zeros_like(posture)], -1), covariance)

    def predict(self, belief: Belief, command: FloatArray) -> Belief:
        """One tick later, having commanded postures (B, F): x' = A x + B c + b, P' = A P A^T + Q."""
        a = self.dynamics.transition
        mean = (a @ belief.mean[..., None])[..., 0] + self.dynamics.control * command[..., None] + self.dynamics.offset
        if self.expectation is not None:
            posture, rate, _ = np.moveaxis(belief.mean, -1, 0)
            line = self.dynamics.offset[:, 0] + self.dynamics.control[:, 0] * (command - posture)
            departure = self.expectation(rate, command - posture) - line
            mean[..., 0] += departure
            mean[..., 1] += a[:, 1, 2] * departure
        return Belief(mean, a @ belief.covariance @ a.transpose(0, 2, 1) + self.dynamics.noise)

    def correct(self, belief: Belief, posture: FloatArray, rate: FloatArray) -> Belief:
        """Having felt (B, F) posture and rate: x + K (z - H x), (1 - K H) P, K = P H^T (H P H^T + R)^-1."""
        p = belief.covariance
        gain = p[:, :, :2] @ np.linalg.inv(p[:, :2, :2] + self.noise)
        surprise = np.stack([posture, rate], -1) - belief.mean[..., :2]
        covariance = p - gain @ p[:, :2, :]
        return Belief(
            belief.mean + (gain @ surprise[..., None])[..., 0], (covariance + covariance.transpose(0, 2, 1)) / 2
        )
