"""Trials until reliable: imitation, value iteration and Q-learning on one axis (the chapter's claim, quantified)."""

from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np

from babbling.axes import FloatArray, IntArray
from experiments.maze.mind import population
from experiments.maze.planners import (
    PATIENCE,
    Q_SETTINGS,
    RELIABLE,
    Known,
    arrivals,
    least_steps,
    q_learners,
    replanners,
    steps_to_go,
    wanderers,
)
from experiments.shared.progress import Report
from models.maze import TRUE_DYNAMICS, Maze

LEARNERS, EPISODES = 30, 10
IMITATION_BUDGETS = (25, 50, 100, 200, 300, 500, 700, 1000)
WANDER_BUDGETS = (*IMITATION_BUDGETS, 2000, 3000, 5000, 7000, 10_000, 20_000, 30_000, 50_000, 70_000, 100_000, 200_000)
REPLAN_BUDGETS = (300, 500, 700, 1000, 1500, 2000, 3000)
Q_BUDGETS = (10_000, 20_000, 30_000, 50_000, 70_000, 100_000, 150_000, 200_000, 300_000, 400_000)

Curves = Mapping[str, Mapping[int, Mapping[int, float]]]
"""Method -> goal -> own steps -> share of runs that arrive in time."""


def trials(maze: Maze, seed: int, demonstrations: int, report: Report) -> tuple[dict[str, Any], Curves]:
    """Own steps until reliable, by method and goal; and the share of runs that arrive in time by own steps."""
    goals = range(1, len(maze.goals) + 1)
    cells = {goal: maze.number(maze.goals[goal - 1]) for goal in goals}
    least = {goal: least_steps(maze, TRUE_DYNAMICS, cells[goal]) for goal in goals}
    limits = {goal: int(PATIENCE * least[goal]) for goal in goals}
    curves: dict[str, dict[int, dict[int, float]]] = defaultdict(lambda: defaultdict(dict))

    observed = []
    for budget in IMITATION_BUDGETS:
        imitators = population(maze, 100, demonstrations, budget, seed + 2)
        observed.append({goal: demonstrations * imitators.teacher_steps(goal) for goal in goals})
        for goal in goals:
            journey = imitators.imitate(goal, "map", np.random.default_rng([seed + 2, 23, goal]), limits[goal])
            curves["imitation"][goal][budget] = float(journey.reached.mean())
    report(0.04)

    def evaluate(method: str, goal: int, budget: int, known: Known, lead: IntArray) -> None:
        policy = steps_to_go(lead, known.tables, cells[goal]).argmin(-1)
        arrived = arrivals(maze, cells[goal], policy, limits[goal], (seed, 26, goal, budget), EPISODES)
        curves[method][goal][budget] = float(arrived.mean())

    wandered = wanderers(maze, LEARNERS, WANDER_BUDGETS, seed + 3, lambda done: report(0.04 + 0.36 * done))
    for budget, known in zip(WANDER_BUDGETS, wandered, strict=False):
        for goal in goals:
            if budget <= IMITATION_BUDGETS[-1]:
                evaluate("value iteration, walls known", goal, budget, known, maze.lead[None])
            if budget >= IMITATION_BUDGETS[-1]:
                evaluate("value iteration, walls discovered", goal, budget, known, known.lead)
        if all(reliable_from(curves["value iteration, walls discovered"][goal]) for goal in goals):
            break
    for goal in goals:
        planned = replanners(maze, cells[goal], LEARNERS // 2, REPLAN_BUDGETS, seed + 4)
        for budget, known in zip(REPLAN_BUDGETS, planned, strict=True):
            evaluate("value iteration, replanning", goal, budget, known, known.lead)
        report(0.4 + 0.15 * goal / len(goals))
    share = _q_learning(maze, cells, limits, seed + 5, lambda done: report(0.55 + 0.45 * done))
    enough = share >= RELIABLE
    soon = np.where(enough.any(0), enough.argmax(0), len(share))
    best: dict[str, str | None] = {}
    for goal, chosen in zip(goals, np.lexsort((-share.sum(0), soon))[:, 0], strict=True):
        best[str(goal)] = Q_SETTINGS[chosen].name if enough[:, goal - 1, chosen].any() else None
        curves["Q-learning"][goal] = dict(zip(Q_BUDGETS, share[:, goal - 1, chosen].tolist(), strict=False))
    report(1.0)
    until = {
        method: {str(goal): reliable_from(line) for goal, line in lines.items()} for method, lines in curves.items()
    }
    own, other = until["imitation"], until["Q-learning"]
    ratio = {g: None if a is None or (b := other[g]) is None else b / a for g, a in own.items()}
    return {
        "trials_imitation": own,
        "trials_imitation_observed_steps": {str(goal): float(np.mean([o[goal] for o in observed])) for goal in goals},
        "trials_value_iteration": until["value iteration, walls known"],
        "trials_value_iteration_discovered_walls": until["value iteration, walls discovered"],
        "trials_value_iteration_replanning": until["value iteration, replanning"],
        "trials_q_learning": until["Q-learning"],
        "trials_q_learning_over_imitation": ratio,
        "trials_q_learning_settings": [setting.name for setting in Q_SETTINGS],
        "trials_q_learning_best": best,
        "trials_limit_steps": {str(goal): steps for goal, steps in limits.items()},
        "trials_least_steps": {str(goal): steps for goal, steps in least.items()},
        "trials_reliable_share": RELIABLE,
        "trials_curves": {
            method: {str(g): {"steps": [*line], "share": [*line.values()]} for g, line in lines.items()}
            for method, lines in curves.items()
        },
        "trials_note": "imitation's own steps are few because the demonstrations supply the map; null: not reliable "
        "within the largest budget",
    }, curves


def _q_learning(
    maze: Maze, goals: Mapping[int, int], limits: Mapping[int, int], seed: int, report: Report
) -> FloatArray:
    """(budgets, goals, settings) share in time: learning ends when for every goal a setting is reliable."""
    share = []
    policies = q_learners(maze, np.array(list(goals.values())), LEARNERS // 2, Q_BUDGETS, seed)
    for budget, learned in zip(Q_BUDGETS, policies, strict=False):
        now = [
            [arrivals(maze, goal, policy, limits[g], (seed, 27, g, budget, k), EPISODES).mean()
             for k, policy in enumerate(own)]
            for (g, goal), own in zip(goals.items(), learned, strict=True)
        ]  # fmt: skip
        share.append(now)
        report(budget / Q_BUDGETS[-1])
        if (np.array(share).max((0, 2)) >= RELIABLE).all():
            break
    return np.array(share)


def reliable_from(line: Mapping[int, float]) -> int | None:
    """The first budget at which at least 95 % of runs arrive in time; None where none of those tried is enough."""
    return next((steps for steps, share in line.items() if share >= RELIABLE), None)
