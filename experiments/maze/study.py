"""`imitate maze --study`: the chapter's claims of section 3.3 over many seeds, as numbers and two figures."""

from collections import defaultdict
from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np

from experiments.maze.changes import OWN_STEPS, changes
from experiments.maze.figures import changes_figure, intent_figure, learning_curve, trials_figure
from experiments.maze.intents import intents
from experiments.maze.learning import walkers
from experiments.maze.mind import (
    Experience,
    population,
)
from experiments.maze.peers import Q_SETTINGS
from experiments.maze.planners import PATIENCE, RELIABLE
from experiments.maze.trials import trials
from experiments.shared.experiment import Result
from experiments.shared.progress import Report
from experiments.shared.tables import table
from models.maze import Maze

SEEDS = 150
WALKS = 200  # unseen walks per goal
CURVE_STEPS, CURVE_WALKERS = 100_000, 100
SELECTIONS = ("map", "matching")


def study(maze: Maze, seed: int, demonstrations: int, wander_steps: int, smoothing: float, report: Report) -> Result:
    """All claims; `report` is told the fraction done."""
    _, curve = walkers(maze, CURVE_STEPS, seed, CURVE_WALKERS, lambda done: report(0.15 * done))
    late = curve.steps >= 300
    at = [str(steps) for steps in curve.steps[late]]
    metrics: dict[str, Any] = {
        "forward_model_tv": dict(zip(at, curve.tv[late], strict=True)),
        "forward_model_tv_bound": dict(zip(at, curve.bound[late], strict=True)),
        "forward_model_tv_slope": curve.slope,
        "forward_model_untried_rows": dict(zip(at, curve.untried[late], strict=True)),
        "forward_model_walkers": CURVE_WALKERS,
    }
    metrics |= _imitation(population(maze, SEEDS, demonstrations, wander_steps, seed), seed)
    report(0.18)
    observers = population(maze, WALKS, demonstrations, wander_steps, seed + 1)
    metrics |= intents(observers, seed + 1, smoothing, lambda done: report(0.18 + 0.07 * done))
    found, curves = trials(maze, seed, demonstrations, lambda done: report(0.25 + 0.35 * done))
    metrics |= found | changes(maze, seed, demonstrations, lambda done: report(0.6 + 0.4 * done))
    figures = {
        "trials": trials_figure(curves, RELIABLE),
        "changes": changes_figure(metrics["changes"]),
        "intent_early": intent_figure(metrics["intent_by_share"]),
    }
    if len(curve.steps):
        figures["learning_curve_study"] = learning_curve(curve)
    return Result(metrics, _summary(metrics), figures)


def _imitation(imitators: Experience, seed: int) -> dict[str, Any]:
    found: dict[str, Any] = defaultdict(lambda: {selection: {} for selection in SELECTIONS})
    teacher = {goal: imitators.teacher_steps(goal) for goal in range(1, len(imitators.maze.goals) + 1)}
    for selection, goal in product(SELECTIONS, teacher):
        journey, bare = (
            imitators.imitate(goal, selection, np.random.default_rng([seed, 23, goal]), prior=prior)
            for prior in (True, False)
        )
        alone = journey.decisions.forward_alone.sum(0)
        for name, value in {
            "imitation_success": journey.reached.mean(),
            "step_ratio": journey.steps.mean() / teacher[goal],
            "uninformed_steps": alone.mean(),
            "uninformed_episodes": (alone > 0).mean(),
            "chance_steps": journey.decisions.chance.sum(),
            "step_ratio_without_prior": bare.steps.mean() / teacher[goal],
        }.items():
            found[name][selection][str(goal)] = float(value)
    return {**found, "imitation_seeds": imitators.body.copies, "teacher_steps": teacher}


def _summary(metrics: dict[str, Any]) -> str:
    def joined(values: Mapping[str, float | None], form: str) -> str:
        return " / ".join("-" if value is None else format(value, form) for value in values.values())

    def of(name: str, form: str) -> str:
        return joined(metrics[name], form)

    def both(name: str) -> str:
        return "; ".join(f"{selection} {joined(goals, '.2f')}" for selection, goals in metrics[name].items())

    m, entropy, slope = metrics, metrics["junction_entropy_bits"], metrics["forward_model_tv_slope"]
    losses = ", ".join(f"{m[f'intent_{rule}_log_loss']:.3f}" for rule in ("filter", "step"))
    at_goal_1 = [entropy["uniform_goal_1"], entropy["uneven_goal_1"]]
    claims = {
        f"total variation of learned rows at {' / '.join(m['forward_model_tv'])} steps": of("forward_model_tv", ".4f"),
        "multinomial bound": of("forward_model_tv_bound", ".4f"),
        "slope against counted visits": "-" if slope is None else f"{slope:.3f}",
        f"imitation succeeds, {m['imitation_seeds']} seeds": both("imitation_success"),
        "steps / teacher's steps": both("step_ratio"),
        "the same without the learned prior": both("step_ratio_without_prior"),
        "steps per imitation where Eq. (1) is 0/0": both("uninformed_steps"),
        f"intent, filter right at the end, share of {m['intent_walks']} walks": f"{m['intent_filter_accuracy']:.4f}",
        "the same, actions unseen": f"{m['intent_unseen_filter_accuracy']:.4f}",
        "right steps by Eq. (2) step by step, actions seen, unseen": f"{m['intent_step_accuracy']:.3f}, "
        f"{m['intent_unseen_step_accuracy']:.3f}",
        "mean log-loss: filter, Eq. (2) step by step": f"{losses} bit",
        "entropy at junctions on walks to goal 1, goal prior uniform, half for goal 1": "-"
        if None in at_goal_1
        else ", ".join(f"{bits:.3f}" for bits in at_goal_1) + " bit",
        f"own steps until {100 * RELIABLE:.0f} % arrive within {PATIENCE:g} x the least: imitation": of(
            "trials_imitation", ""
        ),
        "steps observed for it": of("trials_imitation_observed_steps", ".0f"),
        "value iteration, walls known": of("trials_value_iteration", ""),
        "value iteration, walls found by replanning": of("trials_value_iteration_replanning", ""),
        f"Q-learning, best of {len(Q_SETTINGS)} settings": of("trials_q_learning", ""),
        "the same, starting from the demonstrations": of("trials_q_learning_from_demonstrations", ""),
        **{
            f"arrive in time with no own step: {method}": joined(line, ".3f")
            for method, line in m["trials_without_own_steps"].items()
        },
    }
    changed = {
        f"{world}: {method}": "; ".join(
            f"{steps:.0f}: {share:.3f} ({low:.2f} to {high:.2f})"
            for steps, share, (low, high) in zip(one["own_steps"], one["share"], one["interval"], strict=True)
        )
        for world, methods in m["changes"].items()
        for method, one in methods.items()
    }
    early = {
        rule: "; ".join(f"{share:.0%} {right:.2f}" for share, right in zip(one["share"], one["accuracy"], strict=True))
        for rule, one in m["intent_by_share"].items()
    }
    return f"""
## Study (numbers per goal: 1 / 2 / ...)

{table(claims.items(), ("claim", "found"))}

What the demonstrations supply is the map: imitation needs few steps of its own because somebody else found the way.

## Where the maze changes: own steps in it, share that then arrives in time, 95 % interval

All have made {OWN_STEPS} own steps in the maze as it was; planners were told the goal's place, not the way.

{table(changed.items(), ("who", "found"))}

## Goal named rightly, by the share of the walk seen

{table(early.items(), ("rule", "found"))}
"""
