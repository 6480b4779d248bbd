"""Trials until reliable: imitation, value iteration and Q-learning on one axis (the chapter's claim, quantified)."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from babbling.axes import FloatArray, IntArray
from experiments.maze.mind import Imitators
from experiments.maze.planners import (
    Q_SETTINGS,
    RELIABLE,
    Known,
    QLearners,
    arrivals,
    least_steps,
    limit_for,
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

NEVER: dict[str, list[float]] = {"steps": [], "share": []}


def trials(
    maze: Maze, seed: int, demonstrations: int, report: Report
) -> tuple[dict[str, Any], dict[str, dict[int, dict[str, list[float]]]]]:
    """Own steps until reliable, by method and goal; and the share of runs that arrive in time by own steps."""
    goals = range(1, len(maze.goals) + 1)
    cells = {goal: maze.number(maze.goals[goal - 1]) for goal in goals}
    limits = {goal: limit_for(maze, TRUE_DYNAMICS, cells[goal]) for goal in goals}
    curves: dict[str, dict[int, dict[str, list[float]]]] = {}

    def note(method: str, goal: int, steps: int, share: float) -> None:
        line = curves.setdefault(method, {}).setdefault(goal, {"steps": [], "share": []})
        line["steps"].append(steps)
        line["share"].append(share)

    observed = []
    for budget in IMITATION_BUDGETS:
        imitators = Imitators(maze, 100, demonstrations, budget, seed + 2)
        observed.append({goal: demonstrations * imitators.teacher_steps(goal) for goal in goals})
        for goal in goals:
            note("imitation", goal, budget, float(imitators.journeys(goal, "map", limits[goal]).reached.mean()))
    report(0.04)

    def evaluate(method: str, goal: int, budget: int, known: Known, lead: IntArray) -> None:
        policy = steps_to_go(lead, known.tables, cells[goal]).argmin(-1)
        arrived = arrivals(maze, cells[goal], policy, limits[goal], (seed, 26, goal, budget), EPISODES)
        note(method, goal, budget, float(arrived.mean()))

    wandered = wanderers(maze, LEARNERS, WANDER_BUDGETS, seed + 3, lambda done: report(0.04 + 0.36 * done))
    for budget, known in zip(WANDER_BUDGETS, wandered, strict=False):
        for goal in goals:
            if budget <= IMITATION_BUDGETS[-1]:
                evaluate("value iteration, walls known", goal, budget, known, maze.lead[None])
            if budget >= IMITATION_BUDGETS[-1]:
                evaluate("value iteration, walls discovered", goal, budget, known, known.lead)
        if all(reliable_from(line) for line in curves.get("value iteration, walls discovered", {0: NEVER}).values()):
            break
    for goal in goals:
        planned = replanners(maze, cells[goal], LEARNERS // 2, REPLAN_BUDGETS, seed + 4)
        for budget, known in zip(REPLAN_BUDGETS, planned, strict=True):
            evaluate("value iteration, replanning", goal, budget, known, known.lead)
        report(0.4 + 0.15 * goal / len(goals))
    best = _q_learning(maze, list(cells.values()), limits, seed + 5, note, lambda done: report(0.55 + 0.45 * done))
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
        "trials_limit_steps": {str(goal): limits[goal] for goal in goals},
        "trials_least_steps": {str(goal): least_steps(maze, TRUE_DYNAMICS, cells[goal]) for goal in goals},
        "trials_reliable_share": RELIABLE,
        "trials_curves": {m: {str(g): line for g, line in lines.items()} for m, lines in curves.items()},
        "trials_note": "imitation's own steps are few because the demonstrations supply the map; null: not reliable "
        "within the largest budget",
    }, curves


def _q_learning(
    maze: Maze,
    goals: Sequence[int],
    limits: dict[int, int],
    seed: int,
    note: Callable[[str, int, int, float], None],
    report: Report,
) -> dict[str, str | None]:
    """Every setting learns until, for every goal, one of them is reliable; the best one's curve is noted."""
    learners = QLearners(maze, np.array(goals), LEARNERS // 2, seed)
    share: list[FloatArray] = []
    for budget, policies in zip(Q_BUDGETS, learners.policies(Q_BUDGETS), strict=False):
        found = np.array(
            [
                [
                    arrivals(maze, goal, p, limits[g], (seed, 27, g, budget, k), EPISODES).mean()
                    for k, p in enumerate(own)
                ]
                for g, (goal, own) in enumerate(zip(goals, policies, strict=True), 1)
            ]
        )  # (goals, settings)
        share.append(found)
        report(budget / Q_BUDGETS[-1])
        if (np.array(share).max((0, 2)) >= RELIABLE).all():
            break
    table = np.array(share)  # (budgets, goals, settings)
    best: dict[str, str | None] = {}
    for g in range(len(goals)):
        soon = np.where((table[:, g] >= RELIABLE).any(0), (table[:, g] >= RELIABLE).argmax(0), len(table))
        chosen = int(np.lexsort((-table[:, g].sum(0), soon))[0])
        best[str(g + 1)] = Q_SETTINGS[chosen].name if soon[chosen] < len(table) else None
        for budget, value in zip(Q_BUDGETS, table[:, g, chosen], strict=False):
            note("Q-learning", g + 1, budget, float(value))
    report(1.0)
    return best


def reliable_from(line: dict[str, list[float]]) -> int | None:
    """The first budget at which at least 95 % of runs arrive in time; None where none of those tried is enough."""
    for steps, share in zip(line["steps"], line["share"], strict=True):
        if share >= RELIABLE:
            return int(steps)
    return None
