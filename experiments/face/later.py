"""Imitation from memory: after a pacifier and a passive face, and a day later in a process that knows only files."""

import hashlib
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from babbling.axes import IntArray
from babbling.dark import FaceMind
from babbling.files import load, save
from experiments.face.answering import acted, understood
from experiments.face.infants import Group, Infant
from experiments.face.judging import labels
from experiments.face.watching import Look
from experiments.shared.fresh_process import in_new_process
from imitation.correspondence.own_acts import OwnActs
from imitation.deferred import FaceMemory

PASSIVE_ACTS: Final = 12
"""Acts of its own before a passive face for 2.5 minutes, .6 of 8 a minute (see `theories`)."""


class AfterPacifier(NamedTuple):
    """Of B memories."""

    stopped: IntArray
    """(B,) labels of tries with the pacifier in the mouth."""
    passive: float
    """Share of looks at the passive face in which nothing was seen to be done, so that the memory stays."""
    labels: IntArray
    """(B, K) labels of tries afterwards."""


def after_pacifier(
    group: Group, infants: Sequence[Infant], memories: Sequence[FaceMemory], passive: Sequence[Look], count: int
) -> AfterPacifier:
    """What infants do with what they remember: while their mouths are stopped, and after 2.5 minutes of a face that
    does nothing, during which they act by themselves."""
    minds = [infant.mind for infant in infants]
    share = len(memories) // len(infants)
    _, stopped = acted(group.body(len(memories), pacifier=True), minds, memories, 1)
    idle = []
    for infant in infants[:3]:  # what a look at rest says differs by look, hardly by infant
        acts = OwnActs(infant.mind)
        idle += [understood(acts, look.seen[-1], look.neutral)[1][0] > 0.5 for look in passive]
    body = group.body(len(memories))
    body.reset()
    for act in range(PASSIVE_ACTS):
        body.act(np.repeat(np.stack([infant.habits[act] for infant in infants]), share, axis=0))
    _, after = acted(body, minds, memories, count, reset=False)
    return AfterPacifier(labels(stopped[0]), sum(idle) / max(len(idle), 1), labels(after).T)


def after_day(group: Group, infants: Sequence[Infant], memories: Sequence[FaceMemory], count: int) -> IntArray:
    """(B, K) labels of tries in a process of its own that was given nothing but files; they are not changed by it."""
    files = {f"mind_{n}.nc": partial(save, infant.mind) for n, infant in enumerate(infants)}
    files |= {f"memory_{n}.nc": partial(save, memory) for n, memory in enumerate(memories)}
    return in_new_process(_recalled, files, group, len(infants), len(memories), count)


def _recalled(folder: Path, group: Group, infants: int, memories: int, count: int) -> IntArray:
    before = digest(folder)
    minds = [load(folder / f"mind_{n}.nc", FaceMind) for n in range(infants)]
    remembered = [load(folder / f"memory_{n}.nc", FaceMemory) for n in range(memories)]
    for memory in remembered:
        memory.check(minds[0].fingerprint, len(minds[0].still))
    _, true = acted(group.body(memories), minds, remembered, count)
    if digest(folder) != before:
        raise AssertionError("files changed while they were recalled")
    return labels(true).T


def digest(folder: Path) -> str:
    """Of all files: nothing moved in between if it is the same."""
    total = hashlib.sha256()
    for file in sorted(folder.iterdir()):
        total.update(file.name.encode() + file.read_bytes())
    return total.hexdigest()
