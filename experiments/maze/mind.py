"""What every part of the maze experiment does: wander, watch, imitate, infer; wiring, no inference of its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.forward_model import ForwardModel
from babbling.loop import babble
from babbling.moves import Places, overridden
from babbling.states import Wanderer
from imitation.acting.follow import Follower, Journey, follow
from imitation.acting.subgoals import acyclic_subgoals
from imitation.episodes import Episode
from imitation.inference.intent import Intent, intent_by_step, intent_filter, step_evidence
from imitation.inference.priors import ActionPriors
from models.maze import ACTIONS, Maze, MazeBody, Walk, demonstrate

WANDERING, TEACHING, UNSEEN, IMITATING = range(1, 5)
"""Purposes of randomness: each has its own stream, so that none disturbs another."""

CHECKPOINTS = (100, 300, 1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000)
LONGEST_OUTING = 20_000
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

    def limit(self, goal: int) -> int:
        """Steps after which an imitation is given up."""
        return int(PATIENCE * max(5.0, float(np.mean([e.steps for e in self.towards(goal)]))))


def teach(maze: Maze, demonstrations: int, seed: int, purpose: int = TEACHING) -> list[Walk]:
    """So many walks to every goal."""
    body = MazeBody(maze, copies=demonstrations, seed=[seed, purpose])
    rng = np.random.default_rng([seed, purpose])
    return [walk for goal in range(1, len(maze.goals) + 1) for walk in demonstrate(body, goal, rng)]


def places_of(maze: Maze) -> Places:
    """What its cells are to somebody who walks there."""
    return Places((1, 1), (maze.width, maze.height))


def watched(walk: Walk, maze: Maze) -> Episode:
    """A walk as the watching imitator keeps it: the identity correspondence of section 3.2."""
    return Episode(walk.goal - 1, places_of(maze).number(walk.places), walk.actions)


def walked(episode: Episode, maze: Maze) -> Walk:
    """Inverse of `watched`, for drawing and for checking against the maze."""
    return Walk(episode.goal + 1, places_of(maze).place(episode.states), episode.actions)


def wanderer(body: MazeBody, *, alone: bool = False) -> Wanderer:
    """Who finds out what the five acts do; with `alone`, every copy for itself."""
    return Wanderer(body, Places.of(body), ACTIONS, alone=alone)


def outings(steps: int) -> tuple[int, ...]:
    """Steps of each outing from the start: they end at the checkpoints of the learning curve."""
    ends = sorted({c for c in CHECKPOINTS if c < steps} | set(range(LONGEST_OUTING, steps, LONGEST_OUTING)) | {steps})
    return tuple(np.diff([0, *ends]).tolist()) if steps else ()


def follower(
    maze: Maze,
    forward_model: ForwardModel,
    watched: Sequence[Sequence[Episode]],
    priors: Sequence[ActionPriors] | None,
    goal: int,
    selection: str,
) -> Follower:
    """Towards goal 1, 2, ..., each copy by what it watched itself: the acyclic rule and, if given, its priors."""
    own = [[episode for episode in mine if episode.goal == goal - 1] for mine in watched]
    successor = np.array([acyclic_subgoals(mine, maze.cells).successor for mine in own])
    prior = None if priors is None else np.array([mine.action()[goal - 1] for mine in priors])
    end = maze.number(maze.goals[goal - 1])
    return Follower(forward_model, places_of(maze), successor, end, prior, copies=len(own), selection=selection)


def imitate(experience: Experience, goal: int, selection: str, seed: int) -> Journey:
    """One imitation of what was watched for this goal."""
    maze, model = experience.maze, experience.forward_model
    one = follower(maze, model, [experience.episodes], [experience.priors], goal, selection)
    body, rng = MazeBody(maze, seed=[seed, IMITATING]), np.random.default_rng([seed, IMITATING])
    return follow(body, one, rng=rng, limit=experience.limit(goal))


class Imitators:
    """Many imitators at once, one per copy of the body: each has wandered and watched for itself."""

    def __init__(self, maze: Maze, copies: int, demonstrations: int, wander_steps: int, seed: int) -> None:
        self.maze, self.copies, self.seed = maze, copies, seed
        self.body = MazeBody(maze, copies=copies, seed=(seed, 21))
        self.episodes: list[list[Episode]] = [[] for _ in range(copies)]
        for goal in range(1, len(maze.goals) + 1):
            for k in range(demonstrations):
                walks = demonstrate(self.body, goal, np.random.default_rng([seed, 22, goal, k]))
                for own, walk in zip(self.episodes, walks, strict=True):
                    own.append(watched(walk, maze))
        self.priors = [ActionPriors.learned(e, len(maze.goals), maze.cells, len(ACTIONS)) for e in self.episodes]
        self.forward_model = babble(self.body, wanderer(self.body, alone=True), outings(wander_steps), seed)

    def teacher_steps(self, goal: int) -> float:
        """Mean steps of what was watched."""
        return float(np.mean([e.steps for own in self.episodes for e in own if e.goal == goal - 1]))

    def journeys(self, goal: int, selection: str, limit: int, *, prior: bool = True) -> Journey:
        """All imitate one goal."""
        priors = self.priors if prior else None
        everyone = follower(self.maze, self.forward_model, self.episodes, priors, goal, selection)
        return follow(self.body, everyone, rng=np.random.default_rng([self.seed, 23, goal]), limit=limit)


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
    states = episode.states
    moved = places_of(maze).outcome(states[:-1], states[1:])
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
