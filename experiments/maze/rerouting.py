"""Going on where the world is not as shown: sub-goals out of what was felt, once touch contradicts what was watched.

The chapter's imitator goes from sub-goal to sub-goal of a demonstration. With its forward model overridden where touch
feels a wall, P(sub-goal | state, action) of a sub-goal behind that wall is 0 for every action: Eq. (1) has no evidence,
and that is how a change is noticed. From then on (at once, for a goal nobody showed) the sub-goals are those of the
cheapest way over what is believed of the maze: one step towards a side costs 1 / P(it succeeds) expected steps,

    P(it succeeds) = max_a P(outcome | a) P(open)

where P(open) of a side is what was felt there on this walk, 0 or 1; what was felt or watched before, in doubt by
c = 1 / (sides known + 2): c or 1 - c; and where nothing is known (sides known open + 1) / (sides known + 2).
"""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.maze.planners import Explorers, steps_to_go
from imitation.acting.follow import Decisions, Follower, Way, believed, follow
from models.maze import Maze, MazeBody

Walks = list[tuple[float, BoolArray]]
"""Walk by walk: mean own steps before it, and (R,) who arrived in time."""


class Rerouting(Follower):
    """`Follower` that feels on its way, walk after walk; its place and its touch are asked before every step.

    Args:
        we: what each copy has learned, felt and watched; it feels on.
        goal: cell to end in.
        successor: (B, S) sub-goals out of demonstrations; None where nobody showed this goal.
        prior: (B, S, A) P(a | s, g); left out once a copy goes its own way.
    """

    def __init__(
        self, we: Explorers, goal: int, successor: IntArray | None = None, prior: FloatArray | None = None
    ) -> None:
        copies, cells = we.closed.shape[:2]
        here = np.broadcast_to(np.arange(cells), (copies, cells)) if successor is None else successor
        super().__init__(we.model, we.places, here, goal, prior, copies=copies)
        self.we, self.successor, self.prior = we, self.successor.copy(), self.prior.copy()
        self.tables = believed(we.model)
        self.alone = np.full(copies, successor is None)
        """(B,) who goes by a plan of its own."""
        self.planned = np.zeros(copies, bool)
        self.fresh = np.zeros_like(we.closed)
        """(B, S, 4) sides felt on this walk."""

    def start(self, senses: FloatArray) -> Way:
        """See `Follower`; a new walk."""
        self.fresh[:] = False
        self._look(senses)
        return super().start(senses)

    def step(self, state: Way, senses: FloatArray, rng: np.random.Generator) -> tuple[Way, FloatArray, Decisions]:
        """See `Follower`."""
        self._look(senses)
        return super().step(state, senses, rng)

    def _look(self, senses: FloatArray) -> None:
        """Feel; who finds its sub-goal behind a wall plans, and plans anew where touch is not what was believed."""
        here = self.states.number(senses)
        before = self.we.closed[self.copy, here]
        self.we.feel(senses, self.fresh)
        closed, ahead = self.we.closed[self.copy, here], self.successor[self.copy, here]
        side = self.states.outcome(here, np.where(ahead < 0, here, ahead))
        walled = np.pad(closed, ((0, 0), (0, 1)))[self.copy, side]
        self.alone |= walled
        who = np.flatnonzero(self.alone & (~self.planned | walled | (before != closed).any(1)))
        if len(who):
            self.planned[who], self.prior[who] = True, 1.0 / self.prior.shape[-1]
            self._plan(who)

    def _plan(self, who: IntArray) -> None:
        """Sub-goals of some copies: the next cells of the cheapest ways to the goal, -1 at the goal itself."""
        likely = self.passable()[who] * self.tables.max(-2)[np.minimum(who, len(self.tables) - 1), None, :4]
        for b, chance in zip(who, likely, strict=True):
            cells, sides = np.nonzero(chance)
            graph = coo_array((1 / chance[cells, sides], (self.we.open[cells, sides], cells)), (len(chance),) * 2)
            self.successor[b] = dijkstra(graph.tocsr(), indices=int(self.goal[b]), return_predecessors=True)[1]
        self.successor[self.successor < 0] = -1

    def passable(self) -> FloatArray:
        """(B, S, 4) P(open) of every side; 0 at the rim."""
        we = self.we
        walls, gaps = ((sides & we.inside).sum((1, 2), keepdims=True) for sides in (we.closed, we.passed))
        doubt = np.where(self.fresh, 0.0, 1 / (walls + gaps + 2))
        unknown = (gaps + 1) / (walls + gaps + 2)
        return np.where(we.inside, np.where(we.passed, 1 - doubt, np.where(we.closed, doubt, unknown)), 0.0)


class Replanning(Rerouting):
    """The same beliefs without sub-goals: each action by value iteration on them, a few sweeps at every step."""

    sweeps = 5

    def __init__(self, we: Explorers, goal: int) -> None:
        super().__init__(we, goal)
        self.value = np.zeros(we.closed.shape[:2])
        self._sweep(300)

    def step(self, state: Way, senses: FloatArray, rng: np.random.Generator) -> tuple[Way, FloatArray, Decisions]:
        """See `Follower`; its decisions are not Eq. (1)'s."""
        state, _, decided = super().step(state, senses, rng)
        best = self._sweep(self.sweeps)[self.copy, state.here].argmin(-1)
        return state, best[:, None].astype(float), decided

    def _plan(self, who: IntArray) -> None:
        """No sub-goals: each cell is its own."""

    def _sweep(self, sweeps: int) -> FloatArray:
        """See `steps_to_go`."""
        passable = np.pad(self.passable().transpose(0, 2, 1), ((0, 0), (0, 1), (0, 0)))
        to_go = steps_to_go(self.we.open, self.tables, int(self.goal[0]), sweeps, self.value, passable, 0.01)
        self.value = to_go.min(-1)
        return to_go


def in_turn(follower: Follower, maze: Maze, walks: int, limit: int, seed: tuple[int, ...]) -> Walks:
    """One walk after the other from the start, each given up at the limit."""
    found, steps = [], 0.0
    for nth in range(walks):
        body = MazeBody(maze, copies=len(follower.copy), seed=(*seed, nth))
        journey = follow(body, follower, rng=np.random.default_rng([*seed, nth]), limit=limit)
        found.append((steps, journey.reached))
        steps += float(journey.steps.mean())
    return found
