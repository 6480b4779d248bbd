"""Any URDF as a teacher: limbs are found by joint names and by where the joints sit, and what is missing is said.

Names first: hip, knee, ankle, shoulder, elbow, wrist, with left and right in one of the usual spellings. A limb needs
the joints at both of its ends (`NEEDS`). A body with no limb at all is no teacher; one with some shows those parts.
Meshes are not read: kinematics is enough.
"""

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from models.errors import unknown
from models.motion.files import checked, text
from models.motion.trajectory import JointTrajectory
from models.teachers.performance import SIDES, Performance, TeacherError, unit, upright_frame

Array = NDArray[np.float64]
LIMIT_BYTES = 8 * 2**20
MOST_JOINTS = 400
WORDS: Mapping[str, tuple[str, ...]] = {
    "shoulder": ("shoulder", "uarm", "upperarm", "upper_arm", "humerus"),
    "elbow": ("elbow", "forearm", "lower_arm", "lowerarm"),
    "wrist": ("wrist", "hand"),
    "hip": ("hip", "thigh", "upper_leg", "upperleg", "femur"),
    "knee": ("knee", "shank", "lower_leg", "lowerleg", "calf", "tibia"),
    "ankle": ("ankle", "foot"),
}
"""Landmark -> what joints at it are called, in order of trust."""
ROOTS = ("shoulder", "hip")
OUTERMOST = (*ROOTS, "wrist")
"""Of several joints there (pitch, roll, yaw) the last is taken; of the others the first."""
CHAINS = (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"))
BALL = 0.35
"""Joints within this share of the next limb's length are one ball."""
NUMBERED = {"arm": ("shoulder", "elbow", "wrist"), "leg": ("hip", "knee", "ankle")}
"""Limbs whose joints are only counted (arm_left_1, ...): three joints make a ball, the third carries on, then these."""
NEEDS = {
    "upper_arm": ("shoulder", "elbow"),
    "forearm": ("elbow", "wrist"),
    "thigh": ("hip", "knee"),
    "shank": ("knee", "ankle"),
}
CARRIED_BY = {"head": ("head", "neck", "cervical"), "left_foot": ("ankle", "foot"), "right_foot": ("ankle", "foot")}
"""Body -> what the last joint before it is called."""
SHOWN_BY = {"head": ("head", 0), "left_foot": ("left_foot", 0), "right_foot": ("right_foot", 0), "trunk": ("pelvis", 2)}
"""Part -> carrier, and which of forward, left, up of the standing robot rides on it."""
FOUR_LEGS = {"rl": "left", "lh": "left", "rr": "right", "rh": "right", "fl": None, "fr": None, "lf": None, "rf": None}
"""Beginnings of a four-legged robot's joints: its hind legs correspond to legs, its fore legs to nothing."""
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Found:
    """What a URDF offers.

    landmarks: "left_knee" -> number of its joint. carriers: "torso", "head" ... -> joint that carries it.
    parts: those that can be seen. missing: part -> what was not found for it.
    meshes: mesh files that the URDF names and that are not there.
    """

    model: pin.Model
    landmarks: Mapping[str, int]
    carriers: Mapping[str, int]
    parts: tuple[str, ...]
    missing: Mapping[str, str]
    meshes: tuple[str, ...]


def read_urdf(path: str | os.PathLike[str]) -> Found:
    """A checked URDF and the body parts found in it.

    Raises:
        TeacherError: a file that is missing, too large, no URDF; or not one limb in it (what was looked for is said).
    """
    path = checked(path, LIMIT_BYTES)
    content = text(path, LIMIT_BYTES)
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
    landmarks = _landmarks(model)
    parts, missing = [], {}
    for side in SIDES:
        for part, ends in NEEDS.items():
            absent = [end for end in ends if f"{side}_{end}" not in landmarks]
            if absent:
                missing[f"{side}_{part}"] = " and ".join(absent)
            else:
                parts.append(f"{side}_{part}")
    if not parts:
        wanted = ", ".join(f"{side}_{name}" for side in SIDES for name in WORDS)
        raise TeacherError(
            f"{path}: no limb was found: of {wanted} it has {', '.join(sorted(landmarks)) or 'none'}; name joints so"
        )
    carriers = _carriers(model, landmarks)
    for part, (body, _) in SHOWN_BY.items():
        if body in carriers:
            parts.append(part)
        else:
            missing[part] = body
    return Found(model, landmarks, carriers, tuple(parts), missing, _absent_meshes(content, path))


def perform_urdf(path: str | os.PathLike[str], trajectory: JointTrajectory) -> tuple[Performance, Found]:
    """What is seen of a robot out of a URDF that moves like this; joints that are not named stay at zero.

    Directions are in the frame of the body that carries the limbs found (the one the shoulders hang from, else the
    hips): left from the right limb's root to the left one's, up from the legs (or the world's z, where there are none).

    Raises:
        TeacherError: see `read_urdf`; a joint that the URDF does not have.
    """
    found = read_urdf(path)
    model = found.model
    names = list(model.names)[1:]
    configurations = np.tile(pin.neutral(model), (len(trajectory.time), 1))
    for joint, values in zip(trajectory.joints, trajectory.angles.T, strict=True):
        if joint not in names:
            raise TeacherError(f"{trajectory.name}: {unknown(f'joint of {Path(path).name}', joint, names)}")
        number = model.getJointId(joint)
        place = model.idx_qs[number]
        if model.nqs[number] == 2:  # a continuous joint is kept as cosine and sine
            configurations[:, place], configurations[:, place + 1] = np.cos(values), np.sin(values)
        else:
            configurations[:, place] = values
    positions, turns = _poses(found, configurations)
    standing, still = _poses(found, pin.neutral(model)[None])
    frame = _frame({name: values[0] for name, values in standing.items()})
    riding = {name: values @ (still[name][0].T @ frame) for name, values in turns.items()}
    directions = {}
    for part in found.parts:
        if part in SHOWN_BY:
            body, axis = SHOWN_BY[part]
            pointing = riding[body][:, :, axis]
        else:
            side, _, name = part.partition("_")
            start, end = NEEDS[name]
            pointing = positions[f"{side}_{end}"] - positions[f"{side}_{start}"]
        if not (np.linalg.norm(pointing, axis=1) > 1e-6).all():
            continue  # both of its ends are one point: nothing to see
        directions[part] = unit(np.einsum("tji,tj->ti", riding["torso"], pointing))
    points = np.stack([positions[name] for name in positions], 1) @ frame
    order = list(positions)
    bones = tuple(
        (order.index(f"{side}_{ends[0]}"), order.index(f"{side}_{ends[1]}"))
        for side in SIDES
        for part, ends in NEEDS.items()
        if f"{side}_{part}" in directions
    )
    return Performance(trajectory.name, Path(path).stem, trajectory.time, directions, points, bones), found


def remarks(found: Found, path: str | os.PathLike[str]) -> tuple[str, ...]:
    """One line each for what was not found and does not stop anything."""
    lines = []
    if found.missing:
        absent = "; ".join(f"{part} (no {what})" for part, what in found.missing.items())
        lines.append(f"{path}: corresponds in {', '.join(found.parts)}; not in {absent}")
    if found.meshes:
        lines.append(f"{path}: {len(found.meshes)} meshes are not there, first {found.meshes[0]!r}; kinematics is used")
    return tuple(lines)


def _landmarks(model: pin.Model) -> dict[str, int]:
    """See the module; of a ball's joints the last that still sits near the first, measured by the limb beyond."""
    found: dict[str, int] = {}
    names, supports = list(model.names), model.supports
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))

    def apart(one: int, other: int) -> float:
        return float(np.linalg.norm(data.oMi[one].translation - data.oMi[other].translation))

    for side in SIDES:
        ours = [number for number in range(1, model.njoints) if _side(names[number]) == side]
        ours.sort(key=lambda number: len(supports[number]))
        balls: dict[str, list[int]] = {}
        for landmark, words in WORDS.items():
            near = next((n for word in words if (n := [j for j in ours if word in _plain(names[j])])), [])
            if near:
                balls[landmark] = near
                found[f"{side}_{landmark}"] = near[-1 if landmark in OUTERMOST else 0]
        for word, counted in NUMBERED.items():
            chain = [number for number in ours if word in _plain(names[number]).split("_")]
            if len(chain) >= 5 and not any(f"{side}_{landmark}" in found for landmark in counted):
                found |= {f"{side}_{landmark}": joint for landmark, joint in zip(counted, chain[2:5], strict=True)}
        for start, end in CHAINS:
            first, second = found.get(f"{side}_{start}"), found.get(f"{side}_{end}")
            if first is None or second is None:
                continue
            if start in ROOTS and start in balls:
                ball = [joint for joint in balls[start] if joint in list(supports[second])]
                near = [joint for joint in ball if apart(joint, ball[0]) <= BALL * apart(second, ball[0])]
                first = found[f"{side}_{start}"] = near[-1] if near else first
            if first not in list(supports[second]):  # on another branch: not of this limb
                del found[f"{side}_{end}"]
    return found


