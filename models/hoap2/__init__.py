"""The Fujitsu HOAP-2, a humanoid of 25 joints and half a metre: README.md says where every number comes from."""

from pathlib import Path
from typing import Final

_FOLDER: Final = Path(__file__).resolve().parent
ROBOT: Final = _FOLDER / "hoap2.xml"
"""The robot alone, with a free joint."""
SCENE: Final = _FOLDER / "scene.xml"
"""Free on a floor."""
SEAT: Final = _FOLDER / "seat.xml"
"""Its pelvis on a seat; written by `derive_seat`."""
