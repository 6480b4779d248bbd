"""What one infant saw of one adult, and did."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.dark import FaceMind
from experiments.face.infants import Group
from experiments.face.options import Config
from experiments.face.showing import HOLD_S, Shown, Watcher
from experiments.face.theories import SAID
from imitation.acting.matching import Tried
from imitation.deferred import FaceMemory
from imitation.seeing.face_fit import Seen
from models.face import Face
from models.face.body import NOISE, face_body
from models.retina import Image

TICK_S: Final = 0.02
ACT_TICKS: Final = round(HOLD_S / TICK_S)
"""Frames of an act."""
NEUTRAL_TICKS: Final = 5
"""Looks at the face at rest, before it acts."""


@dataclass(frozen=True, eq=False)
class Watched:
    """What was shown, frame by frame."""

    shown: Shown
    watcher: Watcher
    configurations: FloatArray
    """(T, nq) of the adult."""
    images: list[tuple[Image, Image]]
    numbers: FloatArray
    """(T, 2, NUMBERS) found on them."""
    seen: list[Seen]
    neutral: FloatArray
    """(8,) relations seen of it when it did nothing."""
    relations: FloatArray
    """(T, 8) as seen, held against one's own rest."""
    organs: FloatArray
    """(T, 6) P(organ), nothing last."""
    true: FloatArray
    """(8,) what it came to."""


@dataclass(frozen=True, eq=False)
class Done:
    """Before anything is drawn."""

    config: Config
    group: Group
    mind: FaceMind
    watched: Watched | None
    memory: FaceMemory
    tried: Tried
    true: FloatArray
    """(K, 8) true relations of the tries."""
    stopped: str | None
    """What its try with the pacifier looked like."""


def named(label: IntArray | int) -> str:
    """For people."""
    return SAID[int(label)]


def slowly(
    face: Face, mind: FaceMind, commands: FloatArray, scramble: int | None = None, seed: int = 0
) -> tuple[Any, FloatArray, FloatArray, list[str]]:
    """(K, M) motor lines once more, each followed by rest, tick by tick: the model, (T + 1, nq) configurations from
    rest on, (T, S) senses, and what is done."""
    body = face_body(face, tick_s=TICK_S, scramble=scramble, noise=NOISE, threads=1, seed=seed)
    body.reset()
    configurations, senses, doing = [np.array(body.batch.qpos[0])], list[FloatArray](), list[str]()
    for number, command in enumerate(commands):
        for line, what in ((command, f"try {number + 1}"), (mind.rest, "rests")):
            for _ in range(ACT_TICKS):
                senses.append(body.act(line[None])[0])
                configurations.append(np.array(body.batch.qpos[0]))
                doing.append(what)
    return body.model, np.stack(configurations), np.stack(senses), doing
