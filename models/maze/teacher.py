"""The teacher: knows the maze, takes a shortest path, is pushed about by the same noise as everyone.

The chapter does not say how its teacher chose; this one always takes an action that shortens its way, and where several
do, each walk has its own liking (so that two demonstrations of one goal differ, as in the chapter's Figure 6 (b)).
"""

from typing import NamedTuple

import numpy as np

from models.arrays import IntArray
from models.errors import BodyError
from models.maze.body import MazeBody
from models.maze.maze import ACTIONS, STEPS, Maze, Place

PATIENCE = 40
"""A teacher gives up after this many times the shortest path's length."""


class Walk(NamedTuple):
    """What a teacher did, as anyone who watches sees it."""

    goal: int
    """Number of the goal it was going to, from 1."""
    places: IntArray
    """(T + 1, 2) x, y before the first step and after each."""
    actions: IntArray
    """(T,) number of the action of each step."""

    @property
    def steps(self) -> int:
        """T."""
        return len(self.actions)


def demonstrate(body: MazeBody, goal: int, rng: np.random.Generator) -> list[Walk]:
    """Every copy of the body walks from the start to a goal; one walk per copy, each as long as it took.

    Raises:
        BodyError: a goal that does not exist, or noise so strong that the teacher does not arrive.
    """
    maze = body.maze
    distance = maze.distances(goal_place(maze, goal))
    nearer = distance[maze.lead] < distance[:, None]
    liking = rng.random((body.copies, len(ACTIONS)))
    body.reset()
    cells: list[IntArray] = [body.cell]
    actions: list[IntArray] = []
    limit = PATIENCE * max(int(distance[maze.number(maze.start)]), 5)
    arrived = np.full(body.copies, -1)
    while (arrived < 0).any():
        if len(actions) == limit:
            raise BodyError(f"the teacher did not reach goal {goal} in {limit} steps; the dynamics are too noisy")
        action = np.where(nearer[cells[-1]], liking, -1.0).argmax(1)
        body.act(action[:, None].astype(float))
        cells.append(body.cell)
        actions.append(action)
        arrived[(arrived < 0) & (distance[cells[-1]] == 0)] = len(actions)
    way, did = np.array(cells), np.array(actions)
    places = np.stack([way % maze.width + 1, way // maze.width + 1], axis=-1)
    return [Walk(goal, places[: n + 1, b].copy(), did[:n, b].copy()) for b, n in enumerate(arrived)]


def goal_place(maze: Maze, goal: int) -> Place:
    """Where goal number `goal` is.

    Raises:
        BodyError: there is none.
    """
    if not 1 <= goal <= len(maze.goals):
        raise BodyError(f"goal {goal}: this maze has goals 1 to {len(maze.goals)}")
    return maze.goals[goal - 1]


def check_walk(maze: Maze, walk: Walk, name: str = "walk") -> None:
    """Refuse what nobody can walk in this maze.

    Raises:
        BodyError: a goal or action that does not exist, a place outside, a jump, a step through a wall, or an end that
            is not the goal; the step is named.
    """
    places: list[Place] = [(int(x), int(y)) for x, y in walk.places]
    for step, (x, y) in enumerate(places):
        if not (1 <= x <= maze.width and 1 <= y <= maze.height):
            raise BodyError(f"{name}, step {step}: ({x}, {y}) lies outside the maze of {maze.width} x {maze.height}")
    moves = STEPS.tolist()
    for step, (action, here, there) in enumerate(zip(walk.actions, places, places[1:], strict=False)):
        if not 0 <= action < len(ACTIONS):
            raise BodyError(f"{name}, step {step}: action {action}; there are 0 to 4 ({', '.join(ACTIONS)})")
        move = [there[0] - here[0], there[1] - here[1]]
        if move not in moves:
            raise BodyError(f"{name}, step {step}: from {here} to {there} is no single step")
        if maze.blocked[maze.number(here), moves.index(move)]:
            raise BodyError(f"{name}, step {step}: from {here} to {there} leads through a wall")
    if places[-1] != goal_place(maze, walk.goal):
        raise BodyError(f"{name}: it ends at {places[-1]}, but goal {walk.goal} is at {goal_place(maze, walk.goal)}")
