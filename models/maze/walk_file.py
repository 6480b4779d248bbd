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
from models.maze.maze import ACTIONS, Maze
from models.maze.teacher import Walk, check_walk

HEADER = ("walk", "goal", "step", "x", "y", "action")
LONGEST_FILE = 1 << 24
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
    try:
        if path.stat().st_size > LONGEST_FILE:
            raise BodyError(f"{path}: {path.stat().st_size} bytes; walks take at most {LONGEST_FILE}")
        lines = path.read_bytes().decode("utf-8").splitlines()
    except OSError as error:
        raise BodyError(f"{path}: cannot be read ({error.strerror or error}); give a table of walks") from None
    except UnicodeDecodeError:
        raise BodyError(f"{path}: not a text; walks are a table {','.join(HEADER)}") from None
    rows = list(csv.reader(lines))
    if not rows or tuple(cell.strip() for cell in rows[0]) != HEADER:
        raise BodyError(f"{path}, line 1: {lines[0][:60]!r}; the first line must be {','.join(HEADER)}" if rows else
                        f"{path}: empty; the first line must be {','.join(HEADER)}")  # fmt: skip
    found: dict[str, list[tuple[int, list[str]]]] = {}
    for number, row in enumerate(rows[1:], 2):
        if not any(row):
            continue
        if len(row) != len(HEADER):
            raise BodyError(
                f"{path}, line {number}: {len(row)} fields; there must be {len(HEADER)}: {','.join(HEADER)}"
            )
        found.setdefault(row[0].strip(), []).append((number, [cell.strip() for cell in row]))
    if not found:
        raise BodyError(f"{path}: no walks in it")
    walks = []
    for name, steps in found.items():
        walk = _walk(steps, path)
        check_walk(maze, walk, f"{path}, walk {name}")
        walks.append(walk)
    return walks


def _walk(steps: list[tuple[int, list[str]]], path: Path) -> Walk:
    places, actions, goals = [], [], set()
    for i, (number, (_, goal, step, x, y, action)) in enumerate(steps):
        try:
            goals.add(int(goal))
            places.append((int(x), int(y)))
            if int(step) != i:
                raise BodyError(f"{path}, line {number}: step {step} where step {i} belongs")
        except ValueError as error:
            if isinstance(error, BodyError):
                raise
            raise BodyError(f"{path}, line {number}: goal, step, x and y must be whole numbers") from None
        last = i == len(steps) - 1
        if (action not in ACTIONS and not last) or (last and action):
            right = "no action after the last step" if last else f"one of {', '.join(ACTIONS)}"
            raise BodyError(f"{path}, line {number}: action {action!r}; there must be {right}")
        if not last:
            actions.append(ACTIONS.index(action))
    if len(goals) != 1:
        raise BodyError(f"{path}, line {steps[0][0]}: a walk with goals {sorted(goals)}; it has one")
    if max(max(place) for place in places) > 1 << 20 or min(min(place) for place in places) < 0:
        raise BodyError(f"{path}, line {steps[0][0]}: a walk beyond any maze")
    return Walk(goals.pop(), np.array(places, np.int64), np.array(actions, np.int64))
