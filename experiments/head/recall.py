"""Reproducing a remembered head movement; also in a process of its own, that has neither babbled nor watched."""

from functools import partial
from pathlib import Path

import numpy as np

from babbling.axes import FloatArray
from babbling.files import load, save
from babbling.mind import Mind
from experiments.shared.fresh_process import in_new_process
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement
from imitation.deferred import HeadMemory
from models.seeing_body import head_fingerprint, watching_body


def reproduce(
    memory: HeadMemory, mind: Mind, robot: str, selection: str, seed: int, scramble: int | None = None
) -> FloatArray:
    """(T, 2) true angles of the imitator while it performs what it remembers: the match-to-target loop with Eq. (1)."""
    memory.check(head_fingerprint(robot, scramble))
    body = watching_body(robot, scramble=scramble)
    senses = np.full((len(memory.pose), len(body.sense_low)), np.nan)
    low, high = mind.pilot.schema.efference(np.stack([body.motor_low, body.motor_high]))
    pose = memory.pose[:, np.argsort(body.wiring.motor)]  # by motor, as it was felt
    senses[:, mind.pilot.schema.posture] = np.clip(pose, np.minimum(low, high), np.maximum(low, high))
    movement = Movement(memory.name, memory.tick_s, senses)
    rng = np.random.default_rng([seed, 0xDEF])
    attempt = imitate(body, movement, mind, selection=selection, rng=rng, witness=lambda: body.joint_angles)[0]
    return np.asarray(attempt.truth[:, 0])


def reproduce_elsewhere(memory: HeadMemory, mind: Mind, *how: str | int | None) -> FloatArray:
    """The same in a process of its own; `how` is what else `reproduce` is told."""
    return in_new_process(_reproduce, {"memory.nc": partial(save, memory), "mind.nc": partial(save, mind)}, *how)


def _reproduce(folder: Path, robot: str, selection: str, seed: int, scramble: int | None) -> FloatArray:
    memory, mind = load(folder / "memory.nc", HeadMemory), load(folder / "mind.nc", Mind)
    return reproduce(memory, mind, robot, selection, seed, scramble)
