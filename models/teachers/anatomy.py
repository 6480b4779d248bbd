"""From the poses of a teacher's bodies to directions of body parts, the same way for every teacher.

Frames come from anatomy, not from anybody's choice of link axes: in the upright reference posture, left is the
direction from the right shoulder to the left one, up the direction from the ankles to the hips, forward is left x up.
The frame so found rides on the torso from then on; the pelvis, the head and the feet get theirs in the same way.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from models.teachers.performance import SIDES, Performance, unit, upright_frame

Array = NDArray[np.float64]
ENDS: dict[str, tuple[str, str]] = {
    "upper_arm": ("shoulder", "elbow"),
    "forearm": ("elbow", "wrist"),
    "thigh": ("hip", "knee"),
    "shank": ("knee", "ankle"),
}
"""Part -> landmarks where it begins and ends."""
CARRIED: dict[str, tuple[str, int]] = {
    "head": ("head", 0),
    "trunk": ("pelvis", 2),
    "left_foot": ("left_foot", 0),
    "right_foot": ("right_foot", 0),
}
"""Part -> body that carries it and which of forward, left, up in the reference posture it is."""
BODIES = ("torso", "pelvis", "head", "left_foot", "right_foot")
LANDMARKS = tuple(f"{side}_{name}" for side in SIDES for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle"))


@dataclass(frozen=True, eq=False)
class BodyPoses:
    """Poses of the bodies that matter through time.

    rotations: each of BODIES -> (T, 3, 3) rotation in the world.
    positions: each of LANDMARKS, and of BODIES -> (T, 3) metres in the world (z up).
    """

    rotations: Mapping[str, Array]
    positions: Mapping[str, Array]


def upright(at: Mapping[str, Array]) -> Array:
    """Forward, left and up, as columns (3, 3), of a teacher that stands upright with its LANDMARKS at (3,) each."""
    left = at["left_shoulder"] - at["right_shoulder"]
    up = at["left_hip"] + at["right_hip"] - at["left_ankle"] - at["right_ankle"]
    return upright_frame(left, up)


def perform(name: str, teacher: str, time: Array, motion: BodyPoses, reference: BodyPoses) -> Performance:
    """What is seen of a teacher whose bodies move like `motion` and that stands upright in frame 0 of `reference`."""
    frame = upright({name: values[0] for name, values in reference.positions.items()})
    offset = {body: reference.rotations[body][0].T @ frame for body in BODIES}
    torso = motion.rotations["torso"] @ offset["torso"]

    def in_torso(vectors: Array) -> Array:
        return unit(np.einsum("tji,tj->ti", torso, vectors))

    directions = {}
    for side in SIDES:
        for part, (start, end) in ENDS.items():
            span = motion.positions[f"{side}_{end}"] - motion.positions[f"{side}_{start}"]
            directions[f"{side}_{part}"] = in_torso(span)
    for part, (body, axis) in CARRIED.items():
        directions[part] = in_torso((motion.rotations[body] @ offset[body])[:, :, axis])
    points, bones = _skeleton(motion, offset)
    return Performance(name, teacher, time, directions, points, bones)


def _skeleton(motion: BodyPoses, offset: Mapping[str, Array]) -> tuple[Array, tuple[tuple[int, int], ...]]:
    """Points and bones of a stick figure; nose and toes are drawn where the parts' directions point."""
    at = dict(motion.positions)
    at["neck"] = (at["left_shoulder"] + at["right_shoulder"]) / 2
    at["waist"] = (at["left_hip"] + at["right_hip"]) / 2
    size = float(np.linalg.norm(at["neck"][0] - at["waist"][0]))
    ahead = {body: (motion.rotations[body] @ offset[body]) for body in ("head", "left_foot", "right_foot")}
    at["crown"] = at["neck"] + 0.45 * size * ahead["head"][:, :, 2]
    at["nose"] = at["neck"] + size * (0.3 * ahead["head"][:, :, 2] + 0.2 * ahead["head"][:, :, 0])
    chains: list[Sequence[str]] = [("waist", "neck", "crown", "nose")]
    for side in SIDES:
        at[f"{side}_toes"] = at[f"{side}_ankle"] + 0.3 * size * ahead[f"{side}_foot"][:, :, 0]
        chains.append(("neck", *(f"{side}_{name}" for name in ("shoulder", "elbow", "wrist"))))
        chains.append(("waist", *(f"{side}_{name}" for name in ("hip", "knee", "ankle", "toes"))))
    names = list(dict.fromkeys(name for chain in chains for name in chain))
    bones = [(names.index(a), names.index(b)) for chain in chains for a, b in pairwise(chain)]
    return np.stack([at[name] for name in names], axis=1), tuple(bones)
