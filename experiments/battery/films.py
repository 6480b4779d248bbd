"""Films of the first agent, and of the adult that it watches, for the battery's report: one GIF each, by name."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from io import BytesIO

import numpy as np
import numpy.typing as npt
from PIL import Image

from babbling.axes import FloatArray
from babbling.body_image import BodyImage
from babbling.mirroring import MirrorExperience
from babbling.pilot import Pilot
from experiments.errors import ExperimentError
from experiments.face.answering import acted
from experiments.face.infants import Group, Infant
from experiments.face.once import TICK_S, slowly
from experiments.face.showing import performed
from experiments.face.theories import GESTURES
from experiments.face.watching import Look
from experiments.gaze.scene import FRAME_S, Following
from experiments.shared.film import FRAMES_S, frames, shot, write_gif
from experiments.shared.mirrors import Pupil
from experiments.shared.playing import Tried, at_table
from imitation.deferred import FaceMemory
from models.body import SimulatedBody
from models.face import FACES, Face
from models.face.body import face_body
from models.objects.playing import lay

Film = npt.NDArray[np.uint8]
"""A GIF's bytes."""
Shot = tuple[Iterator[Image.Image], float]
"""Pictures, and how many a second."""
BABBLES_S = 6.0
"""How much is filmed of a babble."""
EVERY = 2
"""Frames of an eye's to a picture."""
FACE = (300, 300)


class Camera:
    """Takes films by name, each once; one that is off takes none, and what it would have taken is not made. What cannot
    be drawn, of an agent that knows too little of its body, leaves none."""

    def __init__(self, on: bool = False) -> None:
        self.on, self.films = on, dict[str, Film]()

    def take(self, name: str, shoot: Callable[[], Shot]) -> None:
        """One film."""
        if self.on and name not in self.films:
            with suppress(ExperimentError):
                write_gif(file := BytesIO(), *shoot())
                self.films[name] = np.frombuffer(file.getvalue(), np.uint8)


OFF = Camera()


def babble(body: SimulatedBody, pilot: Pilot, image: BodyImage, mirrored: MirrorExperience) -> Shot:
    """Before the mirror."""
    felt = mirrored.postures[: round(BABBLES_S / mirrored.tick_s), 0]
    return shot("babbling", body, body.configurations(Pupil(body, pilot, image).angles(felt)))


def handling(title: str, toy: str, tried: Tried, row: int) -> Shot:
    """At the table; one whose configurations were kept."""
    body = at_table(toy, 1)
    lay(body.model, tried.laid[row])
    return shot(title, body, tried.configurations[:, row])


def following(seen: Following) -> Shot:
    """What its left eye sees."""
    return (Image.fromarray(left) for left, _ in seen.images[::EVERY]), 1 / (EVERY * FRAME_S)


def adults_face(look: Look) -> Shot:
    """An act that was seen, and rest."""
    face = FACES[look.looking.face]
    act = performed(face, [look.shown], TICK_S)[:, 0]
    rest = np.repeat(act[:1], len(act), 0)
    return _face(f"an adult: {GESTURES[look.shown.gesture]}", face, np.concatenate([rest, act, act[::-1], rest]))


def newborns_face(group: Group, infant: Infant, memory: FaceMemory, tries: int) -> Shot:
    """Its tries at what it remembers, done once more to be filmed."""
    tried, _ = acted(group.body(1), [infant.mind], [memory], tries)
    return _face("a newborn", group.face, slowly(group.face, infant.mind, tried.commands[:, 0])[1])


def _face(title: str, face: Face, configurations: FloatArray) -> Shot:
    """Twice as slow."""
    body = face_body(face, tick_s=TICK_S, threads=1)
    return frames(title, body, configurations, None, None, FACE, 2 * FRAMES_S), FRAMES_S
