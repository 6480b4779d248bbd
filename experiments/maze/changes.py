"""What helps where the maze is not as it was shown: a wall that moved, a goal that nobody showed.

Everybody was shown the same demonstrations and made the same number of own steps in the maze as it was; then the maze
changes, and everybody walks. Planners (`rerouting`) go on feeling, walk after walk, each given up after three times the
least expected steps. Q-learning is judged after as many own steps in the changed maze as the axis says.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from copy import deepcopy
from itertools import product
from typing import Any

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.maze.mind import Experience, population
from experiments.maze.peers import MANY, best_acts, copied, q_learners, replayed
from experiments.maze.planners import PATIENCE, Explorers, arrivals, least_steps, wanderers
from experiments.maze.rerouting import Replanning, Rerouting, Walks, in_turn
from experiments.maze.worlds import moved_wall, new_goal
from experiments.shared.judging import interval_95
from experiments.shared.progress import Report
from imitation.acting.follow import Follower
from models.maze import TRUE_DYNAMICS, Maze

SEEDS, LEARNERS, WALKS = 5, 20, 3
"""Five draws of everything; learners of each method, goal and draw; walks of those who feel on."""
OWN_STEPS = 300
"""Own steps in the maze as it was."""
Q_STEPS = (0, 100, 300, 1000, 3000, 10_000)
WORLDS = ("as shown", "wall moved", "new goal")


def changes(maze: Maze, seed: int, demonstrations: int, report: Report) -> dict[str, Any]:
    """Share of walks that arrive in time, by world, method and own steps in it, with exact 95 % intervals."""
    runs: dict[str, dict[str, list[Walks]]] = {w: defaultdict(list) for w in WORLDS}
    goals = range(1, len(maze.goals) + 1)
    for k, goal in product(range(SEEDS), goals):
        many = population(maze, LEARNERS, max(MANY, demonstrations), 0, seed + 50 + k)
        few, rng = many.fewer(demonstrations), np.random.default_rng([seed, 31, k, goal])
        alone = Maze(maze.walls, maze.start, (maze.goals[goal - 1],))
        for world, after in zip(WORLDS, (alone, moved_wall(maze, goal, rng), new_goal(maze, rng)), strict=True):
            if after is not None:
                one = _One(many, few, after, None if world == "new goal" else goal, (seed, 32, k, goal))
                for method, walks in one.walks().items():
                    runs[world][method].append(walks)
        report((k + goal / len(goals)) / SEEDS)
    return {
        "changes": {world: {name: _told(each) for name, each in of.items()} for world, of in runs.items()},
        "changes_seeds": SEEDS,
        "changes_runs": SEEDS * LEARNERS * len(goals),
        "changes_own_steps_before": OWN_STEPS,
    }


def _told(runs: list[Walks]) -> dict[str, Any]:
    """Pooled over seeds and goals (in this order), walk by walk."""
    steps = np.mean([[before for before, _ in walks] for walks in runs], axis=0)
    arrived = np.array([[hits for _, hits in walks] for walks in runs])  # (seeds x goals, walks, R)
    count = arrived.shape[0] * arrived.shape[2]
    return {
        "own_steps": steps,
        "share": arrived.mean((0, 2)),
        "interval": [interval_95(int(hits), count) for hits in arrived.sum((0, 2))],
        "by_seed": [part.mean((0, 2)) for part in np.array_split(arrived, min(SEEDS, len(arrived)))],
    }


class _One:
    """One changed maze and everybody in it, all having been shown a goal, or none that is in this maze."""

    def __init__(self, many: Experience, few: Experience, after: Maze, goal: int | None, seed: tuple[int, ...]) -> None:
        self.many, self.few, self.after, self.goal, self.seed = many, few, after, goal, seed
        self.maze, self.end = many.maze, after.number(after.goals[0])
        self.number = int(np.random.SeedSequence(seed).generate_state(1)[0])
        self.limit = int(PATIENCE * least_steps(after, TRUE_DYNAMICS, self.end))

    def walks(self) -> dict[str, Walks]:
        """Method -> walk by walk, own steps in this maze before it and (R,) who arrived in time."""
        found: dict[str, Walks] = {}
        successor = prior = first = None
        if self.goal is not None:
            successor, prior = self.few.remembered(self.goal)
            we = self._explorers()
            chapter = Follower(we.model, we.places, successor, self.end, prior, copies=LEARNERS)
            found["imitation, going on as shown"] = self._walked(chapter, 1)
            found["copying"] = [(0.0, self._judged(copied(self.few, self.goal)))]
            clones = copied(self.many, self.goal, nearest=True)
            found[f"cloning, {MANY} demonstrations"] = [(0.0, self._judged(clones))]
            first = replayed(self.few.towards(self.goal), self.maze.cells)
            first = next(self._q(self.maze, (OWN_STEPS,), first))
        watching = self._explorers()
        for copy, episodes in enumerate(self.few.episodes):
            for episode in episodes:
                watching.watch(copy, episode.states)
        found["imitation"] = self._walked(Rerouting(deepcopy(watching), self.end, successor, prior), WALKS)
        found["value iteration, replanning"] = self._walked(Replanning(self._explorers(), self.end), WALKS)
        found["value iteration that watched"] = self._walked(Replanning(watching, self.end), WALKS)
        found["Q-learning from demonstrations"] = [
            (float(steps), max((self._judged(policy) for policy in best_acts(q)[0]), key=np.mean))
            for steps, q in zip(Q_STEPS, self._q(self.after, Q_STEPS, first), strict=True)
        ]
        return found

    def _explorers(self) -> Explorers:
        (we,) = wanderers(self.maze, LEARNERS, (OWN_STEPS,), self.number)
        return we

    def _q(self, maze: Maze, steps: Sequence[int], first: FloatArray | None) -> Iterator[FloatArray]:
        return q_learners(maze, np.array([self.end]), LEARNERS, steps, self.number, first)

    def _walked(self, follower: Follower, walks: int) -> Walks:
        return in_turn(follower, self.after, walks, self.limit, self.seed)

    def _judged(self, policy: IntArray) -> BoolArray:
        return arrivals(self.after, self.end, policy, self.limit, (*self.seed, 9), 1)[:, 0]
