"""Wandering among discrete states: bodies that act by a few single acts, and the map by which their senses are read.

The mind is handed what its senses mean: in which state it is, what else matters there (a relation between things, such
as "hands free"), and which outcome leads from one state to another. Learning and following read by the same map.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

import numpy as np

from babbling.axes import Axis, BoolArray, FloatArray, IntArray
from babbling.body import Body
from babbling.errors import BabblingError
from babbling.exploration import MotorRange, choices
from babbling.forward_model import ForwardModel
from babbling.loop import Transitions, flat


class StateMap(Protocol):
    """What (..., S) senses mean to somebody who tells discrete states apart."""

    @property
    def contexts(self) -> Mapping[str, tuple[str, ...]]:
        """Names and categories of the forward model's context axes; none where acts do the same everywhere."""

    @property
    def outcomes(self) -> tuple[str, ...]:
        """Names of the forward model's outcomes."""

    def number(self, senses: FloatArray) -> IntArray:
        """(...) number of the state."""

    def context(self, senses: FloatArray) -> tuple[IntArray, ...]:
        """(...) category on each context axis."""

    def outcome(self, here: IntArray, there: IntArray) -> IntArray:
        """(...) outcome that leads from one state to another."""

    def lawful(self, senses: FloatArray) -> BoolArray:
        """(...) whether acts that begin here do what they do elsewhere; where not, there is nothing to learn."""

    def name(self, number: int) -> str:
        """A state, for people."""


class Wanderer:
    """Wanders at random among states and counts what its acts lead to.

    Args:
        body: who wanders (only its ranges are read).
        states: how its senses are read.
        actions: names of the actions, for people.
        alone: whether every copy learns for itself (a forward model with one factor per copy).
    """

    def __init__(self, body: Body, states: StateMap, actions: Sequence[str], *, alone: bool = False) -> None:
        if len(body.motor_low) != 1 or int(body.motor_high[0] - body.motor_low[0]) + 1 != len(actions):
            raise BabblingError(f"a wanderer needs one motor with {len(actions)} choices ({', '.join(actions)})")
        self.states, self.actions, self.factors = states, tuple(actions), body.copies if alone else 1
        self.fingerprint = body.fingerprint

    def learn(self, model: ForwardModel, motors: FloatArray, senses: FloatArray) -> None:
        """Count a run."""
        model.observe(*self.transitions(*flat(motors, senses)))

    def transitions(self, before: FloatArray, motors: FloatArray, after: FloatArray) -> Transitions:
        """(N, S), (N, 1), (N, S) in; NaN marks transitions from which nothing is to be learned."""
        outcome = self.states.outcome(self.states.number(before), self.states.number(after))
        learned = np.where(self.states.lawful(before), outcome, np.nan)
        context = tuple(category.reshape(-1, self.factors).astype(float) for category in self.states.context(before))
        return Transitions(context, motors[:, 0].reshape(-1, self.factors), learned.reshape(-1, self.factors))

    def forward_model(self) -> ForwardModel:
        """Nothing learned yet: P(outcome | context, action), no prior."""
        return ForwardModel(
            [Axis.categorical(name, labels, self.factors) for name, labels in self.states.contexts.items()],
            Axis.categorical("action", self.actions, self.factors),
            Axis.categorical("outcome", self.states.outcomes, self.factors),
            factors=[str(i) for i in range(self.factors)],
            fingerprint=self.fingerprint,
        )

    def stream(self, body: Body, rng: np.random.Generator) -> Iterator[FloatArray]:
        """Random acts without end."""
        still = np.zeros_like(body.motor_low)
        motors = MotorRange(body.motor_low, body.motor_high, still, still, still)
        return choices(motors, body.copies, body.tick_s, rng)
