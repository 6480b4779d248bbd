"""Mazes as plain text that people draw and edit.

A cell is two characters wide between its walls, a line of cells stands between two lines of walls:

    +--+--+
    |    1|      '+' a corner, '--' and '|' walls, spaces openings,
    +  +--+      '*' the start, '1' to '9' the goals, '#' begins a line of comment.
    | *   |
    +--+--+
"""

from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.arrays import BoolArray
from models.errors import BodyError
from models.files import text
from models.maze.maze import Maze, Place

LARGEST = 200
"""Cells along a side."""
LONGEST_FILE = 1 << 20
"""Bytes of a drawing; 200 x 200 cells with comments need a quarter of it."""

_PITCH = 3  # characters from one corner to the next
_CORNER, _LEVEL, _UPRIGHT, _CELL = range(4)
_BELONGS = {
    _CORNER: ("+-| ", "a corner '+'"),
    _LEVEL: ("- ", "a wall '--' or an opening of two spaces"),
    _UPRIGHT: ("| ", "a wall '|' or an opening ' '"),
    _CELL: (" *123456789", "a space, '*' for the start or 1 to 9 for a goal"),
}


def default_maze() -> Maze:
    """The maze of the chapter's Figure 5 (a), redrawn (see README.md)."""
    return parse_maze((files("models.maze") / "default.txt").read_text(), "default.txt")


def read_maze(path: Path) -> Maze:
    """A maze from a drawing in a file.

    Raises:
        BodyError: no such file, not a text, too large, or a drawing that is no maze (line and column named).
    """
    return parse_maze(text(path, LONGEST_FILE), str(path))


def parse_maze(drawing: str, name: str = "maze") -> Maze:
    """A maze from its drawing.

    Raises:
        BodyError: see `read_maze`.
    """
    lines = [(i, line.rstrip("\r")) for i, line in enumerate(drawing.split("\n"), 1) if not line.startswith("#")]
    drawn = [place for place, (_, line) in enumerate(lines) if line.strip()]
    lines = lines[drawn[0] : drawn[-1] + 1] if drawn else []
    _check_shape(lines, name)
    signs = np.array([list(line) for _, line in lines])
    _check_signs(signs, [f"{name}, line {number}" for number, _ in lines])
    level, upright = (signs[::2, 1::_PITCH] == "-")[::-1], (signs[1::2, ::_PITCH] == "|")[::-1]  # from below
    walls = np.stack([level[1:], upright[:, 1:], level[:-1], upright[:, :-1]], axis=-1)
    marks: dict[str, Place] = {}
    for row, column in np.argwhere(np.char.isalnum(signs) | (signs == "*")):
        mark, place = str(signs[row, column]), (int(column) // _PITCH + 1, len(walls) - int(row) // 2)
        if mark in marks:
            where = f"{name}, line {lines[row][0]}, column {column + 1}"
            raise BodyError(f"{where}: a second {mark!r}; the first is at {marks[mark]}")
        marks[mark] = place
    digits = sorted(mark for mark in marks if mark != "*")
    if "*" not in marks:
        raise BodyError(f"{name}: no start; mark one cell with '*'")
    if not digits or digits != [str(i + 1) for i in range(len(digits))]:
        raise BodyError(f"{name}: goals {', '.join(digits) or 'are missing'}; number them 1, 2, 3, ... without gaps")
    try:
        return Maze(walls, marks["*"], tuple(marks[d] for d in digits))
    except BodyError as error:
        raise BodyError(f"{name}: {error}") from None


def draw(maze: Maze) -> str:
    """The drawing of a maze: `parse_maze(draw(maze))` is the same maze."""
    marks = {maze.start: "*"} | {goal: str(k) for k, goal in enumerate(maze.goals, 1)}
    lines = ["+" + "--+" * maze.width]
    for y in range(maze.height, 0, -1):
        walls = maze.walls[y - 1]
        cells = (f" {marks.get((x, y), ' ')}{'|' if walls[x - 1, 1] else ' '}" for x in range(1, maze.width + 1))
        lines.append("|" + "".join(cells))
        lines.append("+" + "".join(("--" if south else "  ") + "+" for south in walls[:, 2]))
    return "\n".join(lines) + "\n"


def _check_shape(lines: list[tuple[int, str]], name: str) -> None:
    if len(lines) < 3:
        raise BodyError(f"{name}: {len(lines)} lines drawn; the least maze has 3: walls, cells, walls")
    first, top = lines[0]
    for number, line in lines:
        if len(line) != len(top):
            raise BodyError(
                f"{name}, line {number}: {len(line)} characters, line {first} has {len(top)}; "
                "every line must be as long as the first"
            )
    if len(top) % _PITCH != 1 or len(top) < _PITCH + 1:
        raise BodyError(
            f"{name}, line {first}: {len(top)} characters; a row of n cells takes 3 n + 1 "
            "(two for each cell, one for each wall beside it)"
        )
    if len(lines) % 2 == 0:
        raise BodyError(f"{name}: {len(lines)} lines; n rows of cells take 2 n + 1 (the last line must be a wall)")
    rows, columns = len(lines) // 2, len(top) // _PITCH
    if max(rows, columns) > LARGEST:
        raise BodyError(f"{name}: {columns} x {rows} cells; the largest maze is {LARGEST} x {LARGEST}")


def _check_signs(signs: NDArray[np.str_], lines: list[str]) -> None:
    """Refuse characters (rows, columns) that do not belong where they stand; `lines` names their lines in errors."""

    def refuse(bad: BoolArray, told: str) -> None:
        for row, column in np.argwhere(bad)[:1]:
            raise BodyError(f"{lines[row]}, column {column + 1}: {told.format(str(signs[row, column]))}")

    kinds = np.array([[_CORNER, _LEVEL, _LEVEL], [_UPRIGHT, _CELL, _CELL]])
    kind = np.tile(kinds, (len(signs) // 2 + 1, signs.shape[1] // _PITCH + 1))[: len(signs), : signs.shape[1]]
    for number, (known, what) in _BELONGS.items():
        refuse((kind == number) & ~np.isin(signs, list(known)), f"{{!r}} where {what} belongs")
    before = np.roll(signs, 1, axis=1)
    second = np.arange(signs.shape[1]) % _PITCH == 2
    refuse(second & (kind == _LEVEL) & (signs != before), "half a wall; a wall is '--', an opening two spaces")
    outside = np.pad(np.zeros(np.subtract(signs.shape, 2), bool), 1, constant_values=True)
    refuse(outside & (kind != _CORNER) & (signs == " "), "the outer wall is open; close it with '--' or '|'")
    refuse(second & (kind == _CELL) & (signs != " ") & (before != " "), "a second mark in one cell; a cell holds one")
