"""What a face shows: six gestures, strong and weak, performed by its own motors; what two eyes make of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from babbling.axes import FloatArray
from experiments.face.theories import GESTURES
from imitation.seeing.face_fit import Acquainted, Seen, acquaint, look_at, see
from models.face import JOINTS, SLIDES, Face
from models.face.body import face_body, face_model
from models.face.looks import FOCAL_PX, Onlooker, View
from models.face.relations import Truth
from models.retina import Image

_JAW, _SIDEWAYS = (10.0, 14.0), (18.0, 22.0)
SHOWN: Final = {
    "tongue out": ({"jaw": _JAW, "tongue": (20.0, 25.0)}, {"jaw": _JAW, "tongue": (12.5, 14.5)}),
    "tongue to the side": (
        {"jaw": _JAW, "tongue": _SIDEWAYS, "tongue_yaw": (22.0, 35.0)},
        {"jaw": _JAW, "tongue": _SIDEWAYS, "tongue_yaw": (8.0, 14.0)},
    ),
    "mouth open": ({"jaw": (18.0, 28.0)}, {"jaw": (5.0, 9.0)}),
    "lips pursed": ({"upper_lip_left": (5.0, 7.5)}, {"upper_lip_left": (1.5, 2.75)}),
    "brows": ({"brows": (2.8, 4.0)}, {"brows": (0.8, 1.5)}),
    "head turn": ({"neck_yaw": (12.0, 19.0)}, {"neck_yaw": (5.0, 9.0)}),
}
"""Strongly and weakly: least and most of each joint, degrees, or mm in a newborn's face; what can go to either side
goes to one of them. A weak tongue comes 1 to 3 mm beyond the lips: what stays behind them cannot be seen."""
SIDED: Final = ("tongue_yaw", "neck_yaw")
HOLD_S: Final = 0.3


class Shown(NamedTuple):
    """One gesture, as it was performed."""

    gesture: int
    """Of `GESTURES`."""
    strong: bool
    angles: FloatArray
    """(8,) joints as commanded, rad or m."""


def drawn(face: Face, gesture: int, strong: bool, rng: np.random.Generator) -> Shown:
    """One of a kind."""
    angles = np.zeros(len(JOINTS))
    for joint, (least, most) in SHOWN[GESTURES[gesture]][0 if strong else 1].items():
        unit = 1e-3 * face.proportions.size if joint in SLIDES else np.deg2rad(1)
        side = rng.choice([-1, 1]) if joint in SIDED else 1
        angles[JOINTS.index(joint)] = side * rng.uniform(least, most) * unit
    return Shown(gesture, strong, angles)


def performed(face: Face, shown: Sequence[Shown], tick_s: float = HOLD_S) -> FloatArray:
    """(T, N, nq) configurations of the face at the end of every tick, all acts at once."""
    body = face_body(face, copies=len(shown), tick_s=tick_s, noise=np.zeros(len(JOINTS)), threads=1)
    body.reset()
    lines = body.command_angles(np.stack([one.angles for one in shown]))
    frames = []
    for _ in range(round(HOLD_S / tick_s)):
        body.act(lines)
        frames.append(np.array(body.batch.qpos))
    return np.stack(frames)


@dataclass(frozen=True, eq=False)
class Watcher:
    """Somebody who knows how a face looks that does nothing, from one view."""

    face: Face
    onlooker: Onlooker
    known: Acquainted
    neutral: FloatArray
    """(8,) relations seen of it when it did nothing."""
    passive: FloatArray
    """(2, NUMBERS) what it then looked like."""

    @classmethod
    def of(cls, face: Face, view: View, rng: np.random.Generator, looks: int = 3) -> "Watcher":
        """Having looked so often at the passive face."""
        onlooker, passive = Onlooker(face, view), still(face)
        first, *more = (look_at(onlooker.look(passive, rng)) for _ in range(looks))
        known = acquaint(np.stack([first, *more]), FOCAL_PX)
        return cls(face, onlooker, known, np.mean([see(known, look).relations for look in more], 0), first)

    def watch(
        self, configuration: FloatArray, rng: np.random.Generator
    ) -> tuple[Seen, FloatArray, tuple[Image, Image]]:
        """What it sees of the face now, the (2, NUMBERS) by which it does, and the images."""
        images = self.onlooker.look(configuration, rng)
        numbers = look_at(images)
        return see(self.known, numbers), numbers, images


def truth(face: Face) -> Truth:
    """Relations of this face, for those who judge."""
    return Truth(face_model(face))


def still(face: Face) -> FloatArray:
    """(nq,) configuration of a face that does nothing, its lips touching."""
    return np.asarray(performed(face, [Shown(0, False, np.zeros(len(JOINTS)))])[-1, 0])
