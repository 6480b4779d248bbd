"""The forward model's learning curve in the maze, against what counting can give at best."""

from dataclasses import dataclass

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.forward_model import ForwardModel
from babbling.loop import babble
from experiments.maze.mind import CHECKPOINTS, WANDERING, outings, wanderer
from experiments.shared.progress import Report
from models.maze import TRUE_DYNAMICS, Maze, MazeBody

RUNS, BAND = 400, 31
"""Runs that are drawn for the band, and their stream of randomness."""


@dataclass(frozen=True, eq=False)
class Convergence:
    """How learned rows came closer to the truth, by wandering steps; rows nobody tried are left out."""

    steps: IntArray
    tv: FloatArray
    """Mean total variation between learned and true rows."""
    bound: FloatArray
    """Mean of what counting as many draws of the true rows is expected to be off: an expectation, not a limit."""
    band: FloatArray
    """(2, N) between which 95 % of such means lie, row by row counted from as many draws of the truth."""
    per_visit: FloatArray
    """(N, 2) visits and total variation, averaged over rows with about as many visits."""

    @property
    def slope(self) -> float | None:
        """Of log total variation against log counted visits, row by row in classes of visits; -1/2 is the law."""
        visits, tv = np.log(self.per_visit).T
        return float(np.polyfit(visits, tv, 1)[0]) if len(visits) >= 3 else None


def expected_distance(truth: FloatArray, visits: FloatArray) -> FloatArray:
    """(..., A) E[TV] of relative frequencies after `visits` (..., A) draws from rows of `truth` (A, O).

    Law, for many draws: 1/2 sum_j sqrt(2 p_j (1 - p_j) / (pi n)), the mean absolute deviation of a binomial each.
    """
    return np.asarray(0.5 * np.sqrt(2 * truth * (1 - truth) / np.pi).sum(-1) / np.sqrt(visits))


def scatter(truth: FloatArray, visits: IntArray, rng: np.random.Generator, runs: int = RUNS) -> FloatArray:
    """(2,) ends of 95 % of the mean TV over R rows of `truth` (R, O), each counted from its `visits` (R,) draws: by
    drawing them anew, multinomially."""
    counted = rng.multinomial(visits, truth, (runs, len(visits))) / visits[:, None]
    return np.asarray(np.quantile((np.abs(counted - truth).sum(-1) / 2).mean(-1), (0.025, 0.975)))


def walkers(maze: Maze, steps: int, seed: int, copies: int, report: Report) -> tuple[ForwardModel, Convergence]:
    """`copies` walkers that each learn for themselves, and their learning curve.

    Args:
        maze: where.
        steps: random steps of each.
        seed: randomness.
        copies: how many.
        report: is told the fraction done.
    """
    body, plan = MazeBody(maze, copies=copies, seed=[seed, WANDERING]), outings(steps)
    done, points, rows = np.cumsum(plan), [], [np.zeros((2, 0))]

    def look(bout: int, model: ForwardModel) -> None:
        now, visits = done[bout - 1], model.visits
        report(now / steps)
        tried = visits > 0
        if now not in (*CHECKPOINTS, steps) or not tried.any():
            return
        tv = np.abs(model.predictive - TRUE_DYNAMICS).sum(-1) / 2
        bound = expected_distance(TRUE_DYNAMICS, np.where(tried, visits, 1.0))
        truth = np.broadcast_to(TRUE_DYNAMICS, (*visits.shape, TRUE_DYNAMICS.shape[-1]))[tried]
        band = scatter(truth, visits[tried].astype(int), np.random.default_rng([seed, BAND, int(now)]))
        points.append((now, tv[tried].mean(), bound[tried].mean(), *band))
        rows.append(np.stack([visits[tried], tv[tried]]))

    model = babble(body, wanderer(body, alone=copies > 1), plan, seed, after_bout=look)
    at, tv, bound, *band = np.array(points, float).reshape(-1, 5).T
    return model, Convergence(at.astype(int), tv, bound, np.array(band), _by_visits(*np.concatenate(rows, axis=1)))


def _by_visits(visits: FloatArray, tv: FloatArray) -> FloatArray:
    """(N, 2) means over rows in classes of visits (factors of 1.6), of at least 10 visits and 20 rows each.

    Fewer than ten draws from five outcomes are too coarse for the square-root law.
    """
    label = np.floor(np.log(visits) / np.log(1.6)).astype(int)
    classes = [(visits[label == k], tv[label == k]) for k in np.unique(label)]
    enough = [(n, off) for n, off in classes if len(n) >= 20 and n.min() >= 10]
    return np.array([(1 / np.mean(n**-0.5) ** 2, off.mean()) for n, off in enough]).reshape(-1, 2)
