"""What one infant saw of one adult, and did."""

from dataclasses import dataclass
from typing import Final

from babbling.axes import FloatArray, IntArray
from babbling.dark import FaceMind
from experiments.face.infants import Group
from experiments.face.options import Config
from experiments.face.showing import HOLD_S, Shown, Watcher
from experiments.face.theories import SAID
from imitation.acting.matching import Tried
from imitation.deferred import FaceMemory
from imitation.seeing.face_fit import Seen
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
