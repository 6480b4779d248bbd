"""Any URDF as a teacher: what is missing in it is said; a body with no limb at all is no teacher."""

import os
import re
from pathlib import Path

import pinocchio as pin

from models.files import checked, text
from models.motion.trajectory import JointTrajectory
from models.teachers.anatomy import perform
from models.teachers.performance import PARTS, SIDES, Performance, TeacherError
from models.teachers.teacher import WORDS, Teacher

LIMIT_BYTES = 8 * 2**20
MOST_JOINTS = 200


def read_urdf(path: str | os.PathLike[str]) -> Teacher:
    """A checked URDF and the body parts found in it.

    Raises:
        TeacherError: a file that is missing, too large, no URDF; or not one limb in it (what was looked for is said).
    """
    path, content = _content(path)
    if "<!DOCTYPE" in content or "<!ENTITY" in content:
        raise TeacherError(f"{path}: declares entities, which no robot needs; remove the DOCTYPE")
    if "<robot" not in content:
        raise TeacherError(f"{path}: holds no <robot>; give a URDF file")
    try:
        model = pin.buildModelFromXML(content)
    except (ValueError, RuntimeError) as error:
        raise TeacherError(f"{path}: is not a readable URDF ({' '.join(str(error).split())[:120]})") from None
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
    path, content = _content(path)
    absent = []
    for name in re.findall(r"<mesh[^>]*filename\s*=\s*[\"']([^\"']+)[\"']", content):
        local = re.sub(r"^(package|file)://", "", name)
        if not any((folder / local).exists() for folder in (path.parent, *path.parent.parents[:4])):
            absent.append(name)
    return tuple(dict.fromkeys(absent))


def _content(path: str | os.PathLike[str]) -> tuple[Path, str]:
    path = checked(path, LIMIT_BYTES)
    return path, text(path, LIMIT_BYTES)
