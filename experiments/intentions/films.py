"""How surprising a film of somebody's walk is: two logics of the Baby Intuitions Benchmark (Stojnic et al. 2023).

An observer who babbled in another maze, and never was in these rooms, watches others walk. What it would do itself is
Eq. (1): its own forward model turned round at the sub-goal "a place from which fewer steps are left" (J_g, by value
iteration over the same forward model and the walls it sees). Eq. (2) turns it round once more, from places alone:

    P(a | s, g) = c P(J_g(s') < J_g(s) | s, a),    at the goal itself  c P(s' = g | g, a)
    P(film | g) = prod_t sum_a P(s_{t+1} | s_t, a) P(a | s_t, g)
    P(g | films) = (1 + sum_films P(g | film)) / (G + films): what films were for is counted, from one each
    surprise = -log sum_g P(g | films) P(film | g), nats: -log of Eq. (2)'s normaliser, by the chain rule the same as
    -sum_t log sum_g P(g | films, steps so far) P(s_{t+1} | s_t, g)

Preference: films in rooms that all differ, each time to the same one of two goals; then to it again, or to the other,
which is as far away. Efficiency: the same detour round an obstacle, film after film; then, without the obstacle, the
straight way or the same detour. Infants look longer at the second of each. What acts do was learned; where somebody is
going is inferred; that others spare steps is not learned from films: it is what the observer does itself ("like me").

Two peers judge the same films, both in doubt by one pseudo-count. "Ways counted" is the same Eq. (2) with the chapter's
P(a | s, g), counted cell by cell and goal by goal in the films before. "Steps counted" knows no goals: it expects the
steps that it saw before in the same cell. To both a detour that they saw is familiar, so their sign is the opposite of
infants' (step by step: a longer film has more to be surprised at); and where goals stand elsewhere each time, familiar
steps say next to nothing of them.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from babbling.axes import FloatArray
from experiments.errors import ExperimentError
from experiments.maze.learning import walkers
from experiments.maze.mind import step_likelihood, watched
from experiments.maze.options import Config
from experiments.maze.planners import steps_to_go
from experiments.shared.figures import captioned
from experiments.shared.judging import over_learners
from experiments.shared.palette import DARK, OURS, PLAIN, THEIRS
from imitation.acting.follow import believed
from imitation.episodes import Episode
from imitation.inference.bayes import Posterior, action_posterior, goal_posterior
from imitation.inference.intent import step_evidence
from imitation.inference.priors import ActionPriors
from models.maze import ACTIONS, Maze, MazeBody, Place, default_maze, demonstrate

SIDE, HABITUATION, AGENTS = 9, 8, 20
"""Cells along a room's side; films before the test; agents of each kind whom an observer watches."""
CELLS: list[Place] = [(x, y) for y in range(1, SIDE + 1) for x in range(1, SIDE + 1)]
MINDS = {"goals, as one would go oneself": OURS, "goals, ways counted": THEIRS, "steps counted": PLAIN}
"""Who judges, and its ink."""
DIFFERENCES = {
    "preference": ("to the other goal", "to the same goal"),
    "preference, nothing seen before": ("to the other goal, first film", "to the same goal, first film"),
    "efficiency": ("detour, obstacle gone", "straight, obstacle gone"),
    "efficiency, same steps": ("detour, obstacle gone", "detour, obstacle stands"),
    "efficiency, obstacle stands": ("other detour, obstacle stands", "detour, obstacle stands"),
}
"""Unexpected less expected film; in the second and the last neither is less to be expected than the other."""
INFANTS = {"preference": "infants: +, β = 3.24, p = .040", "efficiency": "infants: +, β = 4.50, p = .016"}
"""Which of the two they looked at longer at 11 months, 24 infants each, a pilot (Stojnic et al.)."""


class Film(NamedTuple):
    """Somebody's walk in a room, as it is seen."""

    room: Maze
    episode: Episode


