"""The maze as a body: five acts, a sense of place, and touch on four sides."""

import hashlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import BoolArray, FloatArray, IntArray
from models.errors import BodyError
from models.maze.maze import ACTIONS, Maze
from models.senses import Channel, Senses

TRUE_DYNAMICS: FloatArray = np.array(
    [
        # N    E    S    W    X   where the walker ends up, having meant to go
        [0.72, 0.08, 0.04, 0.06, 0.10],  # north
        [0.05, 0.76, 0.06, 0.05, 0.08],  # east
        [0.05, 0.07, 0.70, 0.10, 0.08],  # south
        [0.09, 0.06, 0.05, 0.74, 0.06],  # west
        [0.05, 0.06, 0.05, 0.04, 0.80],  # stay
    ]
)
"""P(outcome | action) away from walls, [action, outcome] in the order of `ACTIONS`. The chapter prints its matrix as a
picture without numbers and calls it arbitrary; this one is arbitrary too (see README.md)."""
TRUE_DYNAMICS.flags.writeable = False


class MazeBody:
    """`copies` walkers in one maze, each where its own steps took it; see `babbling.body.Body`.

    Law: outcome ~ P(. | action), drawn afresh each tick; the walker moves that way unless a wall is there: "the
    constraints given by the walls are enforced by the environment" (chapter, section 3.3.1).
    Motor: the number of an action, 0 to 4. Senses: x, y, and 1 for each of the sides N, E, S, W where a wall is felt.

    Args:
        maze: where.
        copies: how many walkers.
        seed: randomness of the outcomes.
        dynamics: (5, 5) `[action, outcome]`, rows sum to 1; None is `TRUE_DYNAMICS`.
    """

    def __init__(
        self, maze: Maze, *, copies: int = 1, seed: int | Sequence[int] = 0, dynamics: ArrayLike | None = None
    ) -> None:
        self.maze, self.copies = maze, copies
        self.dynamics: FloatArray = np.array(TRUE_DYNAMICS if dynamics is None else dynamics, float)
        size = len(ACTIONS)
        self._rng = np.random.default_rng([*np.atleast_1d(seed).tolist(), 0x3A2E])
        self.motor_low, self.motor_high = np.zeros(1), np.full(1, size - 1.0)
        self.tick_s = 1.0  # one step is called one second
        self.senses = Senses(
            (
                Channel("place", "place", "cells", ("x", "y"), 1.0, (maze.width, maze.height)),
                Channel("touch", "touch", "1", ACTIONS[:4], 0.0, 1.0, suffix="touch"),
            )
        )
        self.sense_low, self.sense_high = self.senses.low, self.senses.high
        self._thresholds = np.cumsum(self.dynamics, axis=1)[:, :-1]
        self._cell: IntArray = np.full(copies, maze.number(maze.start))

    @property
    def fingerprint(self) -> str:
        """Differs between mazes and between dynamics."""
        return f"maze-{self.maze.fingerprint}-{hashlib.sha256(self.dynamics.tobytes()).hexdigest()[:6]}"

    @property
    def cell(self) -> IntArray:
        """(B,) number of the cell where each walker stands: for those outside who watch it."""
        return self._cell.copy()

    def reset(self) -> FloatArray:
        """All walkers to the start; returns their (B, 6) sensations."""
        self._cell = np.full(self.copies, self.maze.number(self.maze.start))
        return self.feel()

    def put_back(self, who: BoolArray) -> None:
        """Those outside lift (B,) some walkers back to the start (a new trial for learners by trial and error)."""
        self._cell = np.where(who, self.maze.number(self.maze.start), self._cell)

    def act(self, motors: FloatArray) -> FloatArray:
        """(B, 1) action numbers; returns the (B, 6) sensations after one step.

        Raises:
            BodyError: an action that does not exist.
        """
        wrong = ~np.isin(motors[:, 0], range(len(ACTIONS)))
        if wrong.any():
            told = f"the walker knows 0 to {len(ACTIONS) - 1} ({', '.join(ACTIONS)})"
            raise BodyError(f"action {motors[wrong].flat[0]:g}: {told}")
        self.move(motors[:, 0].astype(int))
        return self.feel()

    def move(self, action: IntArray) -> IntArray:
        """What `act` does, for (B,) whole action numbers; returns the (B,) cells, for those outside who watch."""
        outcome = (self._rng.random((self.copies, 1)) >= self._thresholds[action]).sum(1)
        self._cell = self.maze.lead[self._cell, outcome]
        return self._cell

    def feel(self) -> FloatArray:
        """(B, 6) sensations now."""
        place = np.stack([self._cell % self.maze.width, self._cell // self.maze.width], axis=-1) + 1.0
        return self.senses.vector({"place": place, "touch": self.maze.blocked[self._cell, :4]})