def _side(name: str) -> str | None:
    """Side of a joint: the word left or right, an L or R in front (LARM, lHip, l_hip), or such a letter on its own."""
    for side in SIDES:
        if side in name.lower():
            return side
    words = _plain(name).split("_")
    if words[0] in FOUR_LEGS:
        return FOUR_LEGS[words[0]]
    for side in SIDES:
        if words[0] == side[0] or re.match(f"[{side[0].upper()}][A-Z]|[{side[0]}][A-Z]", name):
            return side
    return next((side for side in SIDES if side[0] in words), None)


def _plain(name: str) -> str:
    return re.sub(r"([a-z])([A-Z])", r"\1_\2", name).lower()


def _carriers(model: pin.Model, landmarks: Mapping[str, int]) -> dict[str, int]:
    """Joints that carry the torso, and the pelvis, the head and the feet where there are any."""
    depth = [len(support) for support in model.supports]
    common: dict[str, int] = {}
    for root in ROOTS:
        roots = [landmarks[f"{side}_{root}"] for side in SIDES if f"{side}_{root}" in landmarks]
        if len(roots) == 2:
            shared = set(model.supports[roots[0]]) & set(model.supports[roots[1]])
            common[root] = int(max(shared, key=lambda joint: depth[joint]))
    carriers = {"torso": common.get("shoulder", common.get("hip", 0))}
    if "shoulder" in common and "hip" in common:
        carriers["pelvis"] = common["hip"]
    for body, words in CARRIED_BY.items():
        side = next((side for side in SIDES if body.startswith(side)), None)
        near = [
            number
            for number in range(1, model.njoints)
            if any(word in _plain(model.names[number]) for word in words)
            and (side is None or (_side(model.names[number]) == side and f"{side}_ankle" in landmarks))
        ]
        if side is not None and not near and f"{side}_ankle" in landmarks:
            ankle = landmarks[f"{side}_ankle"]
            near = [number for number in range(1, model.njoints) if ankle in list(model.supports[number])]
        if near:
            carriers[body] = max(near, key=lambda number: depth[number])
    return carriers


