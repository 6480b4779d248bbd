"""`imitate maze --study`: the chapter's claims of section 3.3 over many seeds, as numbers and two figures."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from experiments.maze.figures import learning_curve, trials_figure
from experiments.maze.learning import walkers
from experiments.maze.mind import Imitators, infer, junctions, step_likelihood, watched
from experiments.maze.planners import PATIENCE, Q_SETTINGS, RELIABLE
from experiments.maze.trials import trials
from experiments.shared.progress import Report
from experiments.shared.tables import table
from imitation.acting.follow import believed
from models.maze import Maze, MazeBody, demonstrate

SEEDS = 150
WALKS = 200  # unseen walks per goal
CURVE_STEPS, CURVE_WALKERS = 100_000, 100
SELECTIONS = ("map", "matching")


@dataclass(frozen=True)
class Study:
    """What the study found."""

    metrics: dict[str, Any]
    figures: dict[str, Figure]
    summary: str


def study(maze: Maze, seed: int, demonstrations: int, wander_steps: int, smoothing: float, report: Report) -> Study:
    """All claims; `report` is told the fraction done."""
    _, curve = walkers(maze, CURVE_STEPS, seed, CURVE_WALKERS, lambda done: report(0.15 * done))
    kept = [i for i, n in enumerate(curve.steps) if n >= 300]
    metrics: dict[str, Any] = {
        "forward_model_tv": {str(curve.steps[i]): curve.tv[i] for i in kept},
        "forward_model_tv_bound": {str(curve.steps[i]): curve.bound[i] for i in kept},
        "forward_model_tv_slope": curve.slope,
        "forward_model_untried_rows": {str(curve.steps[i]): curve.untried[i] for i in kept},
        "forward_model_walkers": CURVE_WALKERS,
    }
    imitators = Imitators(maze, SEEDS, demonstrations, wander_steps, seed)
    metrics |= _imitation(imitators)
    report(0.18)
    observers = Imitators(maze, WALKS, demonstrations, wander_steps, seed + 1)
    metrics |= _intent(observers, smoothing, lambda done: report(0.18 + 0.07 * done))
    found, curves = trials(maze, seed, demonstrations, lambda done: report(0.25 + 0.75 * done))
    metrics |= found
    figures = {"trials": trials_figure(curves, RELIABLE)}
    if curve.steps:
        figures["learning_curve_study"] = learning_curve(curve)
    return Study(metrics, figures, _summary(metrics))


def _imitation(imitators: Imitators) -> dict[str, Any]:
    maze = imitators.maze
    goals = range(1, len(maze.goals) + 1)
    names = ("imitation_success", "step_ratio", "uninformed_steps", "uninformed_episodes", "chance_steps",
             "step_ratio_without_prior")  # fmt: skip
    found: dict[str, dict[str, dict[str, float]]] = {name: {s: {} for s in SELECTIONS} for name in names}
    for selection in SELECTIONS:
        for goal in goals:
            teacher = imitators.teacher_steps(goal)
            journey = imitators.journeys(goal, selection, int(20 * teacher))
            alone = journey.decisions.forward_alone.sum(0)
            bare = imitators.journeys(goal, selection, int(20 * teacher), prior=False)
            values = (journey.reached.mean(), journey.steps.mean() / teacher, alone.mean(), (alone > 0).mean(),
                      journey.decisions.chance.sum(), bare.steps.mean() / teacher)  # fmt: skip
            for name, value in zip(names, values, strict=True):
                found[name][selection][str(goal)] = float(value)
    return {**found, "imitation_seeds": imitators.copies,
            "teacher_steps": {str(goal): imitators.teacher_steps(goal) for goal in goals}}  # fmt: skip


def _intent(observers: Imitators, smoothing: float, report: Report) -> dict[str, Any]:
    """Each observer judges one unseen walk to each goal; the goal prior is uniform, as the walks are balanced."""
    maze, goals = observers.maze, len(observers.maze.goals)
    body = MazeBody(maze, copies=observers.copies, seed=(observers.seed, 24))
    even, uneven = np.full(goals, 1 / goals), np.full(goals, 0.5 / max(goals - 1, 1))
    uneven[0] = 0.5 if goals > 1 else 1.0
    crossing, tables = junctions(maze), believed(observers.forward_model)
    rows: dict[str, list[float]] = {}
    entropy: dict[str, list[float]] = {}

    def note(name: str, value: float) -> None:
        rows.setdefault(name, []).append(value)

    for goal in range(goals):
        walks = demonstrate(body, goal + 1, np.random.default_rng([observers.seed, 25, goal]))
        for k, (walk, priors) in enumerate(zip(walks, observers.priors, strict=True)):
            episode = watched(walk, maze)
            likelihood = step_likelihood(maze, tables[k], episode)
            at_junction = np.isin(episode.states[:-1], crossing)
            for label, goal_prior in (("", even), ("_uneven_prior", uneven)):
                seen = infer(priors, episode, goal_prior, smoothing)
                places_alone = infer(priors, episode, goal_prior, smoothing, likelihood)
                for name, belief in (
                    ("filter", seen.filtered),
                    ("filter_plain", seen.filtered_plain),
                    ("step", seen.by_step),
                    ("unseen_filter", places_alone.filtered),
                    ("unseen_step", places_alone.by_step),
                ):
                    right = belief.probability.argmax(1) == goal
                    note(f"intent_{name}_accuracy{label}", float(right.mean() if name.endswith("step") else right[-1]))
                    note(f"intent_{name}_log_loss{label}", float(-np.log2(belief.probability[:, goal]).mean()))
                    note(f"intent_{name}_uninformed_steps{label}", belief.uninformed_steps)
                    if name == "step":
                        note(f"intent_step_end_accuracy{label}", float(right[-1]))
                        own = seen.by_step.entropy[at_junction].tolist()
                        entropy.setdefault("uniform" if not label else "uneven", []).extend(own)
                        if goal == 0:
                            entropy.setdefault("uniform_goal_1" if not label else "uneven_goal_1", []).extend(own)
            report((goal + (k + 1) / len(walks)) / goals)
    means = {name: float(np.mean(values)) for name, values in rows.items()}
    return {
        **means,
        "intent_walks": goals * observers.copies,
        "junctions": [maze.place(cell) for cell in crossing],
        "junction_entropy_bits": {name: float(np.mean(v)) if v else None for name, v in entropy.items()},
    }


def _summary(metrics: dict[str, Any]) -> str:
    def of(name: str, form: str = "{:.2f}") -> str:
        return " / ".join("-" if v is None else form.format(v) for v in metrics[name].values())

    def both(name: str) -> str:
        return "; ".join(f"{s} " + " / ".join(f"{v:.2f}" for v in goals.values()) for s, goals in metrics[name].items())

    entropy, slope = metrics["junction_entropy_bits"], metrics["forward_model_tv_slope"]
    losses = [metrics[f"intent_{rule}_log_loss"] for rule in ("filter", "step", "filter_plain")]
    claims = {
        f"total variation of learned rows at {' / '.join(metrics['forward_model_tv'])} steps": of(
            "forward_model_tv", "{:.4f}"
        ),
        "multinomial bound": of("forward_model_tv_bound", "{:.4f}"),
        "slope against counted visits": "-" if slope is None else f"{slope:.3f}",
        f"imitation succeeds, {metrics['imitation_seeds']} seeds": both("imitation_success"),
        "steps / teacher's steps": both("step_ratio"),
        "the same without the learned prior": both("step_ratio_without_prior"),
        "steps per imitation where Eq. (1) is 0/0": both("uninformed_steps"),
        f"intent, filter right at the end, share of {metrics['intent_walks']} walks": "{:.4f}".format(
            metrics["intent_filter_accuracy"]
        ),
        "the same, actions unseen": "{:.4f}".format(metrics["intent_unseen_filter_accuracy"]),
        "right steps by Eq. (2) step by step, actions seen, unseen": "{:.3f}, {:.3f}".format(
            metrics["intent_step_accuracy"], metrics["intent_unseen_step_accuracy"]
        ),
        "mean log-loss: filter, Eq. (2) step by step, filter that never doubts": "{:.3f}, {:.3f}, {:.3f} bit".format(
            *losses
        ),
        "entropy at junctions on walks to goal 1, goal prior uniform, half for goal 1": "-"
        if None in entropy.values()
        else f"{entropy['uniform_goal_1']:.3f}, {entropy['uneven_goal_1']:.3f} bit",
        f"own steps until {100 * RELIABLE:.0f} % arrive within {PATIENCE:g} x the least: imitation": of(
            "trials_imitation", "{}"
        ),
        "steps observed for it": of("trials_imitation_observed_steps", "{:.0f}"),
        "value iteration, walls known": of("trials_value_iteration", "{}"),
        "value iteration, walls found by replanning": of("trials_value_iteration_replanning", "{}"),
        "value iteration, walls found by wandering": of("trials_value_iteration_discovered_walls", "{}"),
        f"Q-learning, best of {len(Q_SETTINGS)} settings": of("trials_q_learning", "{}"),
    }
    return f"""
## Study (numbers per goal: 1 / 2 / ...)

{table(claims.items(), ("claim", "found"))}

What the demonstrations supply is the map: imitation needs few steps of its own because somebody else found the way.
"""
