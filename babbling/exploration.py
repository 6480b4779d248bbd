"""Ways to explore: what a babbler does with its motors.

An exploration is an endless stream of (B, M) motor commands, one per control tick; it never looks at the senses.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from babbling.axes import FloatArray
from babbling.kinds import Numbers


@dataclass(frozen=True)
class MotorRange:
    """What a babbler knows of its motors when it sets out."""

    low: Annotated[FloatArray, Numbers("motor", "rad")]
    """(M,) least useful command."""
    high: Annotated[FloatArray, Numbers("motor", "rad")]
    """(M,) greatest useful command."""
    rest: Annotated[FloatArray, Numbers("motor", "rad")]
    """(M,) command that keeps the body where it rests: where every exploration starts."""
    speed: Annotated[FloatArray, Numbers("motor", "rad/s", low=0)]
    """(M,) fastest useful change, command units per second."""
    jitter: Annotated[FloatArray, Numbers("motor", "rad", low=0)]
    """(M,) standard deviation of tick-to-tick noise on the command, command units."""


SHORTEST_S, LONGEST_S = 0.2, 4.0
"""Durations of a single move: shorter ones are jerks that no one would imitate, longer ones fill a bout."""


def smooth(
    motors: MotorRange, copies: int, tick_s: float, rng: np.random.Generator, decades: float = 2.0
) -> Iterator[FloatArray]:
    """Minimum-jerk moves between random postures, peak speeds log-uniform over so many decades up to the limit.

    Law of a move from x0 to x1 of duration T, with r = t / T (Flash and Hogan 1985):
    x = x0 + (x1 - x0)(10 r^3 - 15 r^4 + 6 r^5), peak speed 15/8 |x1 - x0| / T.
    """
    shape = (copies, len(motors.low))
    low, high, top = (np.broadcast_to(v, shape) for v in (motors.low, motors.high, motors.speed))
    start = np.broadcast_to(motors.rest, shape).copy()
    goal, clock, duration = start.copy(), np.zeros(shape), np.zeros(shape)
    while True:
        done = clock >= duration
        count = int(done.sum())
        if count:
            start[done] = goal[done]
            goal[done] = low[done] + (high - low)[done] * rng.random(count)
            speed = top[done] * 10.0 ** (-decades * rng.random(count))
            longest = LONGEST_S * speed * 8 / 15  # a slow move across the whole range would fill the whole bout
            goal[done] = np.clip(goal[done], start[done] - longest, start[done] + longest)
            duration[done] = np.maximum(15 / 8 * np.abs(goal[done] - start[done]) / speed, SHORTEST_S)
            clock[done] = 0.0
        clock += tick_s
        r = np.minimum(clock / duration, 1.0)
        yield start + (goal - start) * r**3 * (10 - 15 * r + 6 * r * r) + motors.jitter * rng.standard_normal(shape)


def in_turn(
    motors: MotorRange, copies: int, tick_s: float, rng: np.random.Generator, slot_s: float, still_s: float
) -> Iterator[FloatArray]:
    """One motor after the other, in an order of each copy's own: minimum-jerk moves of `slot_s`, either way, at half
    the greatest speed at most; before them nothing moves for `still_s`. What then changes is that motor's doing."""
    shape, rows = (copies, len(motors.low)), np.arange(copies)
    far = np.minimum(motors.speed / 2 * slot_s * 8 / 15, (motors.high - motors.low) / 2)  # there is room either way
    low, high, far = (np.broadcast_to(v, shape) for v in (motors.low, motors.high, far))
    now = np.broadcast_to(motors.rest, shape).copy()
    for _ in range(round(still_s / tick_s)):
        yield now.copy()
    ticks = max(int(slot_s / tick_s + 1e-9), 2)
    r = np.arange(1, ticks + 1) / ticks
    while True:
        for who in rng.permuted(np.tile(np.arange(shape[1]), (copies, 1)), axis=1).T:
            step = far[rows, who] * rng.choice([-1.0, 1.0], copies)
            there = now[rows, who] + step
            step = np.where((there < low[rows, who]) | (there > high[rows, who]), -step, step)
            start = now[rows, who]
            for share in r**3 * (10 - 15 * r + 6 * r * r):
                now[rows, who] = start + step * share
                yield now.copy()


def choices(motors: MotorRange, copies: int, tick_s: float, rng: np.random.Generator) -> Iterator[FloatArray]:
    """A fresh whole number in low .. high every tick: random acts out of a list (the chapter's maze wandering)."""
    shape = (copies, len(motors.low))
    while True:
        yield rng.integers(motors.low.astype(int), motors.high.astype(int) + 1, shape).astype(float)
