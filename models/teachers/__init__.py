"""Teachers: robots and humans whose movements can be watched."""

import os
from pathlib import Path

from models.errors import unknown
from models.motion.files import checked
from models.teachers.demonstrations import DEMONSTRATIONS, perform_builtin, perform_motion
from models.teachers.performance import PARTS, Performance, TeacherError

__all__ = ["DEMONSTRATIONS", "PARTS", "Performance", "TeacherError", "perform", "perform_motion"]


def perform(name_or_path: str | os.PathLike[str]) -> Performance:
    """What is seen of a teacher: the name of a built-in demonstration, or the path of an `.amc` file."""
    if str(name_or_path) in DEMONSTRATIONS:
        return perform_builtin(str(name_or_path))
    path = Path(name_or_path)
    if path.suffix.lower() == ".amc":
        from models.teachers.cmu import perform_amc  # dm_control takes a second to load

        return perform_amc(path)
    if path.suffix or len(path.parts) > 1 or path.exists():
        checked(path)
        raise TeacherError(f"{path}: only .amc files show a teacher; joint trajectories are read by models.motion")
    raise TeacherError(unknown("demonstration", str(name_or_path), DEMONSTRATIONS) + ", or the path of an .amc file")
