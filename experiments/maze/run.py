"""The chapter's maze (section 3.3): wander, watch, imitate, infer intent, with its figures 5, 6 and 7.

The same forward model, Eq. (1) and Eq. (2) as for every other body; the maze is one more.
"""

import numpy as np

from babbling.axes import Axis, FloatArray
from babbling.files import save
from experiments.errors import ExperimentError
from experiments.maze import mind
from experiments.maze.figures import figures
from experiments.maze.found import Found, summary
from experiments.maze.learning import Convergence, walkers
from experiments.maze.mind import IMITATING, UNSEEN, Experience
from experiments.maze.options import Config
from experiments.maze.recall import imitate_elsewhere, recall
from experiments.maze.recording import record
from experiments.maze.study import study
from experiments.shared.experiment import Result
from experiments.shared.progress import progress
from imitation.acting.follow import believed
from imitation.deferred import StepMemory
from imitation.inference.priors import check_goal_prior, check_smoothing
from imitation.inference.selection import selection_rule
from models.maze import ACTIONS, Maze, MazeBody, Walk, check_walk, default_maze, demonstrate, read_maze
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
    experience, curve = _experience(config, maze)
    walks = [mind.walked(episode, maze) for episode in experience.episodes[0]]
    for number, walk in enumerate(walks, 1):
        check_walk(maze, walk, f"{config.memory}, walk {number}")
    for goal in range(1, len(maze.goals) + 1):
        if not any(walk.goal == goal for walk in walks):
            raise ExperimentError(f"nobody was watched going to goal {goal}; every goal needs a demonstration")
    memory = StepMemory(experience.forward_model, experience.episodes[0])
    if config.deferred:
        journey = imitate_elsewhere(memory, maze, config.goal, config.selection, config.seed)
    else:
        journey = experience.imitate(config.goal, config.selection, np.random.default_rng([config.seed, IMITATING]))
    unseen = unseen_walk(maze, config.seed)
    episode, learned, (priors,) = mind.watched(unseen, maze), believed(experience.forward_model)[0], experience.priors
    sights = {"seen": None, "unseen": mind.step_likelihood(maze, learned, episode)}
    beliefs, even = (
        {name: mind.infer(priors, episode, prior, config.smoothing, likelihood) for name, likelihood in sights.items()}
        for prior in (goal_prior, np.full(len(maze.goals), 1 / len(maze.goals)))
    )
    done = Found(config, experience, walks, curve, journey, unseen, goal_prior, beliefs, even)
    metrics, drawn = done.metrics(), figures(done)
    told = summary(config, metrics)
    if config.study:
        with progress("study") as report:
            claims = study(maze, config.seed, config.demonstrations, config.wander_steps, config.smoothing, report)
        metrics |= claims.metrics
        drawn |= claims.figures
        told += claims.summary
    files = {
        "memory.nc": lambda path: save(memory, path),
        "demonstrations.csv": lambda path: write_walks(walks, path),
        "unseen_walk.csv": lambda path: write_walks([unseen], path),
    }
    return Result(metrics, told, drawn, lambda path: record(path, done, told, drawn), files)


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
    if not config.goal_prior:
        return mind.half_for_the_first(len(maze.goals))
    try:
        given = [float(word) for word in config.goal_prior.split(",")]
    except ValueError:
        raise ExperimentError(f"--goal-prior {config.goal_prior}: give numbers with commas, 0.5,0.25,0.25") from None
    return check_goal_prior(given, len(maze.goals))


def _experience(config: Config, maze: Maze) -> tuple[Experience, Convergence | None]:
    """Wander and watch, or remember."""
    if config.memory is not None:
        return recall(config.memory, maze, config.seed), None
    watch = config.watch
    walks = mind.teach(maze, config.demonstrations, config.seed) if watch is None else read_walks(watch, maze)
    with progress("wandering") as report:
        forward_model, curve = walkers(maze, config.wander_steps, config.seed, 1, report)
    episodes = tuple(mind.watched(walk, maze) for walk in walks)
    return Experience(MazeBody(maze, seed=[config.seed, IMITATING]), forward_model, (episodes,)), curve


def unseen_walk(maze: Maze, seed: int) -> Walk:
    """The first of the teacher's further walks to goal 1 that takes 85 steps; where none does, the first."""
    body = MazeBody(maze, copies=500, seed=[seed, UNSEEN])
    walks = demonstrate(body, UNSEEN_GOAL, np.random.default_rng([seed, UNSEEN]))
    return next((walk for walk in walks if walk.steps == UNSEEN_STEPS), walks[0])
