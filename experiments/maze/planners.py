"""What imitation is compared with: value iteration on learned dynamics, and Q-learning. All learn by own steps.

The question is the chapter's (section 3.2): how many trials until the goal is reached reliably? Reliable: at least 95 %
of runs arrive within three times the least expected number of steps. Dynamic programming here minimises the expected
number of steps J to the goal (Bellman 1957; Watkins 1989 for Q-learning):

    J(s) = 1 + min_a sum_o P(o | a) J(lead(s, o)),     J(goal) = 0
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.loop import explore, flat
from babbling.moves import Places
from experiments.maze.mind import wanderer
from experiments.shared.progress import Report
from imitation.acting.follow import believed
from models.maze import ACTIONS, Maze, MazeBody

RELIABLE, PATIENCE = 0.95, 3.0


class Learner(NamedTuple):
    """One setting of Q-learning, textbook and optimistic ones side by side."""

    name: str
    rate: float
    """Step size; of a decaying one, the exponent w in visits^-w, negative."""
    explore: float
    """Share of random actions while learning (epsilon-greedy)."""
    discount: float
    optimistic: bool
    """-1 per step and zero at first (every untried action looks best), or +1 at the goal and zero elsewhere."""


Q_SETTINGS = (
    Learner("reward at the goal, rate .1, explore .1", 0.1, 0.1, 0.98, False),
    Learner("reward at the goal, rate .5, explore .1", 0.5, 0.1, 0.98, False),
    Learner("step cost, rate .1, explore .1", 0.1, 0.1, 1.0, True),
    Learner("step cost, rate .2, explore .05", 0.2, 0.05, 1.0, True),
    Learner("step cost, rate .3, explore 0", 0.3, 0.0, 1.0, True),
    Learner("step cost, rate .5, explore .1", 0.5, 0.1, 1.0, True),
    Learner("step cost, rate visits^-.6, explore .05", -0.6, 0.05, 1.0, True),
)


def steps_to_go(lead: IntArray, dynamics: FloatArray, goal: int, horizon: int = 1000) -> FloatArray:
    """(R, S, A) expected steps to the goal after each action, for R planners at once.

    Args:
        lead: (R or 1, S, O) cell that each outcome leads to, as the planner believes.
        dynamics: (R, A, O) as the planner believes.
        goal: cell.
        horizon: the most steps looked ahead (a goal may be believed all but out of reach).
    """
    value = np.zeros((len(dynamics), lead.shape[1]))
    for _ in range(horizon):
        to_go = _sweep(value, lead, dynamics, goal)
        before, value = value, to_go.min(-1)
        if np.abs(value - before).max() < 1e-3:
            break
    return to_go


def _sweep(value: FloatArray, lead: IntArray, dynamics: FloatArray, goal: int) -> FloatArray:
    """(R, S, A) expected steps after each action where (R, S) `value` remains after it."""
    to_go = 1 + value[np.arange(len(value))[:, None, None], lead] @ dynamics.transpose(0, 2, 1)
    to_go[:, goal] = 0
    return to_go


def arrivals(maze: Maze, goal: int, policy: IntArray, limit: int, seed: tuple[int, ...], episodes: int) -> BoolArray:
    """(R, episodes) whether (R, S) policies reach the goal cell from the start within the limit."""
    walkers = len(policy) * episodes
    body = MazeBody(maze, copies=walkers, seed=seed)
    owner = np.repeat(np.arange(len(policy)), episodes)
    body.reset()
    arrived = np.zeros(walkers, bool)
    for _ in range(limit):
        arrived |= body.move(policy[owner, body.cell]) == goal
        if arrived.all():
            break
    return arrived.reshape(len(policy), episodes)


def least_steps(maze: Maze, dynamics: FloatArray, goal: int) -> float:
    """Expected steps from the start under the best policy, all being known."""
    return float(steps_to_go(maze.lead[None], dynamics[None], goal)[0, maze.number(maze.start)].min())


class Known(NamedTuple):
    """What R walkers know at one moment."""

    tables: FloatArray
    """(R, A, O) learned dynamics, uniform where an action was never counted."""
    lead: IntArray
    """(R, S, O) where outcomes lead; a wall felt from one side is known from the other, one never felt is not there."""


class Explorers:
    """R walkers in one maze, each of whom learns for itself what acts do and where walls are."""

    def __init__(self, maze: Maze, walkers: int, seed: tuple[int, ...]) -> None:
        self.body = MazeBody(maze, copies=walkers, seed=seed)
        self.walker, self.places = wanderer(self.body, alone=True), Places.of(self.body)
        self.model = self.walker.forward_model()
        rim = np.zeros_like(maze.walls)
        rim[-1, :, 0], rim[:, -1, 1], rim[0, :, 2], rim[:, 0, 3] = True, True, True, True
        self._open = Maze(rim, maze.start, maze.goals).lead
        self._felt = np.zeros((walkers, maze.cells, 5), bool)

    def learn(self, motors: FloatArray, felt: FloatArray) -> None:
        """(T, R, 1) acts, and the (T + 1, R, S) senses before the first and after each."""
        self.model.observe(*self.walker.transitions(*flat(motors, felt)))
        self.feel(felt[1:])

    def feel(self, senses: FloatArray) -> None:
        """(..., R, S) senses: walls where touch says so."""
        cells = self.places.number(senses)
        walker = np.broadcast_to(np.arange(len(self._felt)), cells.shape)
        self._felt[walker, cells, :4] = self.body.senses.read(senses, "touch") > 0

    @property
    def known(self) -> Known:
        """What they know by now."""
        both = self._felt.copy()
        for side in range(4):
            beyond = self._open[:, side]
            inside = beyond != np.arange(len(beyond))
            both[:, inside, side] |= self._felt[:, beyond[inside], (side + 2) % 4]
        return Known(believed(self.model), np.where(both, np.arange(both.shape[1])[:, None], self._open))


def wanderers(maze: Maze, copies: int, budgets: Sequence[int], seed: int, report: Report) -> Iterator[Known]:
    """What random walkers, each alone, know after each budget of steps: one walk, never put back."""
    we = Explorers(maze, copies, (seed, 11))
    stream, senses, done = we.walker.stream(we.body, np.random.default_rng([seed, 12])), we.body.reset(), 0
    we.feel(senses)
    for budget in budgets:
        while done < budget:
            motors, felt = explore(we.body, stream, min(5000, budget - done), onward=senses)
            we.learn(motors, felt)
            senses, done = felt[-1], done + len(motors)
            report(done / budgets[-1])
        yield we.known


def replanners(
    maze: Maze, goal: int, copies: int, budgets: Sequence[int], seed: int, first: int = 300, sweeps: int = 2
) -> Iterator[Known]:
    """What planners know who wander `first` steps and then walk by their own optimistic plan, trial after trial.

    The plan is improved by a few sweeps of value iteration at every step, from where it was.
    """
    we, rng = Explorers(maze, copies, (seed, 13)), np.random.default_rng([seed, 14])
    senses, known, value = we.body.reset(), we.known, np.zeros((copies, maze.cells))
    for step in range(1, budgets[-1] + 1):
        if step > first:
            for _ in range(sweeps):
                to_go = _sweep(value, known.lead, known.tables, goal)
                value = to_go.min(-1)
            action = to_go[np.arange(copies), we.places.number(senses)].argmin(-1)
        else:
            action = rng.integers(0, len(ACTIONS), copies)
        motors = action[:, None].astype(float)
        we.learn(motors[None], np.stack([senses, we.body.act(motors)]))
        we.body.put_back(we.body.cell == goal)
        senses = we.body.feel()
        if step % 10 == 0 or step == first:
            known = we.known
        if step in budgets:
            yield we.known


def q_learners(maze: Maze, goals: IntArray, learners: int, budgets: Sequence[int], seed: int) -> Iterator[IntArray]:
    """(G, settings, learners, S) greedy policies that Q-learning holds after each budget of steps.

    Every learner has its own walker and table, and starts over at its goal.

    Args:
        maze: where.
        goals: (G,) cells.
        learners: how many per goal and setting.
        budgets: steps, in rising order.
        seed: randomness.
    """
    shape = (len(goals), len(Q_SETTINGS), learners)
    size, settings = int(np.prod(shape)), np.array([setting[1:] for setting in Q_SETTINGS])
    goal = np.broadcast_to(goals[:, None, None], shape).reshape(size)
    columns = np.broadcast_to(settings.T[:, None, :, None], (4, *shape)).copy()
    rate, epsilon, discount, optimistic = columns.reshape(4, size)
    cost, prize = -optimistic, 1 - optimistic  # +1 at the goal for those who pay nothing on the way
    body, rng = MazeBody(maze, copies=size, seed=(seed, 15)), np.random.default_rng([seed, 16])
    q = np.zeros((len(ACTIONS), size, maze.cells))  # actions first: reductions over them run along long rows
    visits, decaying = np.zeros(q.shape, np.int32), np.flatnonzero(rate < 0)
    exponent, longest = rate[decaying], 4 * maze.cells
    row, age = np.arange(size), np.zeros(size, int)
    body.reset()
    cell = body.cell
    for step in range(1, budgets[-1] + 1):
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
        cell = body.cell
        if step in budgets:
            yield q.argmax(0).reshape(*shape, maze.cells)
