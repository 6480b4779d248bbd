"""What helps where the maze is not as it was shown: a wall that moved, a goal that nobody showed.

Everybody was shown the same demonstrations and made the same number of own steps in the maze as it was; then the maze
changes, and everybody walks. Planners (`rerouting`) go on feeling, walk after walk, each given up after three times the
least expected steps. Q-learning is judged after as many own steps in the changed maze as the axis says.
"""

from collections import defaultdict
from copy import deepcopy
from itertools import product
from typing import Any

import numpy as np

from babbling.axes import BoolArray, IntArray
from experiments.maze.mind import Experience, population
from experiments.maze.peers import MANY, best_acts, copied, q_learners, replayed
from experiments.maze.planners import PATIENCE, arrivals, least_steps, wanderers
from experiments.maze.rerouting import Replanning, Rerouting, Walks, in_turn
from experiments.maze.worlds import moved_wall, new_goal
from experiments.shared.judging import intervals_95
from experiments.shared.kept import once
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
        for world, of in once(_worlds, maze, seed, demonstrations, k, goal).items():
            for method, walks in of.items():
                runs[world][method].append(walks)
        report((k + goal / len(goals)) / SEEDS)
    return {"changes": {world: {name: _told(each) for name, each in of.items()} for world, of in runs.items()}}


def _worlds(maze: Maze, seed: int, demonstrations: int, k: int, goal: int) -> dict[str, dict[str, Walks]]:
    """One draw and goal: world -> method -> walks."""
    many, found = population(maze, LEARNERS, max(MANY, demonstrations), 0, seed + 50 + k), {}
    few, rng = many.fewer(demonstrations), np.random.default_rng([seed, 31, k, goal])
    alone = Maze(maze.walls, maze.start, (maze.goals[goal - 1],))
    for world, after in zip(WORLDS, (alone, moved_wall(maze, goal, rng), new_goal(maze, rng)), strict=True):
        if after is not None:
            shown = None if world == "new goal" else goal
            found[world] = _everybody(many, few, after, shown, (seed, 32, k, goal))
    return found


def _told(runs: list[Walks]) -> dict[str, Any]:
    """Pooled over seeds and goals (in this order), walk by walk."""
    arrived = np.array([[hits for _, hits in walks] for walks in runs]).swapaxes(1, 2)  # (seeds x goals, R, walks)
    return {
        "own_steps": np.mean([[before for before, _ in walks] for walks in runs], axis=0),
        "share": arrived.mean((0, 1)),
        "interval": intervals_95(np.concatenate(arrived)),
        "by_seed": [part.mean((0, 1)) for part in np.array_split(arrived, min(SEEDS, len(arrived)))],
    }


def _everybody(
    many: Experience, few: Experience, after: Maze, goal: int | None, seed: tuple[int, ...]
) -> dict[str, Walks]:
    """Method -> walk by walk, where all were shown the goal of the maze `after`, or (None) others."""
    maze, end, found = many.maze, after.number(after.goals[0]), dict[str, Walks]()
    limit = int(PATIENCE * least_steps(after, TRUE_DYNAMICS, end))
    number = int(np.random.SeedSequence(seed).generate_state(1)[0])

    we = next(wanderers(maze, LEARNERS, (OWN_STEPS,), number))
    watching = deepcopy(we)
    watching.watch(few.episodes)

    def walked(follower: Follower, walks: int = WALKS) -> Walks:
        return in_turn(follower, after, walks, limit, seed)

    def judged(policy: IntArray) -> BoolArray:
        return arrivals(after, end, policy, limit, (*seed, 9), 1)[:, 0]

    successor = prior = first = None
    if goal is not None:
        successor, prior = few.remembered(goal)
        first = replayed(few.towards(goal), maze.cells)
        chapter = Follower(we.model, we.places, successor, end, prior, copies=LEARNERS)
        found["imitation, going on as shown"] = walked(chapter, 1)
        found["copying"] = [(0.0, judged(copied(few, goal)))]
        found[f"cloning, {MANY} demonstrations"] = [(0.0, judged(copied(many, goal, nearest=True)))]
        first = next(q_learners(maze, np.array([end]), LEARNERS, (OWN_STEPS,), number, first))
    found["imitation"] = walked(Rerouting(deepcopy(watching), end, successor, prior))
    found["value iteration, replanning"] = walked(Replanning(we, end))
    found["value iteration that watched"] = walked(Replanning(watching, end))
    values = q_learners(after, np.array([end]), LEARNERS, Q_STEPS, number, first)
    found["Q-learning from demonstrations"] = [
        (float(steps), max((judged(policy) for policy in best_acts(q)[0]), key=np.mean))
        for steps, q in zip(Q_STEPS, values, strict=True)
    ]
    return found
