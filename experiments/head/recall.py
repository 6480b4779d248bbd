"""Reproducing a remembered head movement; also as a process of its own, that has neither babbled nor watched.

`python -m experiments.head.recall MEMORY ROBOT SELECTION SEED RESULT` reads a memory (its mind.nc beside it) and leaves
the performed angles as an array.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from babbling.mind import Mind
from babbling.storage import load_mind
from experiments.errors import ExperimentError
from imitation.acting.loop import Witness, imitate
from imitation.acting.movement import Movement
from imitation.head_memory import HeadMemory, load_head_memory
from models.part import PartOfBody
from models.seeing_body import head_fingerprint, watching_body

FloatArray = NDArray[np.float64]


class Angles(Witness):
    """True angles of a head, for those who judge."""

    def __init__(self, body: PartOfBody) -> None:
        self.body = body

    def read(self) -> FloatArray:
        """(B, 2) rad."""
        return self.body.joint_angles


def reproduce(memory: HeadMemory, mind: Mind, robot: str, selection: str, seed: int) -> FloatArray:
    """(T, 2) true angles of the imitator while it performs what it remembers: the match-to-target loop with Eq. (1)."""
    memory.check(head_fingerprint(robot))
    body = watching_body(robot)
    senses = np.full((len(memory.pose), len(body.sense_low)), np.nan)
    low, high = mind.pilot.schema.efference(np.stack([body.motor_low, body.motor_high]))
    senses[:, mind.pilot.schema.posture] = np.clip(memory.pose, np.minimum(low, high), np.maximum(low, high))
    movement = Movement(memory.name, memory.tick_s, senses)
    rng = np.random.default_rng([seed, 0xDEF])
    attempt = imitate(body, movement, mind, selection=selection, rng=rng, witness=Angles(body))[0]
    return np.asarray(attempt.truth[:, 0])


def in_new_process(memory_file: Path, robot: str, selection: str, seed: int) -> FloatArray:
    """Imitate from a memory in a process of its own.

    Raises:
        ExperimentError: the process failed; its last line is told.
    """
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "angles.npy"
        command = [sys.executable, "-m", "experiments.head.recall", str(memory_file), robot, selection, str(seed)]
        done = subprocess.run(
            [*command, str(result)], capture_output=True, text=True, cwd=Path(__file__).resolve().parents[2]
        )
        if done.returncode:
            raise ExperimentError(
                f"deferred imitation failed: {(done.stderr.strip() or 'no reason given').splitlines()[-1]}"
            )
        return np.asarray(np.load(result, allow_pickle=False))


def main(arguments: list[str]) -> None:
    """See the module."""
    memory_file, robot, selection, seed, result = arguments
    mind, _ = load_mind(Path(memory_file).with_name("mind.nc"))
    angles = reproduce(load_head_memory(Path(memory_file)), mind, robot, selection, int(seed))
    np.save(result, angles)


if __name__ == "__main__":
    main(sys.argv[1:])
