"""The chapter's maze (section 3.3): wander, watch, imitate, infer intent, with its figures 5, 6 and 7.

The same forward model, Eq. (1) and Eq. (2) as for every other body; the maze is one more.
"""

from typing import Any

import numpy as np

from babbling.axes import Axis, FloatArray
from babbling.files import save
from experiments.errors import ExperimentError
from experiments.maze.figures import BLOCK, figures
from experiments.maze.found import Found
from experiments.maze.learning import Convergence, walkers
from experiments.maze.mind import (
    UNSEEN,
    Experience,
    imitate,
    infer,
    step_likelihood,
    teach,
    walked,
    watched,
)
from experiments.maze.options import SEEING, Config
from experiments.maze.recall import imitate_elsewhere, recall
from experiments.maze.recording import record
from experiments.maze.study import study
from experiments.shared.experiment import Result
from experiments.shared.progress import progress
from experiments.shared.tables import table
from imitation.acting.follow import believed
from imitation.deferred import StepMemory
from imitation.inference.intent import in_blocks
from imitation.inference.priors import check_goal_prior, check_smoothing
from imitation.inference.selection import selection_rule
from models.maze import ACTIONS, TRUE_DYNAMICS, Maze, MazeBody, Walk, check_walk, default_maze, demonstrate, read_maze
from models.maze.teacher import goal_place
from models.maze.walk_file import read_walks, write_walks

UNSEEN_STEPS = 85
"""Length of the chapter's unseen walk."""
UNSEEN_GOAL = 1
MOST_STUDIED_CELLS = 2500


def run(config: Config) -> Result:
    """Wander, watch, imitate, infer; see the module.

    Raises:
        BabblingError: options, a memory or a prior that cannot be used.
        BodyError: a maze or a walk that cannot be used.
    """
    config.check()
    maze = default_maze() if config.maze is None else read_maze(config.maze)
    goal_prior = _check(config, maze)
    experience, walks, curve = _experience(config, maze)
    missing = [g for g in range(1, len(maze.goals) + 1) if not experience.towards(g)]
    if missing:
        raise ExperimentError(f"nobody was watched going to goal {missing[0]}; every goal needs a demonstration")
    memory = StepMemory(experience.forward_model, experience.episodes)
    if config.deferred:
        journey = imitate_elsewhere(memory, maze, config.goal, config.selection, config.seed)
    else:
        journey = imitate(experience, config.goal, config.selection, config.seed)
    unseen = unseen_walk(maze, config.seed)
    episode = watched(unseen, maze)
    likelihood = step_likelihood(maze, believed(experience.forward_model)[0], episode)
    inferred, even = (
        {
            name: infer(experience.priors, episode, prior, config.smoothing, given)
            for name, given in zip(SEEING, (None, likelihood), strict=True)
        }
        for prior in (goal_prior, np.full(len(maze.goals), 1 / len(maze.goals)))
    )
    done = Found(config, experience, walks, curve, journey, unseen, goal_prior, inferred, even)
    metrics, drawn = _metrics(done), figures(done)
    summary = _summary(config, metrics)
    if config.study:
        with progress("study") as report:
            found = study(maze, config.seed, config.demonstrations, config.wander_steps, config.smoothing, report)
        metrics |= found.metrics
        drawn |= found.figures
        summary += found.summary
    files = {
        "memory.nc": lambda path: save(memory, path),
        "demonstrations.csv": lambda path: write_walks(walks, path),
        "unseen_walk.csv": lambda path: write_walks([unseen], path),
    }
    return Result(metrics, summary, drawn, lambda path: record(path, done, summary, drawn), files)


def _check(config: Config, maze: Maze) -> FloatArray:
    """Refuse options that cannot be meant; returns the goal prior."""
    if config.study and maze.cells > MOST_STUDIED_CELLS:
        raise ExperimentError(
            f"--study: a maze of {maze.cells} cells; hundreds of learners fit into at most {MOST_STUDIED_CELLS}"
        )
    goal_place(maze, config.goal)
    check_smoothing(config.smoothing)
    five = np.full((1, len(ACTIONS)), 1 / len(ACTIONS))  # a rule that refuses categories should do so before the work
    selection_rule(config.selection)(five, Axis.categorical("action", ACTIONS), np.random.default_rng(0))
    goals = len(maze.goals)
    if not config.goal_prior:
        return np.array([1.0]) if goals == 1 else np.array([0.5] + [0.5 / (goals - 1)] * (goals - 1))
    try:
        given = [float(word) for word in config.goal_prior.split(",")]
    except ValueError:
        raise ExperimentError(f"--goal-prior {config.goal_prior}: give numbers with commas, 0.5,0.25,0.25") from None
    return check_goal_prior(given, goals)


def _experience(config: Config, maze: Maze) -> tuple[Experience, list[Walk], Convergence | None]:
    """Wander and watch, or remember."""
    if config.memory is not None:
        experience = recall(config.memory, maze)
        walks = [walked(episode, maze) for episode in experience.episodes]
        for number, walk in enumerate(walks, 1):
            check_walk(maze, walk, f"{config.memory}, walk {number}")
        return experience, walks, None
    if config.watch is not None:
        walks = read_walks(config.watch, maze)
    else:
        walks = teach(maze, config.demonstrations, config.seed)
    with progress("wandering") as report:
        forward_model, curve = walkers(maze, config.wander_steps, config.seed, 1, report)
    return Experience(maze, forward_model, tuple(watched(walk, maze) for walk in walks)), walks, curve


