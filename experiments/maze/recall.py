"""Deferred imitation: a process that has neither wandered nor watched imitates from a memory file.

`python -m experiments.maze.recall MEMORY ORDER JOURNEY` reads a memory and an order (JSON: the maze's drawing, goal,
selection, seed) and leaves the journey as arrays.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from experiments.errors import ExperimentError
from experiments.maze.mind import Experience, imitate, wanderer
from imitation.acting.follow import Decisions, Journey
from imitation.deferred import load_memory
from models.maze import Maze, MazeBody, draw, parse_maze


def recall(memory_file: Path, maze: Maze) -> Experience:
    """Experience out of a memory file.

    Raises:
        BabblingError: a file that is no memory, or one of another maze.
    """
    memory = load_memory(memory_file, goals=len(maze.goals), states=maze.cells)
    return Experience(maze, memory.recall_onto(wanderer(MazeBody(maze)).forward_model()), memory.episodes)


def in_new_process(memory_file: Path, maze: Maze, goal: int, selection: str, seed: int) -> Journey:
    """Imitate from a memory in a process of its own.

    Raises:
        ExperimentError: the process failed; its last line is told.
    """
    with tempfile.TemporaryDirectory() as folder:
        order, result = Path(folder) / "order.json", Path(folder) / "journey.npz"
        order.write_text(json.dumps({"maze": draw(maze), "goal": goal, "selection": selection, "seed": seed}))
        command = [sys.executable, "-m", "experiments.maze.recall", str(memory_file), str(order), str(result)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).resolve().parents[2])
        if done.returncode:
            raise ExperimentError(
                f"deferred imitation failed: {(done.stderr.strip() or 'no reason given').splitlines()[-1]}"
            )
        with np.load(result, allow_pickle=False) as stored:
            decisions = Decisions._make(stored[name] for name in Decisions._fields)
            return Journey(stored["states"], decisions, stored["steps"], stored["reached"])


def main(arguments: list[str]) -> None:
    """See the module."""
    memory_file, order_file, result = map(Path, arguments)
    order = json.loads(order_file.read_text())
    experience = recall(memory_file, parse_maze(order["maze"]))
    journey = imitate(experience, order["goal"], order["selection"], order["seed"])
    np.savez(result, states=journey.states, steps=journey.steps, reached=journey.reached, **journey.decisions._asdict())


if __name__ == "__main__":
    main(sys.argv[1:])
