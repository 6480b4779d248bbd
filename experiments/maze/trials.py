"""Own steps until reliable: imitation and its peers on one axis (the chapter's claim, quantified)."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from experiments.maze.mind import population
from experiments.maze.peers import MANY, Q_SETTINGS, best_acts, copied, q_learners, replayed
from experiments.maze.planners import (
    PATIENCE,
    RELIABLE,
    arrivals,
    least_steps,
    steps_to_go,
    wanderers,
)
from experiments.maze.rerouting import Replanning, in_turn
from experiments.shared.progress import Report
from imitation.acting.follow import believed
from models.maze import TRUE_DYNAMICS, Maze

LEARNERS, EPISODES = 30, 10
IMITATION_BUDGETS = (0, 25, 50, 100, 200, 300, 500, 700, 1000)
WANDERED_FIRST, REPLANNED_WALKS = 300, 5
"""Steps, then walks from the start, of those who find walls as they plan."""
EARLY_Q_BUDGETS = (0, 100, 300, 1000, 3000)
"""Of Q-learning that starts from demonstrations, before the others."""
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

    many = population(maze, 100, MANY, 0, seed + 6)
    few = many.fewer(demonstrations)
    for goal in goals:
        for method, policy in {
            "copying": copied(few, goal),
            f"cloning, {MANY} demonstrations": copied(many, goal, nearest=True),
        }.items():
            arrived = arrivals(maze, cells[goal], policy, limits[goal], (seed, 28, goal), EPISODES)
            curves[method][goal][0] = float(arrived.mean())

    wandered = wanderers(maze, LEARNERS, IMITATION_BUDGETS, seed + 3)
    for budget, we in zip(IMITATION_BUDGETS, wandered, strict=True):
        for goal in goals:
            policy = steps_to_go(maze.lead, believed(we.model), cells[goal]).argmin(-1)
            arrived = arrivals(maze, cells[goal], policy, limits[goal], (seed, 26, goal, budget), EPISODES)
            curves["value iteration, walls known"][goal][budget] = float(arrived.mean())
    for goal in goals:
        (we,) = wanderers(maze, 2 * LEARNERS, (WANDERED_FIRST,), seed + 4)
        for steps, hits in in_turn(Replanning(we, cells[goal]), maze, REPLANNED_WALKS, limits[goal], (seed, 29, goal)):
            curves["value iteration, replanning"][goal][WANDERED_FIRST + round(steps)] = float(hits.mean())
    report(0.3)
    first = np.stack([replayed(few.towards(goal)[: LEARNERS // 2], maze.cells) for goal in goals], 1)
    best: dict[str, dict[str, str | None]] = defaultdict(dict)
    for method, budgets, values, done in (
        ("Q-learning from demonstrations", (*EARLY_Q_BUDGETS, *Q_BUDGETS), first, 0.7),
        ("Q-learning", Q_BUDGETS, None, 1.0),
    ):
        share = _q_learning(maze, cells, limits, seed + 5, budgets, values)
        report(done)
        enough = share >= RELIABLE
        soon = np.where(enough.any(0), enough.argmax(0), len(share))
        for goal, chosen in zip(goals, np.lexsort((-share.sum(0), soon))[:, 0], strict=True):
            best[method][str(goal)] = Q_SETTINGS[chosen].name if enough[:, goal - 1, chosen].any() else None
            curves[method][goal] = dict(zip(budgets, share[:, goal - 1, chosen].tolist(), strict=False))
    until = {
        method: {str(goal): reliable_from(line) for goal, line in lines.items()} for method, lines in curves.items()
    }
    own, other = until["imitation"], until["Q-learning"]
    ratio = {g: None if not a or (b := other[g]) is None else b / a for g, a in own.items()}
    return {
        "trials_imitation": own,
        "trials_imitation_observed_steps": {str(goal): float(np.mean([o[goal] for o in observed])) for goal in goals},
        "trials_value_iteration": until["value iteration, walls known"],
        "trials_value_iteration_replanning": until["value iteration, replanning"],
        "trials_q_learning": until["Q-learning"],
        "trials_q_learning_from_demonstrations": until["Q-learning from demonstrations"],
        "trials_without_own_steps": {
            method: {str(goal): line[0] for goal, line in lines.items()}
            for method, lines in curves.items()
            if all(0 in line for line in lines.values())
        },
        "trials_q_learning_over_imitation": ratio,
        "trials_q_learning_settings": [setting.name for setting in Q_SETTINGS],
        "trials_q_learning_best": best["Q-learning"],
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
    maze: Maze,
    goals: Mapping[int, int],
    limits: Mapping[int, int],
    seed: int,
    budgets: Sequence[int],
    first: FloatArray | None,
) -> FloatArray:
    """(budgets, goals, settings) share in time: learning ends when for every goal a setting is reliable."""
    share = []
    policies = q_learners(maze, np.array(list(goals.values())), LEARNERS // 2, budgets, seed, first)
    for budget, learned in zip(budgets, policies, strict=False):
        now = [
            [arrivals(maze, goal, policy, limits[g], (seed, 27, g, budget, k), EPISODES).mean()
             for k, policy in enumerate(own)]
            for (g, goal), own in zip(goals.items(), best_acts(learned), strict=True)
        ]  # fmt: skip
        share.append(now)
        if (np.array(share).max((0, 2)) >= RELIABLE).all():
            break
    return np.array(share)


def reliable_from(line: Mapping[int, float]) -> int | None:
    """The first budget at which at least 95 % of runs arrive in time; None where none of those tried is enough."""
    return next((steps for steps, share in line.items() if share >= RELIABLE), None)
