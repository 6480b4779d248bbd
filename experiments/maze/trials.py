"""Own steps until reliable: imitation and its peers on one axis (the chapter's claim, quantified)."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from babbling.axes import IntArray
from experiments.maze.mind import population
from experiments.maze.peers import MANY, best_acts, copied, q_learners, replayed
from experiments.maze.planners import PATIENCE, RELIABLE, arrivals, least_steps, steps_to_go, wanderers
from experiments.maze.rerouting import Replanning, in_turn
from experiments.shared.progress import Report
from imitation.acting.follow import believed
from models.maze import TRUE_DYNAMICS, Maze

LEARNERS, EPISODES = 30, 10
IMITATION_BUDGETS = (0, 25, 50, 100, 200, 300, 500, 700, 1000)
WANDERED_FIRST, REPLANNED_WALKS = 200, 5
"""Steps, then walks from the start, of those who find walls as they plan."""
Q_BUDGETS = (0, 100, 300, 1000, 3000, 10_000, 30_000, 70_000, 100_000, 150_000, 200_000, 300_000, 400_000)
"""Learning ends when for every goal a setting is reliable; the best setting is told at each."""

NAMES = {
    "trials_imitation": "imitation",
    "trials_value_iteration": "value iteration, walls known",
    "trials_value_iteration_replanning": "value iteration, replanning",
    "trials_q_learning": "Q-learning",
    "trials_q_learning_from_demonstrations": "Q-learning from demonstrations",
}


def trials(maze: Maze, seed: int, demonstrations: int, report: Report) -> dict[str, Any]:
    """Own steps until reliable, by method and goal; and the share of runs that arrive in time by own steps."""
    goals = range(1, len(maze.goals) + 1)
    cells = {goal: maze.number(maze.goals[goal - 1]) for goal in goals}
    limits = {goal: int(PATIENCE * least_steps(maze, TRUE_DYNAMICS, cells[goal])) for goal in goals}
    curves: dict[str, dict[int, dict[int, float]]] = defaultdict(lambda: defaultdict(dict))

    def judge(method: str, goal: int, budget: int, policies: Iterable[IntArray], stream: tuple[int, ...]) -> None:
        found = (arrivals(maze, cells[goal], one, limits[goal], (seed, *stream), EPISODES).mean() for one in policies)
        curves[method][goal][budget] = float(max(found))

    many = population(maze, 100, MANY, 0, seed + 6)
    few = many.fewer(demonstrations)
    wandered = wanderers(maze, LEARNERS, IMITATION_BUDGETS, seed + 3)
    for done, (budget, we) in enumerate(zip(IMITATION_BUDGETS, wandered, strict=True), 1):
        imitators = population(maze, 100, demonstrations, budget, seed + 2)
        for goal in goals:
            journey = imitators.imitate(goal, "map", np.random.default_rng([seed + 2, 23, goal]), limits[goal])
            curves["imitation"][goal][budget] = float(journey.reached.mean())
            policy = steps_to_go(maze.lead, believed(we.model), cells[goal]).argmin(-1)
            judge("value iteration, walls known", goal, budget, [policy], (26, goal, budget))
        report(0.2 * done / len(IMITATION_BUDGETS))
    for goal in goals:
        judge("copying", goal, 0, [copied(few, goal)], (28, goal))
        judge(f"cloning, {MANY} demonstrations", goal, 0, [copied(many, goal, nearest=True)], (28, goal))
        (we,) = wanderers(maze, 2 * LEARNERS, (WANDERED_FIRST,), seed + 4)
        for steps, hits in in_turn(Replanning(we, cells[goal]), maze, REPLANNED_WALKS, limits[goal], (seed, 29, goal)):
            curves["value iteration, replanning"][goal][WANDERED_FIRST + round(steps)] = float(hits.mean())
    report(0.3)
    first = np.stack([replayed(few.towards(goal)[: LEARNERS // 2], maze.cells) for goal in goals], 1)
    for method, values, share in (("Q-learning from demonstrations", first, 0.6), ("Q-learning", None, 1.0)):
        policies = q_learners(maze, np.array(list(cells.values())), LEARNERS // 2, Q_BUDGETS, seed + 5, values)
        for budget, learned in zip(Q_BUDGETS, policies, strict=True):
            for goal, own in zip(goals, best_acts(learned), strict=True):
                judge(method, goal, budget, own, (27, goal, budget))
            if all(reliable_from(line) is not None for line in curves[method].values()):
                break
        report(share)
    return {
        **{name: {str(goal): reliable_from(line) for goal, line in curves[who].items()} for name, who in NAMES.items()},
        "trials_imitation_observed_steps": {str(goal): demonstrations * few.teacher_steps(goal) for goal in goals},
        "trials_curves": {
            method: {str(g): {"steps": [*line], "share": [*line.values()]} for g, line in lines.items()}
            for method, lines in curves.items()
        },
    }


def reliable_from(line: Mapping[int, float]) -> int | None:
    """The first budget at which at least 95 % of runs arrive in time; None where none of those tried is enough."""
    return next((steps for steps, share in line.items() if share >= RELIABLE), None)
