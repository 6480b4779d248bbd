"""A week later: another process, that has nothing but what was kept."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from babbling.files import load, save
from experiments.objects.deciding import Response, respond
from experiments.shared.children import Child, keep, meet
from experiments.shared.fresh_process import in_new_process
from imitation.deferred import ActMemory


def a_week_later(
    child: Child,
    memories: Sequence[ActMemory],
    toy: str,
    acts: int,
    selection: str,
    seed: int,
    first: int,
    *,
    keep_all: bool = False,
    further: float = 0.0,
) -> Response:
    """What N do who remember: a new process reads play and memories, and acts (see `respond`)."""
    files = {"play.nc": partial(keep, child)}
    files |= {f"memory{n}.nc": partial(save, memory) for n, memory in enumerate(memories)}
    return in_new_process(recalled, files, len(memories), toy, acts, selection, seed, first, keep_all, further)


def recalled(
    folder: Path, count: int, toy: str, acts: int, selection: str, seed: int, first: int, keep_all: bool, further: float
) -> Response:
    """What those who remember do."""
    child = meet(folder / "play.nc")
    memories = [load(folder / f"memory{n}.nc", ActMemory) for n in range(count)]
    for memory in memories:
        memory.check(child.play.fingerprint, len(child.play.outcomes.outcome.labels))
    goals = np.array([memory.states[-1] for memory in memories])
    rng = np.random.default_rng([seed, first])
    return respond(child, toy, goals, acts, selection, rng, first=first, keep=keep_all, further=further)
