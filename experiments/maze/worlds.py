"""Mazes that change after the demonstrations: a wall that moved, a goal that nobody showed."""

import numpy as np

from models.maze import Maze

Side = tuple[int, int]
"""A cell and its side, 0 north or 1 east, that is not the rim."""


def moved_wall(maze: Maze, goal: int, rng: np.random.Generator) -> Maze | None:
    """A passage on the way to goal 1, 2, ... is walled up, and another opened: the maze with this goal alone.

    The passage is drawn from those of a shortest way without which the goal is out of reach, the wall to open from all
    those between what the start and what the goal can reach then. Where there is none such, a passage that lengthens
    the way is walled up and none opened; None where there is none of these either.
    """
    end = maze.goals[goal - 1]
    distance, here, way = maze.distances(end), maze.number(maze.start), list[Side]()
    while distance[here] > 0:
        there = maze.lead[here, distance[maze.lead[here]].argmin()]
        way.append((min(here, there), int(abs(there - here) == 1)))
        here = int(there)
    longer = None
    for door in rng.permutation(way).tolist():
        shut = _flipped(maze, *door)
        begun, ended = shut.distances(maze.start), shut.distances(end)
        if begun[maze.number(end)] > distance[maze.number(maze.start)]:
            longer = Maze(shut.walls, maze.start, (end,))
        walls = [
            (cell, side)
            for cell, side in np.argwhere(shut.blocked[:, :2]).tolist()
            if [cell, side] != door and maze.place(cell)[1 - side] < (maze.height, maze.width)[side]
            and {begun[cell] >= 0, begun[cell + (maze.width, 1)[side]] >= 0} == {True, False}
            and {ended[cell] >= 0, ended[cell + (maze.width, 1)[side]] >= 0} == {True, False}
        ]  # fmt: skip
        if walls:
            return Maze(_flipped(shut, *walls[rng.integers(len(walls))]).walls, maze.start, (end,))
    return longer


def new_goal(maze: Maze, rng: np.random.Generator) -> Maze:
    """The maze with one goal that nobody showed, at least half as far from the start as the nearest one shown."""
    away, shown = maze.distances(maze.start), [maze.number(goal) for goal in maze.goals]
    far = np.flatnonzero(2 * away >= away[shown].min())
    left = np.setdiff1d(far, shown)
    return Maze(maze.walls, maze.start, (maze.place(rng.choice(left if len(left) else far)),))


def _flipped(maze: Maze, cell: int, side: int) -> Maze:
    """With a wall where was none or none where one was, and no goals."""
    walls = maze.walls.copy()
    walls.reshape(-1, 4)[[cell, cell + (maze.width, 1)[side]], [side, side + 2]] ^= True
    return Maze(walls, maze.start, ())