Session = tuple[list[Film], dict[str, Film]]
"""Films to get used to, and films by name of which any may come next."""
Prior = Callable[[Maze], FloatArray]
"""(G, S, A) P(a | s, g) in a room."""


def films(seeds: Sequence[int]) -> dict[str, Any]:
    """Surprise at films and differences of it, by mind, nats per film and per step: [mean, half of its 95 % interval]
    over observers, one a seed, who each babbled for themselves and watched agents of their own."""
    runs = []
    for seed in seeds:
        model, _ = walkers(default_maze(), Config().wander_steps, seed, 1, lambda done: None)
        rng = np.random.default_rng([seed, 41])
        runs.append([watch(believed(model)[0], rng) for _ in range(AGENTS)])
    found = {key: np.array([[one[key] for one in own] for own in runs]).mean(1) for key in runs[0][0]}  # (seeds, 2)

    def told(values: FloatArray) -> dict[str, list[float]]:
        return dict(zip(("film", "step"), np.transpose(over_learners(values)).tolist(), strict=True))

    return {
        "surprise": {film: {mind: told(found[film, mind]) for mind in MINDS} for film, _ in found},
        "difference": {
            name: {mind: told(found[odd, mind] - found[expected, mind]) for mind in MINDS}
            for name, (odd, expected) in DIFFERENCES.items()
        },
    }


def watch(table: FloatArray, rng: np.random.Generator) -> dict[tuple[str, str], tuple[float, float]]:
    """(film, mind) -> surprise, nats per film and step, at one new agent of each kind, by an (A, O) forward model."""
    before, after = preference(rng)
    first = {f"{name}, first film": film for name, film in after.items()}
    found = {}
    for habituation, tests in ((before, after), ([], first), efficiency(rng)):
        for mind, (acts, prior) in zip(MINDS, minds(table, habituation), strict=True):
            counts = np.ones(2)
            for film in habituation:
                counts += judge(film, acts, prior, counts / counts.sum()).probability
            for name, film in tests.items():
                nats = -float(np.log(judge(film, acts, prior, counts / counts.sum()).evidence))
                found[name, mind] = nats, nats / film.episode.steps
    return found


def judge(film: Film, table: FloatArray, prior: Prior, belief: FloatArray) -> Posterior:
    """Eq. (2) of a whole film, by (A, O) what acts do and (G,) P(g); its evidence is sum_g P(g) P(film | g).

    Raises:
        ExperimentError: a film impossible under every goal.
    """
    likelihood = step_likelihood(film.room, table, film.episode)
    steps = step_evidence(prior(film.room), film.episode.states[:-1], None, likelihood)  # (T, G)
    posterior = goal_posterior(np.ones(1), steps.prod(0), belief)
    if not posterior.informed:
        raise ExperimentError("a film shows a step that no act ever led to while babbling; let it babble longer")
    return posterior


def minds(table: FloatArray, before: Sequence[Film]) -> list[tuple[FloatArray, Prior]]:
    """What acts do and what would be done, for each of `MINDS`: who learned this (A, O) forward model and saw films."""
    ways = ActionPriors.learned([film.episode for film in before], 2, SIDE**2, len(ACTIONS))
    steps = ActionPriors(ways.counts.sum(0, keepdims=True).repeat(2, 0))
    does = np.eye(len(ACTIONS))
    return [
        (table, cache(lambda room: like_me(room, table))),
        (table, lambda room: ways.action(1)),
        (does, lambda room: steps.action(1)),
    ]


def like_me(room: Maze, table: FloatArray) -> FloatArray:
    """(G, S, A) P(a | s, g) of the module's head: what one would do oneself, by one's (A, O) forward model."""
    found = []
    for end in map(room.number, room.goals):
        left = steps_to_go(room.lead, table[None], end)[0].min(-1)
        nearer = left[room.lead] < left[:, None]  # (S, O)
        nearer[end] = room.lead[end] == end
        found.append(action_posterior(nearer @ table.T).probability)
    return np.array(found)


