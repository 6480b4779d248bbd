"""`imitate maze --study`: the chapter's claims of section 3.3 over many seeds, as numbers and two figures."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from babbling.axes import FloatArray, IntArray
from babbling.loop import babble
from babbling.moves import Wanderer
from experiments.maze_figures import learning_curve, trials_figure
from experiments.maze_learning import outings, walkers
from experiments.maze_mind import infer, junctions, watched
from experiments.maze_planners import (
    PATIENCE,
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
from imitation.episodes import Episode
from imitation.follow import Journey, follow
from imitation.priors import ActionPriors
from imitation.subgoals import acyclic_subgoals
from models.maze import ACTIONS, TRUE_DYNAMICS, Maze, MazeBody, demonstrate

SEEDS = 150
WALKS = 200  # unseen walks per goal
CURVE_STEPS, CURVE_WALKERS = 100_000, 100
SELECTIONS = ("map", "matching")
LEARNERS, EPISODES = 30, 10
IMITATION_BUDGETS = (25, 50, 100, 200, 300, 500, 700, 1000)
WANDER_BUDGETS = (*IMITATION_BUDGETS, 2000, 3000, 5000, 7000, 10_000, 20_000, 30_000, 50_000, 70_000, 100_000, 200_000)
REPLAN_BUDGETS = (300, 500, 700, 1000, 1500, 2000, 3000)
Q_BUDGETS = (10_000, 20_000, 30_000, 50_000, 70_000, 100_000, 150_000, 200_000, 300_000, 400_000)

NEVER: dict[str, list[float]] = {"steps": [], "share": []}

Report = Callable[[float], None]


@dataclass(frozen=True)
class Study:
    """What the study found."""

    metrics: dict[str, Any]
    figures: dict[str, Figure]
    summary: str


class Imitators:
    """Many imitators at once, one per copy of the body: each has wandered and watched for itself."""

    def __init__(self, maze: Maze, copies: int, demonstrations: int, wander_steps: int, seed: int) -> None:
        self.maze, self.copies, self.seed = maze, copies, seed
        self.body = MazeBody(maze, copies=copies, seed=(seed, 21))
        self.episodes: list[list[Episode]] = [[] for _ in range(copies)]
        for goal in range(1, len(maze.goals) + 1):
            for k in range(demonstrations):
                walks = demonstrate(self.body, goal, np.random.default_rng([seed, 22, goal, k]))
                for own, walk in zip(self.episodes, walks, strict=True):
                    own.append(watched(walk, maze))
        self.priors = [ActionPriors.learned(e, len(maze.goals), maze.cells, len(ACTIONS)) for e in self.episodes]
        self.forward_model = babble(self.body, Wanderer(self.body, ACTIONS, alone=True), outings(wander_steps), seed)

    def teacher_steps(self, goal: int) -> float:
        """Mean steps of what was watched."""
        return float(np.mean([e.steps for own in self.episodes for e in own if e.goal == goal - 1]))

    def journeys(self, goal: int, selection: str, limit: int, *, prior: bool = True) -> Journey:
        """All imitate one goal."""
        mine = [[e for e in own if e.goal == goal - 1] for own in self.episodes]
        successor = np.array([acyclic_subgoals(own, self.maze.cells).successor for own in mine])
        priors = np.array([p.action()[goal - 1] for p in self.priors]) if prior else None
        end = self.maze.number(self.maze.goals[goal - 1])
        rng = np.random.default_rng([self.seed, 23, goal])
        return follow(self.body, self.forward_model, successor, end, priors, selection=selection, rng=rng, limit=limit)


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
    observers = Imitators(maze, WALKS, demonstrations, 0, seed + 1)
    metrics |= _intent(observers, smoothing, lambda done: report(0.18 + 0.07 * done))
    trials, curves = _trials(maze, seed, demonstrations, lambda done: report(0.25 + 0.75 * done))
    metrics |= trials
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
    crossing = junctions(maze)
    rows: dict[str, list[float]] = {}
    entropy: dict[str, list[float]] = {}

    def note(name: str, value: float) -> None:
        rows.setdefault(name, []).append(value)

    for goal in range(goals):
        walks = demonstrate(body, goal + 1, np.random.default_rng([observers.seed, 25, goal]))
        for k, (walk, priors) in enumerate(zip(walks, observers.priors, strict=True)):
            episode = watched(walk, maze)
            at_junction = np.isin(episode.states[:-1], crossing)
            for label, goal_prior in (("", even), ("_uneven_prior", uneven)):
                seen = infer(priors, episode, goal_prior, smoothing)
                for name, belief in (
                    ("filter", seen.filtered),
                    ("filter_plain", seen.filtered_plain),
                    ("step", seen.by_step),
                ):
                    right = belief.probability.argmax(1) == goal
                    note(f"intent_{name}_accuracy{label}", float(right.mean() if name == "step" else right[-1]))
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


def _trials(
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
    trials = {
        method: {str(goal): reliable_from(line) for goal, line in lines.items()} for method, lines in curves.items()
    }
    own = trials["imitation"]
    ratio = {
        g: None if own[g] is None or trials["Q-learning"][g] is None else trials["Q-learning"][g] / own[g] for g in own
    }
    return {
        "trials_imitation": own,
        "trials_imitation_observed_steps": {str(goal): float(np.mean([o[goal] for o in observed])) for goal in goals},
        "trials_value_iteration": trials["value iteration, walls known"],
        "trials_value_iteration_discovered_walls": trials["value iteration, walls discovered"],
        "trials_value_iteration_replanning": trials["value iteration, replanning"],
        "trials_q_learning": trials["Q-learning"],
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


def _summary(metrics: dict[str, Any]) -> str:
    def of(name: str, form: str = "{:.2f}") -> str:
        return " / ".join("-" if v is None else form.format(v) for v in metrics[name].values())

    def both(name: str) -> str:
        return "; ".join(f"{s} " + " / ".join(f"{v:.2f}" for v in goals.values()) for s, goals in metrics[name].items())

    entropy, slope = metrics["junction_entropy_bits"], metrics["forward_model_tv_slope"]
    losses = [metrics[f"intent_{rule}_log_loss"] for rule in ("filter", "step", "filter_plain")]
    table = {
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
    rows = "\n".join(f"| {claim} | {found} |" for claim, found in table.items())
    return f"""
## Study (numbers per goal: 1 / 2 / ...)

| claim | found |
|---|---|
{rows}

What the demonstrations supply is the map: imitation needs few steps of its own because somebody else found the way.
"""
