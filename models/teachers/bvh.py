"""Skeletons in `.bvh` files (Biovision hierarchy): any whose joints are told by usual names or by its build.

A file is a HIERARCHY of joints, each with an OFFSET from its parent and the CHANNELS it moves by (degrees, turned about
its own axes in the order given), then MOTION: as many numbers a frame as there are channels. Only the root moves from
its place. Units and which axis is up do not matter: it is drawn upright, its hip as high as `HIP_M`.
"""

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice, takewhile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from models.arrays import FloatArray
from models.files import checked, finite, lines, text
from models.teachers.amc import MAX_FRAMES, MIN_FRAMES
from models.teachers.anatomy import BodyPoses, perform, upright
from models.teachers.performance import SIDES, Performance, TeacherError, upright_frame
from models.teachers.skeletons import END, UPRIGHT, Skeleton, uprightness

HIP_M = 0.9
MOST_JOINTS, FURTHEST = 500, 1e6
STANDING = 0.25
"""Share of the frames, the most upright ones, from which it is taken how a skeleton stands whose zero posture does not.
"""
POINT = {"head": (0.0, 0.0, 1.0), "left_foot": (1.0, 0.0, 0.0), "right_foot": (1.0, 0.0, 0.0)}
"""Where bones point, forward, left and up, of somebody who stands upright: the head's up, the feet's ahead."""
LOOKS = 200
"""Frames in which it is looked at which bones bend."""


@dataclass
class _Tree:
    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[list[float]] = field(default_factory=list)
    channels: list[list[str]] = field(default_factory=list)


def perform_bvh(path: str | os.PathLike[str]) -> Performance:
    """What is seen of a skeleton, at every frame of the capture.

    Raises:
        TeacherError: a broken file (which line), or a skeleton that neither names nor build tell (what lacks).
    """
    path = checked(path)
    told = ((f"{path}: line {number}", line.split()) for number, line in lines(path, text(path)))
    start = next(told, ("", [""]))[1][0]
    above = list(takewhile(lambda line: line[1][0].upper() != "MOTION", told)) if start.upper() == "HIERARCHY" else []
    motion = list(islice(told, 2))
    if not above or not motion:
        raise TeacherError(f"{path}: no HIERARCHY and MOTION; is this a .bvh file?")
    skeleton = _hierarchy(above, path)
    tick_s, numbers = _motion(motion, told, sum(map(len, skeleton.channels)), path)
    try:
        with np.errstate(divide="raise", over="raise", invalid="raise"):
            seen, remarks = _seen(path.stem, skeleton, np.arange(float(len(numbers))) * tick_s, numbers)
    except FloatingPointError:
        raise TeacherError(f"{path}: a bone that is needed has no length; export it again") from None
    except TeacherError as error:
        raise TeacherError(f"{path}: {error}") from None
    return replace(seen, remarks=tuple(f"{path}: {remark}" for remark in remarks))


def _seen(name: str, tree: _Tree, time: FloatArray, numbers: FloatArray) -> tuple[Performance, list[str]]:
    some = np.unique(np.linspace(0, len(numbers) - 1, LOOKS).round().astype(int))
    zero = np.zeros((1, numbers.shape[1]))
    looked = _moved(tree, np.concatenate([zero, numbers[some]]), range(len(tree.names)))
    bones = Skeleton(tree.names, tree.parents, np.stack([looked[joint][1] for joint in range(len(tree.names))], 1))
    landmarks, carriers = bones.found()

    def poses(rows: FloatArray) -> BodyPoses:
        moved, marks = _moved(tree, rows, {**landmarks, **carriers}.values()), landmarks | carriers
        places = {mark: moved[joint][1] for mark, joint in marks.items()}
        return BodyPoses({body: moved[joint][0] for body, joint in carriers.items()}, places)

    moving, reference, remarks = poses(numbers), poses(zero), []
    if uprightness(reference.positions)[0] < UPRIGHT:
        how = uprightness(moving.positions)
        stands = np.flatnonzero(how >= max(UPRIGHT, float(np.quantile(how, 1 - STANDING))))
        if not len(stands):
            raise TeacherError("stands upright neither at zero nor in any frame; add a frame that does")
        tips = {body: bones.chain(joint)[1:2] for body, joint in carriers.items() if body in POINT}
        reference = _standing(
            moving, stands, {body: np.array(tree.offsets[tip[0]]) for body, tip in tips.items() if tip}
        )
        remarks.append(f"its zero posture does not stand upright; how it stands is taken from {len(stands)} frames")
    seen = perform(name, "human (BVH)", time, moving, reference)
    legs = [moving.positions[f"{side}_hip"] - moving.positions[f"{side}_ankle"] for side in SIDES]
    size = HIP_M / max(float(np.linalg.norm(leg, axis=1).max()) for leg in legs)
    up = np.zeros(3)
    mean = np.mean(legs, axis=(0, 1))
    up[np.abs(mean).argmax()] = np.sign(mean[np.abs(mean).argmax()])  # the file's own: y in most, z in some
    across = moving.positions["left_hip"][0] - moving.positions["right_hip"][0]
    world = upright_frame(np.cross(up, np.cross(across, up)), up)
    points = size * (seen.points - moving.positions["pelvis"][0]) @ world
    torso = None if seen.torso is None else world.T @ seen.torso
    return replace(seen, points=points - (0, 0, points[..., 2].min()), torso=torso), remarks


