"""Skeletons in `.bvh` files (Biovision hierarchy): any whose joints have one of the usual names.

A file is a HIERARCHY of joints, each with an OFFSET from its parent and the CHANNELS it moves by (degrees, turned about
its own axes in the order given), then MOTION: as many numbers a frame as there are channels. Where a skeleton stands
and how long its bones are is not looked at; a human's hip is drawn as high as `HIP_M`.
"""

import os
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy.spatial.transform import Rotation

from models.arrays import FloatArray
from models.files import checked, finite, text
from models.teachers.amc import MAX_FRAMES, MIN_FRAMES
from models.teachers.anatomy import BodyPoses, perform
from models.teachers.performance import SIDES, Performance, TeacherError
from models.teachers.teacher import Teacher

CALLED = {
    "shoulder": ("arm", "upperarm", "uparm", "shoulder", "humerus"),
    "elbow": ("forearm", "lowerarm", "elbow", "radius"),
    "wrist": ("hand", "wrist"),
    "hip": ("upleg", "thigh", "upperleg", "hip", "femur"),
    "knee": ("leg", "shin", "lowerleg", "calf", "knee", "tibia"),
    "ankle": ("foot", "ankle"),
}
"""Landmark -> what the joint there is called, side and prefix left out, in order of trust."""
MIDDLE = {
    "torso": ("spine2", "spine3", "chest", "upperchest", "spine1", "spine", "thorax", "abdomen"),
    "head": ("head", "neck1", "neck"),
}
"""The same of the bodies in the middle."""
HIP_M = 0.9
MOST_JOINTS = 500


@dataclass
class _Skeleton:
    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[list[float]] = field(default_factory=list)
    channels: list[list[str]] = field(default_factory=list)


def perform_bvh(path: str | os.PathLike[str]) -> Performance:
    """What is seen of a skeleton, at every frame of the capture.

    Raises:
        TeacherError: a broken file (which line), or joints that have no known names (which landmarks lack).
    """
    path = checked(path)
    lines = [(f"{path}: line {i}", line.split()) for i, line in enumerate(text(path).splitlines(), 1) if line.strip()]
    start = next((i for i, (_, words) in enumerate(lines) if words[0].upper() == "MOTION"), len(lines))
    if not lines or lines[0][1][0].upper() != "HIERARCHY" or start == len(lines):
        raise TeacherError(f"{path}: no HIERARCHY and MOTION; is this a .bvh file?")
    skeleton = _hierarchy(lines[1:start], path)
    tick_s, numbers = _motion(lines[start + 1 :], sum(map(len, skeleton.channels)), path)
    model = _model(skeleton)
    teacher = Teacher(path.stem, model, *_found(skeleton, path))
    reference = teacher.reference
    hips = np.mean([reference.positions[f"{side}_hip"][0, 2] for side in SIDES])
    moving = teacher.motion(_configurations(skeleton, numbers))
    size = HIP_M / hips
    moving = BodyPoses(moving.rotations, {name: size * place for name, place in moving.positions.items()})
    return perform(path.stem, "human (BVH)", np.arange(float(len(numbers))) * tick_s, moving, reference)


def _hierarchy(lines: list[tuple[str, list[str]]], path: Path) -> _Skeleton:
    found, open_, at = _Skeleton(), [-1], -1
    for where, words in lines:
        kind = words[0].upper()
        if kind in ("ROOT", "JOINT", "END"):
            ends = kind == "END"
            name = f"{found.names[at]} end" if ends and found.names else " ".join(words[1:])
            if not name or (kind == "ROOT") != (not found.names) or len(found.names) >= MOST_JOINTS:
                raise TeacherError(f"{where}: one ROOT first, then at most {MOST_JOINTS} named joints are read")
            found.names.append(name)
            found.parents.append(open_[-1])
            found.offsets.append([0.0, 0.0, 0.0])
            found.channels.append([])
            at = len(found.names) - 1
        elif kind == "{":
            open_.append(at)
        elif kind == "}" and len(open_) > 1:
            open_.pop()
            at = open_[-1]
        elif kind == "OFFSET" and len(words) == 4 and at >= 0:
            found.offsets[at] = [finite(word, where) for word in words[1:]]
        elif kind == "CHANNELS" and len(words) > 1 and at >= 0 and words[1] == str(len(words) - 2):
            found.channels[at] = [word.lower() for word in words[2:]]
            if not all(re.fullmatch("[xyz](position|rotation)", channel) for channel in found.channels[at]):
                raise TeacherError(f"{where}: channels are Xposition .. Zposition and Xrotation .. Zrotation")
        else:
            raise TeacherError(f"{where}: {' '.join(words)[:40]!r} is not what stands in a HIERARCHY; export it again")
    if len(open_) != 1 or not found.names:
        raise TeacherError(f"{path}: braces of the HIERARCHY do not match; export it again")
    return found


