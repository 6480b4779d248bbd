"""Looks at faces that show gestures: rendered once, for all infants of a study."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from babbling.axes import FloatArray
from experiments.face.showing import HOLD_S, Shown, Watcher, drawn, performed, truth
from experiments.face.theories import GESTURES
from imitation.seeing.face_fit import Seen
from models.face import FACES
from models.face.looks import View

VIEWS: Final = {
    "usual": [("adult", View(distance, yaw, pitch)) for distance, yaw, pitch in (
        (0.3, 0, 0), (0.45, 0, 0), (0.6, 0, 0), (0.3, 10, 0), (0.3, -10, 0), (0.3, 0, 10), (0.45, 0, -10), (0.6, 10, 0),
    )],
    "tilted": [("adult", View(0.3, yaw, pitch)) for yaw, pitch in ((20, 0), (-20, 0), (0, 20), (0, -20))],
    "other": [(face, View(distance)) for face in ("adult-long", "adult-round") for distance in (0.3, 0.6)],
}  # fmt: skip
"""Faces and views by condition: up to 10 degrees and .6 m; 20 degrees; faces of other proportions."""
TIMES_S: Final = (0.02, 0.04, 0.06, 0.1, 0.16, 0.3)
"""Into an act, for the course of beliefs."""


@dataclass(frozen=True)
class Looking:
    """One face from one view, so many acts of every kind."""

    condition: str
    face: str
    view: View
    each: int
    seed: int
    course: bool = False
    """Whether to look all through the acts."""


@dataclass(frozen=True, eq=False)
class Look:
    """What was seen of one act, and what it was."""

    looking: Looking
    shown: Shown
    true: FloatArray
    """(8,) relations of the face that showed it."""
    neutral: FloatArray
    """(8,) relations seen when it did nothing."""
    seen: tuple[Seen, ...]
    """At its end; or, all through it, at `TIMES_S`."""
    numbers: FloatArray
    """(2, 2, NUMBERS) what the face looked like when it did nothing, and at the end of the act."""


def watched(looking: Looking) -> list[Look]:
    """Gestures drawn anew, performed in physics and looked at; the last look is at a face that does nothing."""
    face, rng = FACES[looking.face], np.random.default_rng([looking.seed, 0x100C])
    kinds = [(gesture, strong) for gesture in range(len(GESTURES)) for strong in (True, False)]
    shown = [drawn(face, gesture, strong, rng) for gesture, strong in kinds for _ in range(looking.each)]
    shown.append(Shown(len(GESTURES), True, np.zeros(len(shown[0].angles))))
    tick_s = 0.02 if looking.course else HOLD_S
    frames = performed(face, shown, tick_s)
    frames = frames[[round(time / tick_s) - 1 for time in TIMES_S] if looking.course else [-1]]
    true, watcher = truth(face).of(frames[-1]), Watcher.of(face, looking.view, rng)
    looks = []
    for number, one in enumerate(shown):
        seen, numbers, _ = zip(*(watcher.watch(frame[number], rng) for frame in frames), strict=True)
        looks.append(Look(looking, one, true[number], watcher.neutral, seen, np.stack([watcher.passive, numbers[-1]])))
    return looks