def _moved(tree: _Tree, numbers: FloatArray, joints: Iterable[int]) -> dict[int, tuple[FloatArray, FloatArray]]:
    """Joint -> its rotations (F, 3, 3) and places (F, 3) when the channels read numbers (F, channels)."""
    first = np.cumsum([0, *map(len, tree.channels)])
    above = {joint for joint in joints}
    for joint in reversed(range(len(tree.names))):
        if joint in above:
            above.add(tree.parents[joint])
    found = {-1: (np.tile(np.eye(3), (len(numbers), 1, 1)), np.zeros((len(numbers), 3)))}
    for joint in sorted(above - {-1}):
        read = {channel: numbers[:, first[joint] + i] for i, channel in enumerate(tree.channels[joint])}
        angles = {channel[0].upper(): values for channel, values in read.items() if channel.endswith("rotation")}
        shift = np.array(tree.offsets[joint]) + np.zeros((len(numbers), 3))
        if tree.parents[joint] < 0:
            shift += np.stack([read.get(f"{axis}position", np.zeros(len(numbers))) for axis in "xyz"], 1)
        turns, place = found[tree.parents[joint]]
        place = place + np.einsum("fij,fj->fi", turns, shift)
        if angles:
            own = Rotation.from_euler("".join(angles), np.stack([*angles.values()], 1), degrees=True)
            turns = turns @ own.as_matrix()
        found[joint] = turns, place
    return found


def _standing(poses: BodyPoses, frames: NDArray[np.intp], tips: Mapping[str, FloatArray]) -> BodyPoses:
    """The mean of some frames, each turned to face along x with z up; then what carries `tips`, in its own axes, is
    turned so that these point as POINT says."""
    ways = np.stack([upright({name: place[frame] for name, place in poses.positions.items()}) for frame in frames])
    rotations = {
        body: Rotation.from_matrix(ways.swapaxes(-1, -2) @ turns[frames]).mean().as_matrix()
        for body, turns in poses.rotations.items()
    }
    for body, tip in tips.items():
        way = rotations[body] @ tip
        flat = way * (1, 1, 0) if body != "head" else way  # feet turn about the upright alone
        if np.linalg.norm(flat) > 0.1 * np.linalg.norm(way):
            rotations[body] = Rotation.align_vectors([POINT[body]], [flat])[0].as_matrix() @ rotations[body]
    return BodyPoses(
        {body: turn[None] for body, turn in rotations.items()},
        {name: np.einsum("fji,fj->fi", ways, at[frames]).mean(0)[None] for name, at in poses.positions.items()},
    )


def _hierarchy(told: Iterable[tuple[str, list[str]]], path: Path) -> _Tree:
    found, open_, at = _Tree(), [-1], -1
    for where, words in told:
        kind = words[0].upper()
        if kind in ("ROOT", "JOINT", "END"):
            ends = kind == "END"
            name = found.names[at] + END if ends and found.names else " ".join(words[1:])
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
        elif kind == "CHANNELS" and len(words) > 1 and at >= 0 and words[1] == str(len(words) - 2) and len(words) <= 8:
            found.channels[at] = [word.lower() for word in words[2:]]
            if not all(re.fullmatch("[xyz](position|rotation)", channel) for channel in found.channels[at]):
                raise TeacherError(f"{where}: channels are Xposition .. Zposition and Xrotation .. Zrotation")
        else:
            raise TeacherError(f"{where}: {' '.join(words)[:40]!r} is not what stands in a HIERARCHY; export it again")
    if np.abs(found.offsets).max(initial=0) > FURTHEST:
        raise TeacherError(f"{path}: an OFFSET is beyond {FURTHEST:g}; export it again")
    if len(open_) != 1 or not found.names:
        raise TeacherError(f"{path}: braces of the HIERARCHY do not match; export it again")
    return found


def _motion(
    begins: list[tuple[str, list[str]]], told: Iterator[tuple[str, list[str]]], channels: int, path: Path
) -> tuple[float, FloatArray]:
    head = {" ".join(words).partition(":")[0].lower(): (where, words) for where, words in begins}
    if set(head) != {"frames", "frame time"}:
        raise TeacherError(f"{path}: MOTION begins with 'Frames:' and 'Frame Time:'; export it again")
    tick_s = finite(head["frame time"][1][-1], head["frame time"][0])
    count, rows = finite(head["frames"][1][-1], head["frames"][0]), list[FloatArray]()
    for where, words in islice(told, MAX_FRAMES + 1):
        if len(words) != channels:
            raise TeacherError(f"{where}: {len(words)} numbers where the HIERARCHY has {channels} channels")
        rows.append(np.array([finite(word, where) for word in words]))
    if not 1e-4 <= tick_s <= 1 or count != len(rows) or not MIN_FRAMES <= count <= MAX_FRAMES:
        raise TeacherError(
            f"{path}: {len(rows)} frames of {tick_s:g} s where {count:g} are told; {MIN_FRAMES} to {MAX_FRAMES} frames "
            "of 0.0001 to 1 s are read"
        )
    return tick_s, np.array(rows)
