"""Objects to play with: Meltzoff's five, his light panel, and the dumbbell that is too large. README.md says why so.

An object is a folder with one MJCF (`object.xml`: two sites `a` and `b`, the parts it is known by; a joint `switch`
for one that shines or buzzes; a joint `stiction` for one that is pulled apart) and a state function.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from models.arrays import IntArray
from models.objects.states import Watched, buzzed, joined, lit, pulled

_FOLDER: Final = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Toy:
    """One object."""

    folder: Path
    about: str
    kind: str
    """What it is taken for: toys of a kind are played with alike, a mind knows no more of one than this."""
    state: Callable[[Watched], IntArray]
    """(B,) numbers in `models.objects.states.STATES`."""
    half: tuple[float, float, float]
    """m, half the width of `a` from side to side, half its height, half the height of `b`: what eyes measure."""
    alone: bool = False
    """Whether it has no other part: `b` is where `a` is."""
    ends: bool = False
    """Whether `a` and `b` are two ends of one thing, one for each hand."""
    on: float = 0.0015
    """m that its switch is pressed in when it shines or buzzes."""
    glows: bool = False
    """Whether it can be seen that it is on: then `a` is its lamp."""
    stiction: tuple[float, float] = (1.0, 1.0)
    """N of dry friction that holds it together: least and most, log-uniform over copies."""

    @property
    def path(self) -> Path:
        """Its MJCF."""
        return self.folder / "object.xml"


_RING, _CUP = partial(joined, within=0.018), partial(joined, within=0.026)
_ENDS = {"state": pulled, "ends": True, "stiction": (0.5, 6.0)}
_ALL: Final[dict[str, dict[str, Any]]] = {
    "dumbbell": {
        "about": "pulled apart, against dry friction",
        "kind": "dumbbell",
        "half": (0.02, 0.02, 0.02),
        **_ENDS,
    },
    "wide-dumbbell": {"about": "with ends of 5 cm", "kind": "dumbbell", "half": (0.025, 0.025, 0.025), **_ENDS},
    "outsized": {
        **_ENDS,
        "about": "a dumbbell too large for small hands",
        "kind": "outsized",
        "half": (0.032, 0.032, 0.032),
        "stiction": (1.25, 15.0),
    },
    "panel": {
        "about": "a touch lights it",
        "kind": "panel",
        "half": (0.042, 0.004, 0.004),
        "alone": True,
        "state": lit,
        "glows": True,
    },
    "box": {
        "about": "a stick reaches a recessed button, which buzzes",
        "kind": "box",
        "half": (0.006, 0.006, 0.013),
        "state": buzzed,
        "on": 0.002,
    },
    "loop": {"about": "a loop hangs on a prong", "kind": "ring", "half": (0.028, 0.006, 0.024), "state": _RING},
    "square": {"about": "a square frame over a dowel", "kind": "ring", "half": (0.028, 0.007, 0.021), "state": _RING},
    "cup": {"about": "a bead in a cup", "kind": "cup", "half": (0.01, 0.01, 0.02), "state": _CUP},
}
TOYS: Final[Mapping[str, Toy]] = MappingProxyType(
    {name: Toy(_FOLDER / name.replace("-", "_"), **told) for name, told in _ALL.items()}
)
"""Every object."""
