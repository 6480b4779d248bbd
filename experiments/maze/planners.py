"""Value iteration, and those who wander in a maze and learn what acts do and where walls are.

The question is the chapter's (section 3.2): how many trials until the goal is reached reliably? Reliable: at least 95 %
of runs arrive within three times the least expected number of steps. Dynamic programming here minimises the expected
number of steps J to the goal (Bellman 1957; Watkins 1989 for Q-learning):

    J(s) = 1 + min_a sum_o P(o | a) J(lead(s, o)),     J(goal) = 0
"""

from collections.abc import Iterator, Sequence

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.loop import explore, flat
from babbling.moves import Places
from experiments.maze.mind import wanderer
from imitation.episodes import Episode
from models.maze import ACTIONS, Maze, MazeBody

RELIABLE, PATIENCE = 0.95, 3.0


def steps_to_go(
    lead: IntArray,
    dynamics: FloatArray,
    goal: int,
    horizon: int = 1000,
    value: FloatArray | float = 0.0,
    passable: FloatArray | float = 1.0,
    exact: float = 1e-3,
) -> FloatArray:
    """(R, S, A) expected steps to the goal after each action, for R planners at once.

    Args:
        lead: (S, O) cell that each outcome leads to.
        dynamics: (R, A, O) as each planner believes.
        goal: cell.
        horizon: the most steps looked ahead (a goal may be believed all but out of reach).
        value: (R, S) J to begin with.
        passable: (R, O, S) P(an outcome leads there); one stays otherwise.
        exact: ends when no J changes by more.
    """
    expected = np.broadcast_to(np.asarray(value, float), (len(dynamics), len(lead)))
    for _ in range(horizon):
        here = expected[:, None]
        to_go: FloatArray = 1 + dynamics @ (here + passable * (expected[:, lead.T] - here))
        to_go[..., goal] = 0
        expected = to_go.min(1)
        if np.abs(expected - here[:, 0]).max() < exact:
            break
    return to_go.swapaxes(1, 2)


def arrivals(maze: Maze, goal: int, policy: IntArray, limit: int, seed: tuple[int, ...], episodes: int) -> BoolArray:
    """(R, episodes) whether (R, S) policies, -1 where any act will do, reach the goal cell within the limit."""
    walkers = len(policy) * episodes
    body = MazeBody(maze, copies=walkers, seed=seed)
    owner = np.repeat(np.arange(len(policy)), episodes)
    body.reset()
    arrived, rng = np.zeros(walkers, bool), np.random.default_rng([*seed, 17])
    for _ in range(limit):
        action, at_random = policy[owner, body.cell], rng.integers(0, len(ACTIONS), walkers)
        arrived |= body.move(np.where(action < 0, at_random, action)) == goal
        if arrived.all():
            break
    return arrived.reshape(len(policy), episodes)


def least_steps(maze: Maze, dynamics: FloatArray, goal: int) -> float:
    """Expected steps from the start under the best policy, all being known."""
    return float(steps_to_go(maze.lead, dynamics[None], goal)[0, maze.number(maze.start)].min())


class Explorers:
    """R walkers in one maze, each of whom learns for itself what acts do and where walls are."""

    def __init__(self, maze: Maze, walkers: int, seed: Sequence[int]) -> None:
        self.body = MazeBody(maze, copies=walkers, seed=seed)
        self.walker, self.places = wanderer(self.body, alone=True), Places.of(self.body)
        self.model = self.walker.forward_model()
        rim = np.zeros_like(maze.walls)
        rim[-1, :, 0], rim[:, -1, 1], rim[0, :, 2], rim[:, 0, 3] = True, True, True, True
        self.open = Maze(rim, maze.start, maze.goals).lead
        self.inside = self.open[:, :4] != np.arange(maze.cells)[:, None]
        self.closed = np.zeros((walkers, maze.cells, 4), bool)
        """(R, S, N E S W) sides where a wall was felt, the last time it was felt there."""
        self.passed = np.zeros_like(self.closed)
        """Sides known to be open."""

    def feel(self, senses: FloatArray, fresh: BoolArray | None = None) -> None:
        """(..., R, S) senses: walls where touch says so, from now on, for the neighbour as well; `fresh` (R, S, 4)
        sides are marked as felt."""
        cells, touch = self.places.number(senses), self.body.senses.read(senses, "touch") > 0
        walker = np.broadcast_to(np.arange(len(self.closed)), cells.shape)
        for side in range(4):
            for where, across in ((cells, side), (self.open[cells, side], (side + 2) % 4)):
                real = (where != cells) | (across == side)  # the rim has no neighbour
                at = walker[real], where[real], across
                self.closed[at], self.passed[at] = touch[..., side][real], ~touch[..., side][real]
                if fresh is not None:
                    fresh[at] = True

    def watch(self, episodes: Sequence[Sequence[Episode]]) -> None:
        """Where somebody was seen to pass from cell to cell, there is no wall; what each walker watched."""
        for walker, own in enumerate(episodes):
            for episode in own:
                before, after = (
                    ends[np.diff(episode.states) != 0] for ends in (episode.states[:-1], episode.states[1:])
                )
                side = self.places.outcome(before, after)
                self.passed[walker, before, side] = self.passed[walker, after, (side + 2) % 4] = True


def wanderers(maze: Maze, copies: int, budgets: Sequence[int], seed: int) -> Iterator[Explorers]:
    """Random walkers, each alone, after each budget of steps: one walk, never put back."""
    we = Explorers(maze, copies, (seed, 11))
    stream, senses, done = we.walker.stream(we.body, np.random.default_rng([seed, 12])), we.body.reset(), 0
    for budget in budgets:
        motors, felt = explore(we.body, stream, budget - done, onward=senses)
        we.model.observe(*we.walker.transitions(*flat(motors, felt)))
        we.feel(felt)
        senses, done = felt[-1], budget
        yield we
