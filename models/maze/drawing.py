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

from models.errors import BodyError
from models.maze.maze import BoolArray, Maze, Place

LARGEST = 200
"""Cells along a side."""
LONGEST_FILE = 1 << 19
"""Bytes of a drawing; 200 x 200 cells with comments need half of it."""

_PITCH = 3  # characters from one corner to the next
_KNOWN = set("+-| *#123456789")


def default_maze() -> Maze:
    """The maze of the chapter's Figure 5 (a), redrawn (see README.md)."""
    return parse_maze((files("models.maze") / "default.txt").read_text(), "default.txt")


def read_maze(path: Path) -> Maze:
    """A maze from a drawing in a file.

    Raises:
        BodyError: no such file, not a text, too large, or a drawing that is no maze (line and column named).
    """
    try:
        if path.stat().st_size > LONGEST_FILE:
            raise BodyError(
                f"{path}: {path.stat().st_size} bytes; a drawing of the largest maze ({LARGEST} x {LARGEST} cells) "
                f"needs fewer than {LONGEST_FILE}"
            )
        text = path.read_bytes().decode("utf-8")
    except OSError as error:
        raise BodyError(f"{path}: cannot be read ({error.strerror or error}); give a drawing of a maze") from None
    except UnicodeDecodeError:
        raise BodyError(f"{path}: not a text; a maze is drawn with '+', '-', '|', spaces, '*' and digits") from None
    return parse_maze(text, str(path))


def parse_maze(text: str, name: str = "maze") -> Maze:
    """A maze from its drawing.

    Raises:
        BodyError: see `read_maze`.
    """
    lines = [(i, line.rstrip("\r")) for i, line in enumerate(text.split("\n"), 1) if not line.startswith("#")]
    while lines and not lines[-1][1].strip():
        lines.pop()
    while lines and not lines[0][1].strip():
        lines.pop(0)
    _check_shape(lines, name)
    rows, columns = (len(lines) - 1) // 2, (len(lines[0][1]) - 1) // _PITCH
    walls = np.zeros((rows, columns, 4), bool)
    marks: dict[str, Place] = {}
    for k, (number, line) in enumerate(lines):
        if k % 2 == 0:
            _read_walls(line, f"{name}, line {number}", walls, k, rows)
        else:
            _read_cells(line, f"{name}, line {number}", walls, rows - k // 2, marks)
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
        for column, character in enumerate(line, 1):
            if character not in _KNOWN:
                raise BodyError(
                    f"{name}, line {number}, column {column}: {character!r} means nothing in a maze; "
                    "there are '+', '-', '|', spaces, '*' for the start and 1 to 9 for goals"
                )
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
    rows, columns = (len(lines) - 1) // 2, (len(top) - 1) // _PITCH
    if max(rows, columns) > LARGEST:
        raise BodyError(f"{name}: {columns} x {rows} cells; the largest maze is {LARGEST} x {LARGEST}")


def _read_walls(line: str, where: str, walls: BoolArray, k: int, rows: int) -> None:
    """A line of walls between row `above` of cells and the one below it."""
    below = rows - k // 2 - 1  # index of the row under this line
    for x in range(walls.shape[1]):
        column = _PITCH * x + 1
        segment = line[column : column + 2]
        if line[_PITCH * x] not in "+-| " or line[-1] not in "+-|":
            at = _PITCH * x if line[_PITCH * x] not in "+-| " else len(line) - 1
            raise BodyError(f"{where}, column {at + 1}: {line[at]!r} where a corner '+' belongs")
        if segment not in ("--", "  "):
            raise BodyError(
                f"{where}, column {column + 1}: {segment!r} is neither a wall '--' nor an opening of two spaces"
            )
        if segment == "  " and below in (-1, rows - 1):
            raise BodyError(f"{where}, column {column + 1}: the outer wall is open; close it with '--'")
        if segment == "--":
            if below >= 0:
                walls[below, x, 0] = True
            if below + 1 < rows:
                walls[below + 1, x, 2] = True


def _read_cells(line: str, where: str, walls: BoolArray, y: int, marks: dict[str, Place]) -> None:
    columns = walls.shape[1]
    for x in range(columns + 1):
        wall = line[_PITCH * x]
        if wall not in "| ":
            raise BodyError(f"{where}, column {_PITCH * x + 1}: {wall!r} is neither a wall '|' nor an opening ' '")
        if wall == " " and x in (0, columns):
            raise BodyError(f"{where}, column {_PITCH * x + 1}: the outer wall is open; close it with '|'")
        if wall == "|":
            if x > 0:
                walls[y - 1, x - 1, 1] = True
            if x < columns:
                walls[y - 1, x, 3] = True
        if x == columns:
            return
        cell = line[_PITCH * x + 1 : _PITCH * x + 3]
        for offset, mark in enumerate(cell):
            column = _PITCH * x + 2 + offset
            if mark == " ":
                continue
            if mark in "+-|#":
                raise BodyError(f"{where}, column {column}: {mark!r} inside a cell; cells hold a space, '*' or a goal")
            if len(cell.strip()) > 1:
                raise BodyError(f"{where}, column {column}: two marks {cell!r} in one cell; a cell holds one")
            if mark in marks:
                raise BodyError(f"{where}, column {column}: a second {mark!r}; the first is at {marks[mark]}")
            marks[mark] = (x + 1, y)
