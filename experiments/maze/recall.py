"""Deferred imitation: a process that has neither wandered nor watched imitates from a memory file.

`python -m experiments.maze.recall FOLDER GOAL SELECTION SEED` reads memory.nc and maze.txt in a folder and leaves the
journey there as arrays.
"""

import sys
from functools import partial
from pathlib import Path

import numpy as np

from babbling.files import load, save
from experiments.maze.mind import IMITATING, Experience, wanderer
from experiments.shared.fresh_process import RESULT, Files, in_new_process
from imitation.acting.follow import Decisions, Journey
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
    """Imitate from a memory in a process of its own.

    Raises:
        ExperimentError: the process failed; its last line is told.
    """
    files: Files = {"memory.nc": partial(save, memory), "maze.txt": lambda path: path.write_text(draw(maze))}
    left = in_new_process(__name__, files, goal, selection, seed)
    decisions = Decisions._make(left[name] for name in Decisions._fields)
    return Journey(left["states"], decisions, left["steps"], left["reached"])


def main(words: list[str]) -> None:
    """See the module."""
    folder, goal, selection, seed = Path(words[0]), int(words[1]), words[2], int(words[3])
    experience = recall(folder / "memory.nc", read_maze(folder / "maze.txt"), seed)
    journey = experience.imitate(goal, selection, np.random.default_rng([seed, IMITATING]))
    decisions = journey.decisions._asdict()
    np.savez(folder / RESULT, states=journey.states, steps=journey.steps, reached=journey.reached, **decisions)


if __name__ == "__main__":
    main(sys.argv[1:])
