"""Peers without a forward model: Q-learning, copying, behaviour cloning."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray, IntArray
from experiments.maze.mind import Experience, places_of
from imitation.episodes import Episode
from models.maze import ACTIONS, Maze, MazeBody

MANY = 10
"""Demonstrations of each goal that behaviour cloning gets."""


class Learner(NamedTuple):
    """One setting of Q-learning, textbook and optimistic ones side by side."""

    rate: float
    """Step size; of a decaying one, the exponent w in visits^-w, negative."""
    explore: float
    """Share of random actions while learning (epsilon-greedy)."""
    discount: float
    optimistic: bool
    """-1 per step and zero at first (every untried action looks best), or +1 at the goal and zero elsewhere."""


Q_SETTINGS = (
    Learner(0.1, 0.1, 0.98, False),
    Learner(0.5, 0.1, 0.98, False),
    Learner(0.1, 0.1, 1.0, True),
    Learner(0.2, 0.05, 1.0, True),
    Learner(0.3, 0.0, 1.0, True),
    Learner(0.5, 0.1, 1.0, True),
    Learner(-0.6, 0.05, 1.0, True),
)


def q_learners(
    maze: Maze, goals: IntArray, learners: int, budgets: Sequence[int], seed: int, first: FloatArray | None = None
) -> Iterator[FloatArray]:
    """(A, G, settings, learners, S) values that Q-learning holds after each budget of steps.

    Every learner has its own walker and table, and starts over at its goal.

    Args:
        maze: where.
        goals: (G,) cells.
        learners: how many per goal and setting.
        budgets: steps, in rising order; 0 is what they begin with.
        seed: randomness.
        first: values to begin with; zeros if not given.
    """
    shape = (len(ACTIONS), len(goals), len(Q_SETTINGS), learners, maze.cells)
    goal = np.repeat(goals, len(Q_SETTINGS) * learners)
    size, settings = len(goal), np.repeat(Q_SETTINGS, learners, axis=0)
    rate, epsilon, discount, optimistic = np.tile(settings.T, len(goals))
    cost, prize = -optimistic, 1 - optimistic  # +1 at the goal for those who pay nothing on the way
    body, rng = MazeBody(maze, copies=size, seed=(seed, 15)), np.random.default_rng([seed, 16])
    # actions first: reductions over them run along long rows
    q = (np.zeros(shape) if first is None else first.copy()).reshape(len(ACTIONS), size, -1)
    visits, decaying = np.zeros(q.shape, np.int32), np.flatnonzero(rate < 0)
    exponent, longest = rate[decaying], 4 * maze.cells
    row, age = np.arange(size), np.zeros(size, int)
    body.reset()
    for step in range(budgets[-1] + 1):
        if step in budgets:
            yield q.reshape(shape).copy()
        cell = body.cell
        here = q[:, row, cell]
        noise = rng.random((len(ACTIONS) + 1, size), dtype=np.float32)
        best = np.where(here == here.max(0), noise[1:], -1.0).argmax(0)
        action = np.where(noise[0] < epsilon, (noise[1] * len(ACTIONS)).astype(int), best)
        there = body.move(action)
        arrived = there == goal
        target = np.where(arrived, prize + cost, cost + discount * q[:, row, there].max(0))
        where = (action[decaying], row[decaying], cell[decaying])
        visits[where] += 1
        rate[decaying] = visits[where] ** exponent
        q[action, row, cell] += rate * (target - here[action, row])
        age += 1
        over = arrived | (age >= longest)
        body.put_back(over)
        age[over] = 0


def replayed(shown: Sequence[Sequence[Episode]], cells: int, times: int = 10) -> FloatArray:
    """(A, settings, learners, S) values from which Q-learning starts that each learner's demonstrations gave it.

    They are replayed as off-policy experience, last step first. What was not shown is worth as little as never to
    arrive: nothing, or twice the longest demonstration's steps to pay (zeros would make every other act look better).
    """
    reward, paying = np.array([(setting.discount, setting.optimistic) for setting in Q_SETTINGS]).T
    q = np.zeros((len(ACTIONS), len(Q_SETTINGS), len(shown), cells))
    for learner, episodes in enumerate(shown):
        mine = q[:, :, learner]
        mine[:] = -2.0 * paying[:, None] * max(episode.steps for episode in episodes)
        for episode in [*episodes] * times:
            for t in range(episode.steps - 1, -1, -1):
                here, act, there = episode.states[t], episode.actions[t], episode.states[t + 1]
                ahead = 1 - paying if t == episode.steps - 1 else reward * mine[:, :, there].max(0)
                mine[act, :, here] += 0.5 * (ahead - paying - mine[act, :, here])
    return q


def best_acts(worth: FloatArray) -> IntArray:
    """(...) the act of most worth, by (A, ...) values or counts; -1 where all are worth the same."""
    return np.where(worth.max(0) == worth.min(0), -1, worth.argmax(0))


def copied(watchers: Experience, goal: int, *, nearest: bool = False) -> IntArray:
    """(R, S) policies of those who do what they most often saw done in a cell on the way to goal 1, 2, ...; -1 where
    they saw nothing. With `nearest` (behaviour cloning) it is what was done in the nearest cell where anything was.
    """
    policies = best_acts(np.array([own.counts[goal - 1].T for own in watchers.priors]).swapaxes(0, 1))
    place = places_of(watchers.maze).place(np.arange(watchers.maze.cells))
    for own in policies if nearest else []:
        seen = np.flatnonzero(own >= 0)
        own[:] = own[seen[((place[:, None] - place[seen]) ** 2).sum(-1).argmin(1)]]
    return policies
