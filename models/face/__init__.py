"""Faces with a tongue: a newborn's, an adult's of other proportions, worn ones, and any other MJCF of the same parts.

Numbers and their sources: README.md beside this file.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from models.errors import BodyError, unknown
from models.wear import Wear

FACE = Path(__file__).parent / "face.xml"
JOINTS = ("jaw", "tongue", "tongue_yaw", "tongue_pitch", "upper_lip_left", "brows", "neck_yaw", "neck_pitch")
"""That have a motor. The tongue slides in the jaw; the four halves of the lips follow the one named."""
SLIDES = ("tongue", "upper_lip_left", "brows")
"""Those of them that slide; the others turn."""
TOUCH = ("upper_lip_left", "upper_lip_right", "lower_lip_left", "lower_lip_right", "tongue")
"""Touch sensors."""
SITES = ("tip", "upper_front", "lower_front", "corner_left", "corner_right")
ACT_S = 0.3
"""For how long a command is held: servos of 6 Hz are settled long before."""


@dataclass(frozen=True)
class Proportions:
    """How a face differs from the newborn's in `face.xml`, as factors.

    Law: lengths go with `size`, masses with its third power, inertias with the fifth, so that size alone changes no
    movement; the other factors come on top.
    """

    size: float = 1.0
    deep: float = 1.0
    """Along x."""
    wide: float = 1.0
    """Along y."""
    tall: float = 1.0
    """Along z."""
    eyes: float = 1.0
    """Distance between eyes and between brows."""
    mouth: float = 1.0
    """Width of mouth and tongue."""
    nose: float = 1.0
    """Length of the nose."""


@dataclass(frozen=True)
class Face:
    """A face one can ask for by name."""

    about: str
    path: Path = FACE
    proportions: Proportions = Proportions()
    wear: Wear = Wear()  # noqa: RUF009  (frozen)


WORN = Wear(backlash=(0.2,), of_range=True, steepness=5.0)
"""Play of 10 % of the range to either side, and the sigmoid by which Affetto's skin follows its actuators."""
ADULT_SIZE = 50 / 26
"""An adult's mouth is 50 mm wide, the newborn's 26."""
FACES: Mapping[str, Face] = MappingProxyType(
    {
        "newborn": Face("a newborn's"),
        "newborn-worn": Face("a newborn's whose motors have play and follow their commands along a sigmoid", wear=WORN),
        "adult": Face("an adult's: the newborn's at 1.9 times the size", proportions=Proportions(ADULT_SIZE)),
        "adult-long": Face(
            "an adult's with a long narrow face, a long nose and a wide mouth",
            proportions=Proportions(ADULT_SIZE, tall=1.12, wide=0.93, eyes=0.95, mouth=1.12, nose=1.25),
        ),
        "adult-round": Face(
            "an adult's with a round face, eyes far apart and a small mouth",
            proportions=Proportions(ADULT_SIZE, tall=0.92, wide=1.08, eyes=1.08, mouth=0.9, nose=0.8),
        ),
    }
)
"""Every face."""


def find(name_or_path: str) -> Face | None:
    """The registered face of this name; None for what looks like a path.

    Raises:
        BodyError: neither.
    """
    if name_or_path not in FACES and Path(name_or_path).suffix.lower() not in (".xml", ".mjcf"):
        raise BodyError(unknown("face", name_or_path, FACES) + ", or the path of an MJCF file")
    return FACES.get(name_or_path)


def face_of(name_or_path: str) -> Face:
    """The face of this name, or the one in this file.

    Raises:
        BodyError: see `find`.
    """
    return find(name_or_path) or Face(name_or_path, Path(name_or_path))
