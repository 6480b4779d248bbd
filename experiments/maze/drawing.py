"""A maze on matplotlib axes, as the chapter draws it: thick black walls, an asterisk, shaded goals, grey for time."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.shared.palette import CYCLE, DARK
from models.maze import Maze

GOAL_SHADES = ("white", "0.62", "0.25", "0.8", "0.45", "0.1", "0.7", "0.35", "0.9")
"""Goal 1 is white, goal 2 grey, goal 3 dark, as in the chapter's Figure 5 (a)."""
GOAL_COLOURS = (*CYCLE, DARK)
"""One colour per goal where lines have to be told apart."""


def wall_segments(maze: Maze) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Straight pieces of wall between cell corners, merged along their lines; cell (x, y) spans x +- 1/2, y +- 1/2."""
    north = np.vstack([maze.walls[:1, :, 2], maze.walls[:, :, 0]])  # (height + 1, width) lines y = row + 1/2
    east = np.hstack([maze.walls[:, :1, 3], maze.walls[:, :, 1]]).T  # (width + 1, height)
    level = [((a + 0.5, y + 0.5), (b + 0.5, y + 0.5)) for y, row in enumerate(north) for a, b in _runs(row)]
    upright = [((x + 0.5, a + 0.5), (x + 0.5, b + 0.5)) for x, row in enumerate(east) for a, b in _runs(row)]
    return level + upright


def draw_maze(axes: Axes, maze: Maze, goals: Sequence[int] = (), *, colour: str = "black", width: float = 2.6) -> None:
    """Walls, and the start if there are goals to draw; equal aspect, ticks in cell coordinates.

    Lines and marks are thinner in mazes larger than the chapter's.
    """
    size = min(1.0, 20 / max(maze.width, maze.height))
    walls = LineCollection(wall_segments(maze), colors=colour, linewidths=width * size, capstyle="projecting", zorder=3)
    axes.add_collection(walls)
    if goals:
        axes.plot(*maze.start, "*", color="black", markersize=4 + 7 * size, zorder=4)
    for goal in goals:
        axes.plot(
            *maze.goals[goal - 1], "o", markersize=5 + 6 * size, zorder=2.5 if size == 1 else 4,
            color=GOAL_SHADES[goal - 1], markeredgecolor="black", markeredgewidth=1.2,
        )  # fmt: skip
    axes.set(xlim=(0.2, maze.width + 0.8), ylim=(0.2, maze.height + 0.8), aspect="equal")
    axes.set(xticks=_ticks(maze.width), yticks=_ticks(maze.height))
    axes.set_xlabel("east [cells]", fontsize=8)
    axes.set_ylabel("north [cells]", fontsize=8)
    axes.tick_params(length=0, labelsize=8)
    axes.spines[:].set_visible(False)


def draw_walks(axes: Axes, walks: Sequence[IntArray], *, dashed: bool, width: float = 1.6) -> None:
    """(T + 1, 2) walks from light grey (early) to black (late), offset within the cells for clarity.

    Every walk keeps its own small offset; where it comes back to a cell it is shifted a little further each time.
    """
    for walk, offset in zip(walks, offsets(len(walks), 0.22), strict=True):
        line = _separated(walk) + offset
        pieces = np.stack([line[:-1], line[1:]], axis=1)
        moving = np.diff(walk, axis=0).any(1)
        shades = 0.82 * (1 - np.linspace(0, 1, max(len(pieces), 2))[: len(pieces)])
        axes.add_collection(
            LineCollection(
                list(pieces[moving]),
                colors=[(s, s, s) for s in shades[moving]],
                linewidths=width,
                linestyles=(0, (2.2, 1.1)) if dashed else "solid",
                capstyle="butt" if dashed else "round",
                zorder=3.5,
            )
        )


def offsets(count: int, spread: float) -> FloatArray:
    """How far each of several walks is shifted, so that none covers another."""
    return np.linspace(-spread, spread, count) if count > 1 else np.zeros(1)


def _separated(walk: IntArray) -> FloatArray:
    """Shift later visits of a cell by up to a sixth of a cell so that a returning path does not cover itself."""
    entered = np.asarray(np.diff(walk, axis=0, prepend=0).any(1))
    again = [(entered[:t] & (walk[:t] == place).all(1)).sum() + entered[t] - 1 for t, place in enumerate(walk)]
    return walk + 0.09 * (np.array(again)[:, None] % 3)


def _runs(row: BoolArray) -> list[tuple[int, int]]:
    edges = np.diff(np.concatenate([[0], row.astype(int), [0]]))
    return list(zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True))


def _ticks(size: int) -> list[int]:
    step = max(1, round(size / 20)) * 5 if size > 10 else 1
    return sorted({1, *range(step, size + 1, step)})
