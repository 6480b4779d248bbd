"""Babbling: act, feel, count (chapter, section 2.1).

Experience comes in bouts that start from rest and do not depend on each other, so that they can be run in any order, on
any machine, be interrupted and resumed, and still give the same counts.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple, Protocol, TypeVar

import numpy as np

from babbling.axes import FloatArray
from babbling.body import Body
from babbling.errors import BabblingError

BOUT_TICKS = 500


class Transitions(NamedTuple):
    """What a forward model counts; NaN marks "nothing to learn here for this factor"."""

    context: tuple[FloatArray, ...]
    """One (N, F) array per context axis."""
    action: FloatArray
    """(N, F)."""
    outcome: FloatArray
    """(N, F)."""


class Learns(Protocol):
    """A forward model, as babbling sees it."""

    @property
    def transitions(self) -> int:
        """How many were learned, all factors together."""


M = TypeVar("M", bound=Learns)


class Babbler(Protocol[M]):
    """What a body does when it babbles, and how what it feels is read."""

    def learn(self, model: M, motors: FloatArray, senses: FloatArray) -> None:
        """Have the forward model learn from a run out of rest: (T, B, M) commands, (T + 1, B, S) sensations."""

    def forward_model(self) -> M:
        """An empty forward model on this babbler's axes."""

    def stream(self, body: Body, rng: np.random.Generator) -> Iterator[FloatArray]:
        """Endless (B, M) commands for a bout that starts from rest."""


def explore(
    body: Body, stream: Iterator[FloatArray], ticks: int, onward: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Act for `ticks` from rest: (T, B, M) commands and (T + 1, B, S) sensations, the first at rest.

    With `onward`, the (B, S) last sensations, the body goes on from where it is instead.
    """
    senses = np.empty((ticks + 1, body.copies, len(body.sense_low)))
    motors = np.empty((ticks, body.copies, len(body.motor_low)))
    senses[0] = body.reset() if onward is None else onward
    for t in range(ticks):
        motors[t] = next(stream)
        senses[t + 1] = body.act(motors[t])
    return motors, senses


def flat(motors: FloatArray, senses: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """`explore`'s arrays as (N, S) sensations before, (N, M) commands, (N, S) sensations after."""
    width = senses.shape[-1]
    return senses[:-1].reshape(-1, width), motors.reshape(-1, motors.shape[-1]), senses[1:].reshape(-1, width)


def bouts(minutes: float, body: Body, longest: int = BOUT_TICKS) -> tuple[int, ...]:
    """Ticks of each bout, `longest` at most, that together make `minutes` of body time over all copies.

    Raises:
        BabblingError: no time at all, or less than one tick of it.
    """
    total = round(minutes * 60 / body.tick_s / body.copies) if np.isfinite(minutes) else 0
    if minutes <= 0 or total < 1:
        raise BabblingError(
            f"{minutes:g} minutes of babbling: it must be more than 0, at least one tick of {body.copies} copies "
            f"({body.tick_s * body.copies / 60:.2g} minutes)"
        )
    return tuple(min(longest, total - start) for start in range(0, total, longest))


def experience(body: Body, babbler: Babbler[M], seed: int, bout: int, ticks: int) -> tuple[FloatArray, FloatArray]:
    """What one bout feels like, `explore`'s shapes: depends on (body, babbler, seed, bout) alone."""
    return explore(body, babbler.stream(body, np.random.default_rng([seed, 3, bout])), ticks)


def babble(
    body: Body,
    babbler: Babbler[M],
    plan: tuple[int, ...],
    seed: int,
    *,
    onto: M | None = None,
    first: int = 0,
    after_bout: Callable[[int, M], None] = lambda bout, model: None,
    had: Iterable[tuple[FloatArray, FloatArray]] | None = None,
) -> M:
    """Run bouts `first` .. of `plan` and count them onto a forward model.

    Args:
        body: who babbles.
        babbler: how.
        plan: ticks of every bout (`bouts`).
        seed: randomness.
        onto: what earlier bouts left; None starts empty.
        first: the first bout still to do.
        after_bout: called with (bouts done, forward model so far): a progress bar, a checkpoint, a learning curve.
        had: the `experience` of these bouts, in order, where others have it; without, it is had here, bout by bout.
    """
    model = babbler.forward_model() if onto is None else onto
    if had is None:
        had = (experience(body, babbler, seed, bout, plan[bout]) for bout in range(first, len(plan)))
    for done, run in enumerate(had, first + 1):
        babbler.learn(model, *run)
        after_bout(done, model)
    return model