def _poses(found: Found, configurations: Array) -> tuple[dict[str, Array], dict[str, Array]]:
    """Landmark -> (T, 3) positions, and carrier -> (T, 3, 3) rotations."""
    model, data = found.model, found.model.createData()
    positions = {name: np.empty((len(configurations), 3)) for name in found.landmarks}
    turns = {name: np.empty((len(configurations), 3, 3)) for name in found.carriers}
    for frame, configuration in enumerate(configurations):
        pin.forwardKinematics(model, data, configuration)
        for name, number in found.carriers.items():
            turns[name][frame] = data.oMi[number].rotation
        for name, number in found.landmarks.items():
            positions[name][frame] = data.oMi[number].translation
    return positions, turns


def _frame(at: Mapping[str, Array]) -> Array:
    """Forward, left, up as columns, of the standing robot; the URDF's own axes where landmarks do not tell."""
    for root in ROOTS:
        if all(f"{side}_{root}" in at for side in SIDES):
            left = at[f"left_{root}"] - at[f"right_{root}"]
            legs = [at[f"{s}_hip"] - at[f"{s}_ankle"] for s in SIDES if f"{s}_hip" in at and f"{s}_ankle" in at]
            up = np.sum(legs, axis=0) if legs else UP
            return upright_frame(left, up)
    return np.eye(3)


def _absent_meshes(content: str, path: Path) -> tuple[str, ...]:
    """Mesh files that the URDF names and that are not beside it."""
    absent = []
    for name in re.findall(r"<mesh[^>]*filename\s*=\s*[\"']([^\"']+)[\"']", content):
        local = re.sub(r"^(package|file)://", "", name)
        if not any((folder / local).exists() for folder in (path.parent, *path.parent.parents[:4])):
            absent.append(name)
    return tuple(dict.fromkeys(absent))
