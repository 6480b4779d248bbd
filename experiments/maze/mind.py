"""What every part of the maze experiment does: wander, watch, imitate, infer; wiring, no inference of its own."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.forward_model import ForwardModel
from babbling.moves import Places, overridden, relative_move
from imitation.acting.follow import Journey, believed_likelihood, follow
from imitation.acting.subgoals import SubGoals, acyclic_subgoals
from imitation.episodes import Episode
from imitation.inference.intent import Intent, intent_by_step, intent_filter, step_evidence
from imitation.inference.priors import ActionPriors
from models.maze import ACTIONS, Maze, MazeBody, Walk, demonstrate

WANDERING, TEACHING, UNSEEN, IMITATING = range(1, 5)
"""Purposes of randomness: each has its own stream, so that none disturbs another."""

PATIENCE = 20
"""An imitation is given up after this many times its demonstrations' length."""


@dataclass(frozen=True, eq=False)
class Experience:
    """All that an imitator has when it sets out."""

    maze: Maze
    forward_model: ForwardModel
    episodes: tuple[Episode, ...]

    @property
    def priors(self) -> ActionPriors:
        """Learned by counting what was watched."""
        return ActionPriors.learned(self.episodes, len(self.maze.goals), self.maze.cells, len(ACTIONS))

    def towards(self, goal: int) -> tuple[Episode, ...]:
        """Demonstrations of goal 1, 2, ..."""
        return tuple(e for e in self.episodes if e.goal == goal - 1)

    def subgoals(self, goal: int) -> SubGoals:
        """The acyclic rule on the demonstrations of goal 1, 2, ..."""
        return acyclic_subgoals(self.towards(goal), self.maze.cells)

    def limit(self, goal: int) -> int:
        """Steps after which an imitation is given up."""
        return int(PATIENCE * max(5.0, float(np.mean([e.steps for e in self.towards(goal)]))))


def teach(maze: Maze, demonstrations: int, seed: int, purpose: int = TEACHING) -> list[Walk]:
    """So many walks to every goal."""
    body = MazeBody(maze, copies=demonstrations, seed=[seed, purpose])
    rng = np.random.default_rng([seed, purpose])
    return [walk for goal in range(1, len(maze.goals) + 1) for walk in demonstrate(body, goal, rng)]


def watched(walk: Walk, maze: Maze) -> Episode:
    """A walk as the watching imitator keeps it: the identity correspondence of section 3.2."""
    return Episode(walk.goal - 1, Places((1, 1), (maze.width, maze.height)).number(walk.places), walk.actions)


def walked(episode: Episode, maze: Maze) -> Walk:
    """Inverse of `watched`, for drawing and for checking against the maze."""
    return Walk(episode.goal + 1, Places((1, 1), (maze.width, maze.height)).place(episode.states), episode.actions)


def imitate(experience: Experience, goal: int, selection: str, seed: int) -> Journey:
    """One imitation of what was watched for this goal."""
    maze = experience.maze
    return follow(
        MazeBody(maze, seed=[seed, IMITATING]),
        experience.forward_model,
        experience.subgoals(goal).successor,
        maze.number(maze.goals[goal - 1]),
        experience.priors.action()[goal - 1],
        selection=selection,
        rng=np.random.default_rng([seed, IMITATING]),
        limit=experience.limit(goal),
    )


def believed_tables(forward_model: ForwardModel) -> FloatArray:
    """(F, A, O) what imitators believe of their actions: learned rows, uniform where an action was never counted."""
    outcomes = np.arange(forward_model.outcome.size)[:, None]
    every = believed_likelihood(forward_model, np.broadcast_to(outcomes, (len(outcomes), len(forward_model.factors))))
    return np.moveaxis(every, 0, -1)


class Inferred(NamedTuple):
    """What an observer believes of a walk, by the chapter's rule and by the filter."""

    by_step: Intent
    """Eq. (2) at each step by itself, P(s | g) included."""
    filtered: Intent
    """The Bayes filter; priors in doubt whether a state tells goals apart."""
    filtered_plain: Intent
    """The Bayes filter on the same priors as `by_step`."""


def step_likelihood(maze: Maze, table: FloatArray, episode: Episode) -> FloatArray:
    """(T, A) P(s_{t+1} | s_t, a) of each step of a walk, by a (A, O) forward model, where walls are felt as one's own
    touch would tell."""
    states, places = episode.states, Places((1, 1), (maze.width, maze.height))
    moved = relative_move(places.place(states[:-1]), places.place(states[1:]))
    return np.asarray(overridden(table, maze.blocked[states[:-1], :4])[np.arange(len(moved)), :, moved])


def infer(
    priors: ActionPriors,
    episode: Episode,
    goal_prior: FloatArray,
    smoothing: float,
    likelihood: FloatArray | None = None,
) -> Inferred:
    """Whose goal is this? Judged from states and actions alone; the episode's own goal is not looked at.

    With the `likelihood` of its steps (`step_likelihood`) the episode's actions are not looked at either.
    """
    states: IntArray = episode.states[:-1]
    actions = episode.actions if likelihood is None else None
    plain = step_evidence(priors.action(smoothing), states, actions, likelihood)
    here = priors.state(smoothing)[:, states].T
    doubtful = step_evidence(priors.doubtful(smoothing), states, actions, likelihood) if smoothing > 0 else plain
    return Inferred(
        intent_by_step(plain, goal_prior, here),
        intent_filter(doubtful, goal_prior),
        intent_filter(plain, goal_prior),
    )


def junctions(maze: Maze) -> list[int]:
    """Cells on the shortest ways to two goals where these ways part: no action is right for both."""
    start = maze.number(maze.start)
    from_start = maze.distances(maze.start)
    found = set()
    to = [maze.distances(goal) for goal in maze.goals]
    for i, one in enumerate(to):
        for two in to[:i]:
            shared = (from_start >= 0) & (one > 0) & (two > 0)
            shared &= (from_start + one == one[start]) & (from_start + two == two[start])
            right = [d[maze.lead] < d[:, None] for d in (one, two)]
            found |= set(np.flatnonzero(shared & ~(right[0] & right[1]).any(1)).tolist())
    return sorted(found)
