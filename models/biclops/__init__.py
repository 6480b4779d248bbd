"""A Biclops-like binocular pan-tilt head and a teacher's face: README.md says where every number comes from."""

from pathlib import Path
from typing import Final

_FOLDER: Final = Path(__file__).resolve().parent
ROBOT: Final = _FOLDER / "biclops.xml"
"""The head alone."""
FACE: Final = _FOLDER / "face.xml"
"""A mask for its camera mount."""
SCENE: Final = _FOLDER / "scene.xml"
"""The head on a table in a plain room."""
