"""Many imitators of the maze at once, for studies."""

from collections.abc import Callable

import numpy as np

from babbling.loop import babble
from babbling.moves import Wanderer
from experiments.maze.learning import outings
from experiments.maze.mind import watched
from imitation.acting.follow import Journey, follow
from imitation.acting.subgoals import acyclic_subgoals
from imitation.episodes import Episode
from imitation.inference.priors import ActionPriors
from models.maze import ACTIONS, Maze, MazeBody, demonstrate

Report = Callable[[float], None]


class Imitators:
    """Many imitators at once, one per copy of the body: each has wandered and watched for itself."""

    def __init__(self, maze: Maze, copies: int, demonstrations: int, wander_steps: int, seed: int) -> None:
        self.maze, self.copies, self.seed = maze, copies, seed
        self.body = MazeBody(maze, copies=copies, seed=(seed, 21))
        self.episodes: list[list[Episode]] = [[] for _ in range(copies)]
        for goal in range(1, len(maze.goals) + 1):
            for k in range(demonstrations):
                walks = demonstrate(self.body, goal, np.random.default_rng([seed, 22, goal, k]))
                for own, walk in zip(self.episodes, walks, strict=True):
                    own.append(watched(walk, maze))
        self.priors = [ActionPriors.learned(e, len(maze.goals), maze.cells, len(ACTIONS)) for e in self.episodes]
        self.forward_model = babble(self.body, Wanderer(self.body, ACTIONS, alone=True), outings(wander_steps), seed)

    def teacher_steps(self, goal: int) -> float:
        """Mean steps of what was watched."""
        return float(np.mean([e.steps for own in self.episodes for e in own if e.goal == goal - 1]))

    def journeys(self, goal: int, selection: str, limit: int, *, prior: bool = True) -> Journey:
        """All imitate one goal."""
        mine = [[e for e in own if e.goal == goal - 1] for own in self.episodes]
        successor = np.array([acyclic_subgoals(own, self.maze.cells).successor for own in mine])
        priors = np.array([p.action()[goal - 1] for p in self.priors]) if prior else None
        end = self.maze.number(self.maze.goals[goal - 1])
        rng = np.random.default_rng([self.seed, 23, goal])
        return follow(self.body, self.forward_model, successor, end, priors, selection=selection, rng=rng, limit=limit)
