"""Looking at something: Eq. (1) with an image position as the sub-goal.

Where a thing is on the retina is the state, in the middle is where it should be, a saccade is the action. Motors are
asked one after the other, as the forward model of looking chains them: the one that carries things along u for the
change that takes the thing's u to the sub-goal, then, from where the thing is then expected, the other one for v.
"""

from typing import NamedTuple

import numpy as np

from babbling.axes import Axis, BoolArray, FloatArray, located
from babbling.looking import LookingMind
from imitation.inference.bayes import Posterior, action_posterior
from imitation.inference.selection import selection_rule

CANDIDATES = 1001
"""Changes of posture that Eq. (1) weighs, for each motor."""


class Saccade(NamedTuple):
    """What Eq. (1) chose for N things."""

    change: FloatArray
    """(N, 2) change of posture of each motor, rad."""
    uninformed: BoolArray
    """(N,) where Eq. (1) was 0/0 for a motor and the efference copy acted instead."""


class Fixation:
    """Chooses saccades that bring things to a place of one eye's image.

    Args:
        mind: what was learned of looking with two motors; it asks for postures within its pilot's reach.
        selection: name of a selection rule.
        eye: 0 left, 1 right.
    """

    def __init__(self, mind: LookingMind, selection: str = "mean", eye: int = 0) -> None:
        self.mind, self.rule, self.eye = mind, selection_rule(selection), eye
        limit = mind.pilot.reach.largest
        self.candidates = tuple(
            Axis("change", "rad", np.array([-limit[m]]), np.array([limit[m]]), CANDIDATES) for m in range(2)
        )

    def choose(
        self, things: FloatArray, posture: FloatArray, rng: np.random.Generator, goal: tuple[float, float] = (0.0, 0.0)
    ) -> Saccade:
        """(N, C) things from the image's middle and (N, 2) postures to saccades; `goal` is (u, v) from the middle."""
        change, uninformed = np.zeros((len(things), 2)), np.zeros(len(things), bool)
        for coordinate, motor in enumerate(self.mind.pilot.movers):
            here = self.mind.expect(things, posture, change)
            posterior, fallback = self.posterior(coordinate, here, posture + change, goal[coordinate])
            chosen = self.rule(posterior.probability[:, None], self.candidates[motor], rng)[:, 0]
            change[:, motor] = np.where(posterior.informed, chosen, fallback)
            uninformed |= ~posterior.informed
        return Saccade(change, uninformed)

    def posterior(
        self, coordinate: int, things: FloatArray, posture: FloatArray, goal: float
    ) -> tuple[Posterior, FloatArray]:
        """Eq. (1) for the motor of u (0) or v (1) over its candidates: P(a | s, s' = goal); beside it what the
        efference copy would do.

        The prior is uniform over the changes that stay within reach.
        """
        pilot, model = self.mind.pilot, self.mind.forward_model
        motor, seen = int(pilot.movers[coordinate]), 2 * self.eye + coordinate
        factor = motor * pilot.retina.coordinates + seen
        mine = slice(factor, factor + 1)
        actions = self.candidates[motor].points[0]
        shape = (len(things), CANDIDATES, 1)
        context = tuple(
            np.broadcast_to(value[:, None, None], shape)
            for value in (things[:, 2 * self.eye], things[:, 2 * self.eye + 1], posture[:, 1 - motor])
        )
        action = np.broadcast_to(actions[:, None], shape)
        wanted = goal - things[:, None, None, seen]
        outcome = wanted - pilot.straight(context, action, mine)
        axes = [axis.of(factor) for axis in model.axes]
        likelihood = located(1, axes, (*context, action, outcome)).read(model.predictive[mine])[..., 0]
        inside = axes[-1].soft(outcome).inside[..., 0]
        after = posture[:, None, motor] + actions
        within = (after >= pilot.reach.low[motor] - 1e-9) & (after <= pilot.reach.high[motor] + 1e-9)
        posterior = action_posterior(np.where(inside, likelihood, 0.0), within / np.maximum(within.sum(-1), 1)[:, None])
        possible = np.where(within, np.abs(outcome[..., 0]), np.inf).argmin(-1)
        return posterior, actions[possible]
