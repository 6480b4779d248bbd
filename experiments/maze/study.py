"""`imitate maze --study`: the chapter's claims of section 3.3 over many seeds, as numbers and figures."""

from collections import defaultdict
from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np

from experiments.maze.changes import OWN_STEPS, changes
from experiments.maze.figures import learning_curve
from experiments.maze.intents import intents
from experiments.maze.learning import Convergence, walkers
from experiments.maze.mind import population
from experiments.maze.planners import RELIABLE
from experiments.maze.trials import trials
from experiments.shared.experiment import Result
from experiments.shared.figures import Rates, captioned, rates
from experiments.shared.kept import once
from experiments.shared.progress import Report
from experiments.shared.tables import table
from models.maze import Maze

SEEDS = 150
WALKS = 200  # unseen walks per goal
CURVE_STEPS, CURVE_WALKERS = 100_000, 100
SELECTIONS = ("map", "matching")
IN_TABLES = ("trials_curves", "changes", "intent_by_share", "junctions")
CAPTIONS = {
    "trials": "Share of runs that reach the goal within three times the least steps, by the steps that each method "
    "made itself before, as found in these runs. Imitators were shown walks; the others were told the goal's place.",
    "changes": "The same after the maze changed, by own steps in it as it is now. All had made as many steps in the "
    "maze as it was.",
    "intent_early": "How often the goal of an unseen walk was named rightly after part of it, by rule, with exact 95 % "
    "intervals over observers and walks.",
}


def study(maze: Maze, seed: int, demonstrations: int, wander_steps: int, smoothing: float, report: Report) -> Result:
    """All claims; `report` is told the fraction done."""
    curve = once(_curve, maze, seed, report=lambda done: report(0.15 * done))
    metrics: dict[str, Any] = {
        f"forward_model_{name}": {str(n): y for n, y in zip(curve.steps, values, strict=True) if n >= 300}
        for name, values in (("tv", curve.tv), ("tv_bound", curve.bound), ("tv_band_95", curve.band.T))
    }
    shown = maze, demonstrations, wander_steps
    metrics |= {"forward_model_tv_slope": curve.slope} | once(_imitation, *shown, seed)
    report(0.18)
    metrics |= once(_intents, *shown, seed + 1, smoothing, report=lambda done: report(0.18 + 0.07 * done))
    metrics |= once(trials, maze, seed, demonstrations, report=lambda done: report(0.25 + 0.35 * done))
    metrics |= changes(maze, seed, demonstrations, lambda done: report(0.6 + 0.4 * done))
    in_time, own = "share of runs within 3 x the least steps", "own steps in the maze"
    by_goal = {
        f"goal {g}": {m: of[g] for m, of in metrics["trials_curves"].items()} for g in metrics["step_ratio"]["map"]
    }
    changed = {world: methods for world, methods in metrics["changes"].items() if methods}
    seen = {"unseen walks": metrics["intent_by_share"]}
    figures = {
        "trials": captioned(CAPTIONS["trials"])(rates)(by_goal, (own, in_time), ("reliable", RELIABLE), log=True),
        "changes": captioned(CAPTIONS["changes"])(rates)(changed, (f"{own} as it is now", in_time), log=True),
        "intent_early": captioned(CAPTIONS["intent_early"])(rates)(
            seen, ("share of the walk seen", "goal named rightly")
        ),
    }
    if len(curve.steps):
        figures["learning_curve_study"] = learning_curve(curve)
    summary = f"""
## Study

{table(((k.replace("_", " "), _said(v)) for k, v in metrics.items() if k not in IN_TABLES), ("what", "found"))}

What the demonstrations supply is the map: imitation needs few steps of its own because somebody else found the way.

## Own steps: share that then arrives in time

{_table(by_goal)}

## Where the maze changes: own steps in it, share that then arrives in time, 95 % interval

All have made {OWN_STEPS} own steps in the maze as it was; planners were told the goal's place, not the way.

{_table(changed)}

## Share of the walk seen, share of {metrics["intent_walks"]} goals named rightly, 95 % interval

{_table(seen)}
"""
    return Result(metrics, summary, figures)


def _curve(maze: Maze, seed: int, report: Report) -> Convergence:
    return walkers(maze, CURVE_STEPS, seed, CURVE_WALKERS, report)[1]


def _intents(
    maze: Maze, demonstrations: int, wander_steps: int, seed: int, smoothing: float, report: Report
) -> dict[str, Any]:
    return intents(population(maze, WALKS, demonstrations, wander_steps, seed), seed, smoothing, report)


def _imitation(maze: Maze, demonstrations: int, wander_steps: int, seed: int) -> dict[str, Any]:
    imitators = population(maze, SEEDS, demonstrations, wander_steps, seed)
    found: dict[str, Any] = defaultdict(lambda: {selection: {} for selection in SELECTIONS})
    teacher = {goal: imitators.teacher_steps(goal) for goal in range(1, len(imitators.maze.goals) + 1)}
    for selection, goal in product(SELECTIONS, teacher):
        journey, bare = (
            imitators.imitate(goal, selection, np.random.default_rng([seed, 23, goal]), prior=prior)
            for prior in (True, False)
        )
        for name, value in {
            "imitation_success": journey.reached.mean(),
            "step_ratio": journey.steps.mean() / teacher[goal],
            "uninformed_steps": journey.decisions.forward_alone.sum(0).mean(),
            "step_ratio_without_prior": bare.steps.mean() / teacher[goal],
        }.items():
            found[name][selection][str(goal)] = float(value)
    return {**found, "imitation_seeds": imitators.body.copies, "teacher_steps": teacher}


def _said(found: Any) -> str:
    if isinstance(found, Mapping):
        return ", ".join(
            f"{k} ({_said(v)})" if isinstance(v, Mapping) else f"{k}: {_said(v)}" for k, v in found.items()
        )
    if isinstance(found, np.ndarray | list | tuple):
        return " to ".join(f"{one:.4g}" for one in found)
    return "-" if found is None else f"{found:.4g}"


def _table(panels: Rates) -> str:
    """See `Rates`."""
    rows = []
    for panel, methods in panels.items():
        for method, curve in methods.items():
            at, share, interval = (*curve.values(), None)[:3]
            bounds = [""] * len(at) if interval is None else [f" ({low:.2f} to {high:.2f})" for low, high in interval]
            points = (f"{x:.4g}: {y:.3f}{told}" for x, y, told in zip(at, share, bounds, strict=True))
            rows.append((f"{panel}: {method}", "; ".join(points)))
    return table(rows, ("who", "found"))