def preference(rng: np.random.Generator) -> Session:
    """Walks to goal 1, in rooms where start and goals are drawn, then to either; goals are equally far."""
    rooms = []
    for _ in range(HABITUATION + 1):
        start = CELLS[rng.integers(len(CELLS))]
        away = np.abs(np.subtract(CELLS, start)).sum(1)
        far = rng.choice(np.flatnonzero(np.bincount(away) > 1))
        one, two = rng.permutation(np.flatnonzero(away == far))[:2]
        rooms.append(_room(start, CELLS[one], CELLS[two]))
    *before, last = rooms
    after = {"to the same goal": _walk(last, 1, rng), "to the other goal": _walk(last, 2, rng)}
    return [_walk(room, 1, rng) for room in before], after


def efficiency(rng: np.random.Generator) -> Session:
    """Detours to goal 1 round an obstacle, as long above as below it; goal 2 stands anywhere else."""
    near, far, half = rng.integers(1, (SIDE - 1) // 2, 3).tolist()
    row, column = (SIDE + 1) // 2, int(rng.integers(near, SIDE + 1 - far))
    start, goal = (near, row), (SIDE + 1 - far, row)
    others = [place for place in CELLS if place not in (start, goal)]
    places = start, goal, others[rng.integers(len(others))]
    gone, stands = _room(*places), _room(*places, column, slice(row - 1 - half, row + half))
    detour = _walk(stands, 1, rng)
    y, x = np.divmod(detour.episode.states, SIDE)
    other = Episode(0, (SIDE - 1 - y) * SIDE + x, np.array([2, 1, 0, 3, 4])[detour.episode.actions])
    return [detour] * HABITUATION, {
        "straight, obstacle gone": _walk(gone, 1, rng),
        "detour, obstacle gone": Film(gone, detour.episode),
        "detour, obstacle stands": detour,
        "other detour, obstacle stands": Film(stands, other),
    }


def _room(start: Place, goal: Place, other: Place, column: int = 1, rows: slice = slice(0)) -> Maze:
    """With a wall to the east of some cells of a column."""
    walls = np.zeros((SIDE, SIDE, 4), bool)
    walls[-1, :, 0] = walls[:, -1, 1] = walls[0, :, 2] = walls[:, 0, 3] = True
    walls[rows, column - 1, 1] = walls[rows, column, 3] = True
    return Maze(walls, start, (goal, other))


def _walk(room: Maze, goal: int, rng: np.random.Generator) -> Film:
    """A shortest one, by acts that always succeed."""
    [walk] = demonstrate(MazeBody(room, dynamics=np.eye(len(ACTIONS))), goal, rng)
    return Film(room, watched(walk, room))


@captioned(
    "By how much more surprising the unexpected film is than the expected one, mind by mind, with 95 % "
    "intervals over observers. Infants' signs below; where nothing should be unexpected the bars should be "
    "none."
)
def figure(found: dict[str, Any]) -> Figure:
    """How much more surprising, mind by mind, with 95 % intervals; nats per step."""
    drawn = Figure(figsize=(11, 4.8), layout="constrained")
    axes, at = drawn.subplots(), np.arange(len(DIFFERENCES))
    for k, (mind, ink) in enumerate(MINDS.items()):
        mean, half = np.transpose([of[mind]["step"] for of in found["difference"].values()])
        axes.bar(at + 0.27 * (k - 1), mean, 0.25, yerr=half, capsize=2, color=ink, ecolor=DARK, label=mind)
    axes.axhline(0, color=DARK, lw=0.8)
    axes.set_ylabel("surprise, unexpected - expected film\nnats per step, mean and 95 % over observers")
    named = DIFFERENCES.items()
    axes.set_xticks(at, [f"{n}\n{odd}\n- {expected}\n{INFANTS.get(n, '')}" for n, (odd, expected) in named], fontsize=8)
    drawn.legend(ncols=3, loc="outside lower center", frameon=False)
    drawn.suptitle(
        "Who expects what of films of walks: infants' signs, and where nothing should be unexpected (second, last)",
        fontsize=11,
    )
    return drawn
