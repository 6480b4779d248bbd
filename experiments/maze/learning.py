"""The forward model's learning curve in the maze, against what counting can give at best."""

from dataclasses import dataclass

import numpy as np

from babbling.axes import FloatArray
from babbling.forward_model import ForwardModel
from babbling.loop import babble
from experiments.maze.mind import CHECKPOINTS, WANDERING, outings, wanderer
from experiments.shared.progress import Report
from models.maze import TRUE_DYNAMICS, Maze, MazeBody


@dataclass(frozen=True)
class Convergence:
    """How learned rows came closer to the truth, by wandering steps; rows nobody tried are left out and counted."""

    steps: tuple[int, ...]
    visits: tuple[float, ...]
    """Mean counted visits of a row."""
    tv: tuple[float, ...]
    """Mean total variation between learned and true rows."""
    bound: tuple[float, ...]
    """Mean of what counting as many draws of the true rows is expected to be off."""
    spread: tuple[tuple[float, float], ...]
    """10 % and 90 % quantiles of a walker's mean total variation."""
    untried: tuple[int, ...]
    """Rows without a visit, over all walkers."""
    per_visit: tuple[tuple[float, float], ...] = ()
    """(visits, total variation) averaged over rows with about as many visits."""

    @property
    def slope(self) -> float | None:
        """Of log total variation against log counted visits, row by row in classes of visits; -1/2 is the law."""
        if len(self.per_visit) < 3:
            return None
        n, tv = np.log(np.array(self.per_visit)).T
        return float(np.polyfit(n, tv, 1)[0])


def expected_distance(truth: FloatArray, visits: FloatArray) -> FloatArray:
    """(..., A) E[TV] of relative frequencies after `visits` (..., A) draws from rows of `truth` (A, O).

    Law, for many draws: 1/2 sum_j sqrt(2 p_j (1 - p_j) / (pi n)), the mean absolute deviation of a binomial each.
    """
    expected: FloatArray = 0.5 * np.sqrt(2 * truth * (1 - truth) / np.pi).sum(-1) / np.sqrt(visits)
    return expected


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
    done, points, rows = np.cumsum(plan), [], []

    def look(bout: int, model: ForwardModel) -> None:
        report(done[bout - 1] / steps)
        if done[bout - 1] not in CHECKPOINTS and done[bout - 1] != steps:
            return
        visits = model.visits
        tried = visits > 0
        tv = np.abs(model.predictive - TRUE_DYNAMICS).sum(-1) / 2
        bound = expected_distance(TRUE_DYNAMICS, np.where(tried, visits, 1.0))
        if not tried.any():
            return
        means = np.divide((tv * tried).sum(1), tried.sum(1), out=np.full(copies, tv[tried].mean()), where=tried.any(1))
        low, high = np.quantile(means, [0.1, 0.9])
        points.append((visits.mean(), tv[tried].mean(), bound[tried].mean(), (low, high), int((~tried).sum())))
        steps_done.append(int(done[bout - 1]))
        rows.append((visits[tried], tv[tried]))

    steps_done: list[int] = []
    model = babble(body, wanderer(body, alone=copies > 1), plan, seed, after_bout=look)
    if not points:
        return model, Convergence((), (), (), (), (), ())
    visits, tv, bound, spread, untried = zip(*points, strict=True)
    return model, Convergence(
        tuple(steps_done),
        tuple(map(float, visits)),
        tuple(map(float, tv)),
        tuple(map(float, bound)),
        tuple((float(a), float(b)) for a, b in spread),
        untried,
        _by_visits(np.concatenate([r[0] for r in rows]), np.concatenate([r[1] for r in rows])),
    )


def _by_visits(visits: FloatArray, tv: FloatArray) -> tuple[tuple[float, float], ...]:
    """Means over rows in classes of visits (factors of 1.6), of at least 10 visits and 20 rows each.

    Fewer than ten draws from five outcomes are too coarse for the square-root law.
    """
    if not visits.size:
        return ()
    label = np.floor(np.log(visits) / np.log(1.6)).astype(int)
    classes = []
    for k in np.unique(label):
        mine = label == k
        if mine.sum() >= 20 and visits[mine].min() >= 10:
            classes.append((float(1 / np.mean(visits[mine] ** -0.5) ** 2), float(tv[mine].mean())))
    return tuple(classes)
