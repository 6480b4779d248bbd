"""The believed state of one's own body: a Kalman filter per factor over posture, rate and slow bias.

Chapter, section 3.2: states are estimated from raw senses by Kalman filtering. Prediction comes from the efference copy
through the dynamics learned by babbling, correction from the senses with the noise they showed at rest; no gain is set
by hand. The bias is what the body does and the forward model did not expect: the felt error of the match-to-target loop
(Figure 9), slowly learned while moving.
"""

import numpy as np

from babbling import kalman
from babbling.axes import BoolArray, FloatArray
from babbling.dynamics import LinearDynamics
from babbling.kalman import Belief
from babbling.schema import BodySchema

LONG = 100
"""Ticks after which a covariance has come to rest."""
USUAL = 3.0
"""Standard deviations of a joint's bias while babbling."""


class StateEstimate:
    """Beliefs N(mean (B, F, 3), covariance (F, 3, 3)) over (posture, rate, bias); all copies share a covariance, which
    depends on the dynamics and not on what was felt.

    Args:
        schema: the noise of the senses.
        dynamics: the linear account of posture and rate.
    """

    def __init__(self, schema: BodySchema, dynamics: LinearDynamics) -> None:
        self.dynamics = dynamics
        noise = np.zeros((len(schema.noise), 2, 2))
        noise[:, 0, 0], noise[:, 1, 1] = schema.noise**2, schema.rate_noise**2
        self.system = kalman.System(dynamics.transition, dynamics.noise, np.eye(2, 3), noise)

    def doubt(self, kernel: FloatArray) -> FloatArray:
        """(F,) variance of how far off believed postures are, once one has felt for long, averaged over successive
        ticks with the weights of a kernel.

        What a belief is off by, e, goes on as (1 - K H) F e, K the gain: Cov[e_{t+n}, e_t] = ((1 - K H) F)^n P.
        """
        nothing = np.zeros((1, len(self.dynamics.coasting)))
        belief = self.start(nothing, nothing)
        for _ in range(LONG):
            belief, gain = kalman.update(
                self.system, kalman.predict(self.system, belief), np.zeros((*nothing.shape, 2))
            )
        onward = (np.eye(3) - gain[0] @ self.system.observation) @ self.system.transition
        apart, lagged = np.abs(np.subtract.outer(*2 * (np.arange(len(kernel)),))), belief.covariance
        found = np.zeros(nothing.shape[1])
        for lag in range(len(kernel)):
            found += lagged[:, 0, 0] * (np.outer(kernel, kernel)[apart == lag]).sum()
            lagged = onward @ lagged
        return found

    def start(self, posture: FloatArray, rate: FloatArray) -> Belief:
        """Belief after the first (B, F) senses: they are all there is, and the bias is unknown."""
        covariance = np.zeros((posture.shape[1], 3, 3))
        covariance[:, :2, :2] = self.system.observation_noise
        covariance[:, 2, 2] = self.dynamics.bias_variance
        return Belief(np.stack([posture, rate, np.zeros_like(posture)], -1), covariance)

    def predict(self, belief: Belief, command: FloatArray, expected: FloatArray | None = None) -> Belief:
        """One tick later, having commanded postures (B, F): the efference copy pushes the belief on.

        Args:
            belief: before.
            command: what was commanded.
            expected: (B, F) displacement beyond coasting that the forward model expects of it. Where it departs from
                the line (stiction), the prediction departs with it, the rate as it would under a bias of that size;
                None keeps to the line. The covariances are the line's (an extended Kalman filter whose Jacobian is the
                average one).
        """
        push = self.dynamics.control * command[..., None] + self.dynamics.offset
        if expected is not None:
            line = self.dynamics.offset[:, 0] + self.dynamics.control[:, 0] * (command - belief.mean[..., 0])
            departure = expected - line
            push[..., 0] += departure
            push[..., 1] += self.dynamics.transition[:, 1, 2] * departure
        return kalman.predict(self.system, belief, push)

    def correct(self, belief: Belief, posture: FloatArray, rate: FloatArray) -> Belief:
        """Having felt (B, F) posture and rate."""
        return kalman.update(self.system, belief, np.stack([posture, rate], -1))[0]

    def usual(self, belief: Belief) -> tuple[Belief, BoolArray]:
        """A bias no larger than babbling has shown; and (B, F) where there would be more: there something is in the
        way, no reason to push harder."""
        most, mean = USUAL * np.sqrt(self.dynamics.bias_variance), belief.mean.copy()
        mean[..., 2] = np.clip(mean[..., 2], -most, most)
        return Belief(mean, belief.covariance), np.abs(belief.mean[..., 2]) > most
