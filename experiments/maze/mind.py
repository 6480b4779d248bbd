"""What every part of the maze experiment does: wander, watch, imitate, infer; wiring, no inference of its own."""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
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
    """All that imitators have when they set out, one per copy of a body: each has watched for itself."""

    body: MazeBody
    forward_model: ForwardModel
    """One factor per copy where each has wandered for itself."""
    episodes: tuple[tuple[Episode, ...], ...]

    @property
    def maze(self) -> Maze:
        """Where they are."""
        return self.body.maze

    @cached_property
    def priors(self) -> list[ActionPriors]:
        """Learned by counting what was watched."""
        sizes = len(self.maze.goals), self.maze.cells, len(ACTIONS)
        return [ActionPriors.learned(own, *sizes) for own in self.episodes]

    def towards(self, goal: int) -> list[list[Episode]]:
        """Demonstrations of goal 1, 2, ..., of each copy."""
        return [[episode for episode in own if episode.goal == goal - 1] for own in self.episodes]

    def fewer(self, demonstrations: int) -> "Experience":
        """As if only so many of each goal had been watched."""
        shown = [self.towards(goal) for goal in range(1, len(self.maze.goals) + 1)]
        few = tuple(tuple(e for mine in own for e in mine[:demonstrations]) for own in zip(*shown, strict=True))
        return Experience(self.body, self.forward_model, few)

    def remembered(self, goal: int) -> tuple[IntArray, FloatArray]:
        """(B, S) sub-goals by the acyclic rule and (B, S, A) P(a | s, g), of goal 1, 2, ..."""
        successor = np.array([acyclic_subgoals(own, self.maze.cells).successor for own in self.towards(goal)])
        return successor, np.array([own.action()[goal - 1] for own in self.priors])

    def teacher_steps(self, goal: int) -> float:
        """Mean steps of what was watched."""
        return float(np.mean([episode.steps for own in self.towards(goal) for episode in own]))

    def imitate(
        self, goal: int, selection: str, rng: np.random.Generator, limit: int | None = None, *, prior: bool = True
    ) -> Journey:
        """All imitate goal 1, 2, ..., each by what it watched itself: the acyclic rule and, unless told not to, its
        priors. They give up after `limit` steps, or `PATIENCE` times what the teacher needed.
        """
        successor, priors = self.remembered(goal)
        end, copies = self.maze.number(self.maze.goals[goal - 1]), self.body.copies
        states = places_of(self.maze)
        told = priors if prior else None
        one = Follower(self.forward_model, states, successor, end, told, copies=copies, selection=selection)
        return follow(self.body, one, rng=rng, limit=limit or int(PATIENCE * max(5.0, self.teacher_steps(goal))))


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


def population(maze: Maze, copies: int, demonstrations: int, wander_steps: int, seed: int) -> Experience:
    """Many imitators at once: each has wandered and watched for itself."""
    body = MazeBody(maze, copies=copies, seed=(seed, 21))
    shown = [
        demonstrate(body, goal, np.random.default_rng([seed, 22, goal, k]))
        for goal in range(1, len(maze.goals) + 1)
        for k in range(demonstrations)
    ]
    episodes = tuple(tuple(watched(walk, maze) for walk in own) for own in zip(*shown, strict=True))
    return Experience(body, babble(body, wanderer(body, alone=True), outings(wander_steps), seed), episodes)


class Inferred(NamedTuple):
    """What an observer believes of a walk, by the chapter's rule and by the filter."""

    by_step: Intent
    """Eq. (2) at each step by itself, P(s | g) included."""
    filtered: Intent
    """The Bayes filter; priors in doubt whether a state tells goals apart."""


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
    return Inferred(intent_by_step(plain, goal_prior, here), intent_filter(doubtful, goal_prior))


def half_for_the_first(goals: int) -> FloatArray:
    """(G,) P(goal) as in the chapter's Figure 7: one half for goal 1, the rest shared."""
    return np.array([0.5] + [0.5 / (goals - 1)] * (goals - 1)) if goals > 1 else np.ones(1)


def junctions(maze: Maze) -> list[int]:
    """Cells on the shortest ways to two goals where these ways part: no action is right for both."""
    begun, start = maze.distances(maze.start), maze.number(maze.start)
    to = [maze.distances(goal) for goal in maze.goals]
    on_the_way = [(begun >= 0) & (left > 0) & (begun + left == left[start]) for left in to]
    right = [left[maze.lead] < left[:, None] for left in to]
    parting = [
        on_the_way[i] & on_the_way[j] & ~(right[i] & right[j]).any(1) for i, j in combinations(range(len(to)), 2)
    ]
    return np.flatnonzero(np.any(parting, axis=0)).tolist() if parting else []
