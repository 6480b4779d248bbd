"""Deferred imitation: a process that has neither wandered nor watched imitates from a memory file."""

from functools import partial
from pathlib import Path

import numpy as np

from babbling.files import load, save
from experiments.maze.mind import IMITATING, Experience, wanderer
from experiments.shared.fresh_process import Files, in_new_process
from imitation.acting.follow import Journey
from imitation.deferred import StepMemory
from models.maze import Maze, MazeBody, draw, read_maze


def recall(memory_file: Path, maze: Maze, seed: int) -> Experience:
    """Experience out of a memory file.

    Raises:
        BabblingError: a file that is no memory, or one of another maze.
    """
    memory = load(memory_file, StepMemory)
    body = MazeBody(maze, seed=[seed, IMITATING])
    memory.check(wanderer(body).forward_model())
    return Experience(body, memory.forward_model, (memory.episodes,))


def imitate_elsewhere(memory: StepMemory, maze: Maze, goal: int, selection: str, seed: int) -> Journey:
    """Imitate from a memory in a process of its own."""
    files: Files = {"memory.nc": partial(save, memory), "maze.txt": lambda path: path.write_text(draw(maze))}
    return in_new_process(_imitate, files, goal, selection, seed)


def _imitate(folder: Path, goal: int, selection: str, seed: int) -> Journey:
    experience = recall(folder / "memory.nc", read_maze(folder / "maze.txt"), seed)
    return experience.imitate(goal, selection, np.random.default_rng([seed, IMITATING]))