def _motion(lines: list[tuple[str, list[str]]], channels: int, path: Path) -> tuple[float, FloatArray]:
    head = {" ".join(words).partition(":")[0].lower(): (where, words) for where, words in lines[:2]}
    if set(head) != {"frames", "frame time"}:
        raise TeacherError(f"{path}: MOTION begins with 'Frames:' and 'Frame Time:'; export it again")
    tick_s = finite(head["frame time"][1][-1], head["frame time"][0])
    count, rows = finite(head["frames"][1][-1], head["frames"][0]), lines[2:]
    if not 1e-4 <= tick_s <= 1 or count != len(rows) or not MIN_FRAMES <= count <= MAX_FRAMES:
        raise TeacherError(
            f"{path}: {len(rows)} frames of {tick_s:g} s where {count:g} are told; {MIN_FRAMES} to {MAX_FRAMES} frames "
            "of 0.0001 to 1 s are read"
        )
    for where, words in rows:
        if len(words) != channels:
            raise TeacherError(f"{where}: {len(words)} numbers where the HIERARCHY has {channels} channels")
    return tick_s, np.array([[finite(word, where) for word in words] for where, words in rows])


def _model(skeleton: _Skeleton) -> pin.Model:
    """Every joint turns freely about its place; none moves along."""
    model = pin.Model()
    for name, parent, offset in zip(skeleton.names, skeleton.parents, skeleton.offsets, strict=True):
        place = pin.SE3(np.eye(3), np.array(offset))
        model.addJoint(parent + 1, pin.JointModelSpherical(), place, name)
    return model


def _configurations(skeleton: _Skeleton, numbers: FloatArray) -> FloatArray:
    """(T, 4 J) quaternions of (T, channels) numbers."""
    first, turns = 0, []
    for channels in skeleton.channels:
        angles = [i for i, channel in enumerate(channels) if channel.endswith("rotation")]
        order = "".join(channels[i][0].upper() for i in angles)
        mine = numbers[:, [first + i for i in angles]]
        still = Rotation.identity(len(numbers))
        turns.append((Rotation.from_euler(order, mine, degrees=True) if angles else still).as_quat())
        first += len(channels)
    return np.concatenate(turns, axis=1)


def _found(skeleton: _Skeleton, path: Path) -> tuple[dict[str, int], dict[str, int]]:
    """Landmarks and carriers, as numbers of the model's joints (0 is the world)."""
    plain = [re.sub("[^a-z0-9]", "", name.split(":")[-1].lower()) for name in skeleton.names]

    def called(names: tuple[str, ...], side: str = "") -> int | None:
        spelled = [form for name in names for form in ([side + name, name + side, side[0] + name] if side else [name])]
        return next((plain.index(form) + 1 for form in spelled if form in plain), None)

    landmarks = {f"{side}_{mark}": called(names, side) for side in SIDES for mark, names in CALLED.items()}
    carriers = {"pelvis": 1} | {body: called(names) for body, names in MIDDLE.items()}
    carriers |= {f"{side}_foot": landmarks[f"{side}_ankle"] for side in SIDES}
    if lacks := [name for name, joint in (landmarks | carriers).items() if joint is None and name != "head"]:
        raise TeacherError(
            f"{path}: no joint is called as {', '.join(lacks[:4])} usually is, such as LeftUpLeg or lThigh"
        )
    return (
        {name: joint for name, joint in landmarks.items() if joint is not None},
        {name: joint for name, joint in carriers.items() if joint is not None},
    )
