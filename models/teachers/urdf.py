"""Any URDF as a teacher: what is missing in it is said; a body with no limb at all is no teacher."""

import os
import re
from pathlib import Path

import pinocchio as pin

from models.apart import tried
from models.errors import BodyError
from models.files import text
from models.hush import silence
from models.markup import Look, look
from models.motion.trajectory import JointTrajectory
from models.teachers.anatomy import perform
from models.teachers.performance import PARTS, SIDES, Performance, TeacherError
from models.teachers.teacher import WORDS, Teacher

LIMIT_BYTES = 8 * 2**20
MOST_JOINTS, FURTHEST = 200, 100.0


def read_urdf(path: str | os.PathLike[str]) -> Teacher:
    """A checked URDF and the body parts found in it.

    Raises:
        TeacherError: a file that is missing, too large, no URDF; or not one limb in it (what was looked for is said).
    """
    path = Path(path)
    content = text(path, LIMIT_BYTES)
    _look(path, content)
    if "<robot" not in content:
        raise TeacherError(f"{path}: holds no <robot>; give a URDF file")
    try:
        tried("models.teachers.urdf:read_urdf", path)
    except BodyError as error:
        raise TeacherError(str(error)) from None
    try:
        with silence(path):  # urdfdom speaks for itself
            model = pin.buildModelFromXML(content)
    except (ValueError, RuntimeError) as error:
        raise TeacherError(f"{path}: is not a readable URDF ({' '.join(str(error).split())[:120]})") from None
    if max(abs(place.translation).max() for place in model.jointPlacements) > FURTHEST:
        raise TeacherError(f"{path}: a joint is more than {FURTHEST:g} m from the one before; mend its origin")
    if model.njoints - 1 > MOST_JOINTS:
        raise TeacherError(f"{path}: has {model.njoints - 1} joints where at most {MOST_JOINTS} are read")
    found = Teacher.found(path.stem, model)
    if not set(PARTS) - set(found.missing) - {"head", "trunk", *(f"{side}_foot" for side in SIDES)}:
        wanted = ", ".join(f"{side}_{name}" for side in SIDES for name in WORDS)
        has = ", ".join(sorted(found.landmarks)) or "none"
        raise TeacherError(f"{path}: no limb was found: of {wanted} it has {has}; name joints so")
    return found


def perform_urdf(path: str | os.PathLike[str], trajectory: JointTrajectory) -> tuple[Performance, Teacher]:
    """What is seen of a robot out of a URDF that moves like this; joints that are not named stay at zero.

    Raises:
        TeacherError: see `read_urdf`; a joint that the URDF does not have.
    """
    found = read_urdf(path)
    motion = found.motion(found.postures(trajectory))
    return perform(trajectory.name, found.name, trajectory.time, motion, found.reference), found


def remarks(found: Teacher, path: str | os.PathLike[str]) -> tuple[str, ...]:
    """One line each for what was not found and does not stop anything."""
    lines, missing = [], found.missing
    if missing:
        absent = "; ".join(f"{part} (no {what})" for part, what in missing.items())
        there = ", ".join(part for part in PARTS if part not in missing)
        lines.append(f"{path}: corresponds in {there}; not in {absent}")
    if meshes := _absent_meshes(path):
        lines.append(f"{path}: {len(meshes)} meshes are not there, first {meshes[0]!r}; kinematics is used")
    return tuple(lines)


def _absent_meshes(path: str | os.PathLike[str]) -> tuple[str, ...]:
    """Mesh files that the URDF names and that are not beside it."""
    path = Path(path)
    absent = []
    for name in dict.fromkeys(name for tag, name in _look(path, text(path, LIMIT_BYTES)).files if tag == "mesh"):
        local = re.sub(r"^(package|file)://", "", name)
        if not any(os.path.exists(folder / local) for folder in (path.parent, *path.parent.parents[:4])):
            absent.append(name)
    return tuple(absent)


def _look(path: Path, content: str) -> Look:
    try:
        return look(path, content.encode())
    except BodyError as error:
        raise TeacherError(str(error)) from None
