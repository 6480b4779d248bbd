"""Walks as a table that people can read and write: comma-separated, one line per step.

walk,goal,step,x,y,action
1,2,0,1,1,N
1,2,1,1,2,E
1,2,2,2,2,        <- the last line of a walk has no action
"""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from models.errors import BodyError
from models.files import text
from models.maze.maze import ACTIONS, Maze
from models.maze.teacher import Walk, check_walk
from models.tables import table

HEADER = ("walk", "goal", "step", "x", "y", "action")
LONGEST_FILE = 1 << 22
"""Bytes; hundreds of thousands of steps."""


def write_walks(walks: Sequence[Walk], path: Path) -> None:
    """Write walks, numbered from 1."""
    with path.open("w", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(HEADER)
        for number, walk in enumerate(walks, 1):
            did = [ACTIONS[a] for a in walk.actions] + [""]
            for step, ((x, y), action) in enumerate(zip(walk.places, did, strict=True)):
                table.writerow([number, walk.goal, step, int(x), int(y), action])


def read_walks(path: Path, maze: Maze) -> list[Walk]:
    """Walks from a table, each checked against the maze.

    Raises:
        BodyError: no such file, not such a table (line named), or a walk that nobody can walk (step named).
    """
    rows = table(text(path, LONGEST_FILE), path)
    if not len(rows.cells) or tuple(rows.cells[0]) != HEADER:
        raise BodyError(f"{path}: the first line must be {','.join(HEADER)}")
    found: dict[str, list[tuple[str, list[str]]]] = {}
    for row, (name, *cells) in enumerate(rows.cells[1:].tolist(), start=1):
        found.setdefault(name, []).append((rows.where(row), cells))
    if not found:
        raise BodyError(f"{path}: no walks in it")
    walks = {name: _walk(steps) for name, steps in found.items()}
    for name, walk in walks.items():
        check_walk(maze, walk, f"{path}, walk {name}")
    return list(walks.values())


def _walk(steps: list[tuple[str, list[str]]]) -> Walk:
    numbers, actions = [], []
    for i, (where, (*whole, action)) in enumerate(steps):
        if not all(cell.isascii() and cell.isdecimal() and len(cell) < 8 for cell in whole):
            raise BodyError(f"{where}: goal, step, x and y must be whole numbers, 0 to 9999999")
        numbers.append([int(cell) for cell in whole])
        if numbers[i][1] != i:
            raise BodyError(f"{where}: step {numbers[i][1]} where step {i} belongs")
        last = i == len(steps) - 1
        if action not in ([""] if last else ACTIONS):
            right = "no action after the last step" if last else f"one of {', '.join(ACTIONS)}"
            raise BodyError(f"{where}: action {action!r}; there must be {right}")
        actions.append(action)
    table_of = np.array(numbers)
    goals = np.unique(table_of[:, 0]).tolist()
    if len(goals) != 1:
        raise BodyError(f"{steps[0][0]}: a walk with goals {goals}; it has one")
    return Walk(goals[0], table_of[:, 2:], np.array([ACTIONS.index(action) for action in actions[:-1]], np.int64))
