"""Own steps until reliable: imitation and its peers on one axis (the chapter's claim, quantified)."""

from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np

from experiments.maze.mind import population
from experiments.maze.peers import MANY, best_acts, copied, q_learners, replayed
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
WANDERED_FIRST, REPLANNED_WALKS = 200, 5
"""Steps, then walks from the start, of those who find walls as they plan."""
Q_BUDGETS = (0, 100, 300, 1000, 3000, 10_000, 30_000, 70_000, 100_000, 150_000, 200_000, 300_000, 400_000)
"""Learning ends when for every goal a setting is reliable; the best setting is told at each."""

Curves = Mapping[str, Mapping[int, Mapping[int, float]]]
"""Method -> goal -> own steps -> share of runs that arrive in time."""


def trials(maze: Maze, seed: int, demonstrations: int, report: Report) -> tuple[dict[str, Any], Curves]:
    """Own steps until reliable, by method and goal; and the share of runs that arrive in time by own steps."""
    goals = range(1, len(maze.goals) + 1)
    cells = {goal: maze.number(maze.goals[goal - 1]) for goal in goals}
    least = {goal: least_steps(maze, TRUE_DYNAMICS, cells[goal]) for goal in goals}
    limits = {goal: int(PATIENCE * least[goal]) for goal in goals}
    curves: dict[str, dict[int, dict[int, float]]] = defaultdict(lambda: defaultdict(dict))

    for budget in IMITATION_BUDGETS:
        imitators = population(maze, 100, demonstrations, budget, seed + 2)
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
    for method, values, done in (("Q-learning from demonstrations", first, 0.6), ("Q-learning", None, 1.0)):
        policies = q_learners(maze, np.array(list(cells.values())), LEARNERS // 2, Q_BUDGETS, seed + 5, values)
        for budget, learned in zip(Q_BUDGETS, policies, strict=True):
            for goal, own in zip(goals, best_acts(learned), strict=True):
                stream = (seed, 27, goal, budget)
                found = [arrivals(maze, cells[goal], policy, limits[goal], stream, EPISODES).mean() for policy in own]
                curves[method][goal][budget] = float(max(found))
            if all(reliable_from(line) is not None for line in curves[method].values()):
                break
        report(done)
    until = {
        method: {str(goal): reliable_from(line) for goal, line in lines.items()} for method, lines in curves.items()
    }
    return {
        "trials_imitation": until["imitation"],
        "trials_imitation_observed_steps": {str(goal): demonstrations * few.teacher_steps(goal) for goal in goals},
        "trials_value_iteration": until["value iteration, walls known"],
        "trials_value_iteration_replanning": until["value iteration, replanning"],
        "trials_q_learning": until["Q-learning"],
        "trials_q_learning_from_demonstrations": until["Q-learning from demonstrations"],
        "trials_without_own_steps": {
            method: {str(goal): line[0] for goal, line in lines.items()}
            for method, lines in curves.items()
            if all(0 in line for line in lines.values())
        },
        "trials_reliable_share": RELIABLE,
        "trials_curves": {
            method: {str(g): {"steps": [*line], "share": [*line.values()]} for g, line in lines.items()}
            for method, lines in curves.items()
        },
    }, curves


def reliable_from(line: Mapping[int, float]) -> int | None:
    """The first budget at which at least 95 % of runs arrive in time; None where none of those tried is enough."""
    return next((steps for steps, share in line.items() if share >= RELIABLE), None)