def unseen_walk(maze: Maze, seed: int) -> Walk:
    """The first of the teacher's further walks to goal 1 that takes 85 steps; where none does, the first."""
    body = MazeBody(maze, copies=500, seed=[seed, UNSEEN])
    walks = demonstrate(body, UNSEEN_GOAL, np.random.default_rng([seed, UNSEEN]))
    return next((walk for walk in walks if walk.steps == UNSEEN_STEPS), walks[0])


def _metrics(done: Found) -> dict[str, Any]:
    maze, model, config, journey, inferred = (
        done.maze, done.experience.forward_model, done.config, done.journey, done.inferred
    )  # fmt: skip
    decisions, even, curve = journey.decisions, done.even[config.actions], done.curve
    teacher = float(np.mean([walk.steps for walk in done.walks if walk.goal == config.goal]))
    true_goal = UNSEEN_GOAL - 1
    return {
        "maze": {
            "width": maze.width,
            "height": maze.height,
            "goals": maze.goals,
            "fingerprint": maze.fingerprint,
        },
        "forward_model": {
            "counted_transitions": model.transitions,
            "uniform": model.transitions == 0,
            "cells_away_from_walls": int((maze.walls.sum(-1) == 0).sum()),
            "untried_actions": int((model.visits == 0).sum()),
            "table": done.table,
            "truth": TRUE_DYNAMICS,
            "total_variation": float(np.abs(done.table - TRUE_DYNAMICS).sum(-1).mean() / 2),
        },
        "learning_curve": None
        if curve is None
        else {"steps": curve.steps, "forward_model_tv": curve.tv, "forward_model_tv_bound": curve.bound},
        "imitation": {
            "goal": config.goal,
            "selection": config.selection,
            "reached": bool(journey.reached[0]),
            "steps": int(journey.steps[0]),
            "teacher_steps": teacher,
            "step_ratio": float(journey.steps[0] / teacher),
            "forward_model_alone_steps": int(decisions.forward_alone.sum()),
            "chance_steps": int(decisions.chance.sum()),
            "backtracking_steps": int(decisions.backtracking.sum()),
            "states": journey.states[:, 0],
        },
        "intent": {
            "goal": UNSEEN_GOAL,
            "steps": len(inferred.by_step.probability),
            "block": BLOCK,
            "blocks": in_blocks(inferred.by_step.probability, BLOCK),
            "blocks_uniform_goal_prior": in_blocks(even.by_step.probability, BLOCK),
            "filter_blocks": in_blocks(inferred.filtered.probability, BLOCK),
            "filter_end": inferred.filtered.probability[-1],
            "filter_right_at_the_end": bool(inferred.filtered.probability[-1].argmax() == true_goal),
            "right_steps": float((inferred.by_step.probability.argmax(1) == true_goal).mean()),
            "uninformed_steps": inferred.by_step.uninformed_steps,
            "filter_uninformed_steps": inferred.filtered.uninformed_steps,
            "actions": config.actions,
            "by_actions": {
                name: {
                    "right_steps": float((one.by_step.probability.argmax(1) == true_goal).mean()),
                    "filter_end": one.filtered.probability[-1],
                }
                for name, one in done.beliefs.items()
            },
        },
    }


def _summary(config: Config, metrics: dict[str, Any]) -> str:
    learned, imitation, intent = metrics["forward_model"], metrics["imitation"], metrics["intent"]
    if config.memory is not None:
        source = f"recalled from {config.memory.name}"
    else:
        source = f"{config.wander_steps} random steps"
    if learned["uniform"]:
        free = "" if learned["cells_away_from_walls"] else " (no cell of this maze is away from walls)"
        verdict = f"**nothing was counted{free}: the forward model is uniform, it knows no action from another**"
    else:
        verdict = (
            f"{learned['counted_transitions']} transitions counted away from walls; "
            f"total variation from the truth {learned['total_variation']:.4f}"
        )
        if learned["untried_actions"]:
            verdict += f"; {learned['untried_actions']} actions never tried there: taken as uniform"
    arrived = "reached" if imitation["reached"] else "**not reached**"
    belief = ", ".join(f"{p:.3f}" for p in intent["filter_end"])
    steps = f"{arrived} in {imitation['steps']} steps; the teacher took {imitation['teacher_steps']:.1f}"
    events = (
        f"Eq. (1) was 0/0 and the forward model decided alone: {imitation['forward_model_alone_steps']}; "
        f"chance: {imitation['chance_steps']}; backtracking: {imitation['backtracking_steps']}"
    )
    right = (
        f"right in {100 * intent['right_steps']:.0f} % of steps judged one by one "
        f"({intent['uninformed_steps']} were 0/0); the filter ends at {belief}"
    )
    other = next(name for name in SEEING if name != config.actions)
    beside = intent["by_actions"][other]
    likewise = (
        f"right in {100 * beside['right_steps']:.0f} % of steps; the filter ends at "
        f"{', '.join(f'{p:.3f}' for p in beside['filter_end'])}"
    )
    rows = [
        ("forward model", f"{source}: {verdict}"),
        (
            f"imitation of goal {imitation['goal']}, {imitation['selection']}",
            f"{steps} (ratio {imitation['step_ratio']:.2f})",
        ),
        ("events on the way", events),
        (f"intent, unseen walk of {intent['steps']} steps to goal {intent['goal']}, actions {config.actions}", right),
        (f"the same with actions {other}", likewise),
    ]
    return f"# Maze: wander, watch, imitate, infer\n\n{table(rows, ('', ''))}\n"
