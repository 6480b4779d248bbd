"""A maze: cells, walls between them, a start and goals (chapter, section 3.3.1 and Figure 5)."""

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from models.arrays import BoolArray, IntArray
from models.errors import BodyError

Place = tuple[int, int]
"""(x, y), each from 1; (1, 1) is the cell at the lower left."""

ACTIONS = ("N", "E", "S", "W", "X")
"""North, east, south, west, stay: the order of every action and outcome axis."""

STEPS: IntArray = np.array([[0, 1], [1, 0], [0, -1], [-1, 0], [0, 0]])
"""(5, 2) what each action means to do to (x, y)."""
STEPS.flags.writeable = False


@dataclass(frozen=True, eq=False)
class Maze:
    """A rectangle of cells with walls as lines between them.

    Raises:
        BodyError: a goal that no path reaches, or that is the start.
    """

    walls: BoolArray
    """(height, width, 4) whether a wall stands on the N, E, S, W side of cell (x, y) = [y - 1, x - 1]."""
    start: Place
    goals: tuple[Place, ...]
    """Goal k is `goals[k - 1]`."""

    def __post_init__(self) -> None:
        walls = np.array(self.walls, bool)
        walls.flags.writeable = False
        object.__setattr__(self, "walls", walls)
        for number, goal in enumerate(self.goals, 1):
            if goal == self.start:
                raise BodyError(f"goal {number} stands on the start {goal}; put it elsewhere")
            if self.distances(goal)[self.number(self.start)] < 0:
                raise BodyError(
                    f"no path leads from the start {self.start} to goal {number} at {goal}; open a wall between them"
                )

    @property
    def height(self) -> int:
        """Rows of cells."""
        return int(self.walls.shape[0])

    @property
    def width(self) -> int:
        """Columns of cells."""
        return int(self.walls.shape[1])

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return self.height * self.width

    def number(self, place: Place) -> int:
        """Cell number of a place: 0 at (1, 1), then eastward, row by row."""
        return (place[1] - 1) * self.width + place[0] - 1

    def place(self, number: int) -> Place:
        """Inverse of `number`."""
        return int(number) % self.width + 1, int(number) // self.width + 1

    @cached_property
    def blocked(self) -> BoolArray:
        """(cells, 5) whether a wall stops this action in this cell; staying is never stopped."""
        blocked = np.zeros((self.cells, 5), bool)
        blocked[:, :4] = self.walls.reshape(-1, 4)
        blocked.flags.writeable = False
        return blocked

    @cached_property
    def lead(self) -> IntArray:
        """(cells, 5) the cell that each outcome N, E, S, W, X leads to: a move into a wall stays."""
        cells = np.arange(self.cells)
        offsets = STEPS[:, 1] * self.width + STEPS[:, 0]
        lead = np.where(self.blocked, cells[:, None], cells[:, None] + offsets)
        lead.flags.writeable = False
        return lead

    def distances(self, goal: Place) -> IntArray:
        """(cells,) least number of moves to a place; -1 where no path leads."""
        ways = np.repeat(np.arange(self.cells), 4), self.lead[:, :4].ravel()
        graph = coo_array((np.ones(len(ways[0])), ways), (self.cells, self.cells))
        distance = dijkstra(graph, indices=self.number(goal), unweighted=True)
        return np.where(np.isinf(distance), -1, distance).astype(np.int64)

    @cached_property
    def fingerprint(self) -> str:
        """Differs between mazes that differ in anything."""
        told = repr((self.walls.shape, self.start, self.goals)).encode()
        return hashlib.sha256(told + np.packbits(self.walls).tobytes()).hexdigest()[:16]
