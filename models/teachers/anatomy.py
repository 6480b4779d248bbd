"""From the poses of a teacher's bodies to directions of body parts, the same way for every teacher.

Frames come from anatomy, not from anybody's choice of link axes: in the upright reference posture, left is the
direction from the right shoulder to the left one, up the direction from the ankles to the hips, forward is left x up.
The frame so found rides on the torso from then on; the pelvis, the head and the feet get theirs in the same way.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from models.arrays import FloatArray
from models.teachers.performance import PARTS, SIDES, Performance, unit, upright_frame

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
BEGINS = {
    **{f"{side}_{part}": f"{side}_{start}" for side in SIDES for part, (start, _) in ENDS.items()},
    **{f"{side}_foot": f"{side}_ankle" for side in SIDES},
    "head": "crown",
    "trunk": "waist",
}
"""Part -> point of the stick figure where it is drawn to begin."""


@dataclass(frozen=True, eq=False)
class BodyPoses:
    """Poses of the bodies that matter through time.

    rotations: torso, pelvis, head, left_foot, right_foot, as far as it has them -> (T, 3, 3) rotation in the world.
    positions: landmarks (left_shoulder, ...) and these bodies -> (T, 3) metres in the world (z up).
    """

    rotations: Mapping[str, FloatArray]
    positions: Mapping[str, FloatArray]


def upright(at: Mapping[str, FloatArray]) -> FloatArray:
    """Forward, left and up, as columns (3, 3), of a teacher that stands upright with its landmarks at (3,) each.

    Left from the right shoulder (or hip) to the left one, up from the ankles to the hips, or the world's z where there
    are no legs; the world's own axes where landmarks do not tell.
    """
    for root in ("shoulder", "hip"):
        if all(f"{side}_{root}" in at for side in SIDES):
            legs = [at[f"{s}_hip"] - at[f"{s}_ankle"] for s in SIDES if f"{s}_hip" in at and f"{s}_ankle" in at]
            up = np.sum(legs, axis=0) if legs else np.array([0.0, 0.0, 1.0])
            return upright_frame(at[f"left_{root}"] - at[f"right_{root}"], up)
    return np.eye(3)


def perform(name: str, teacher: str, time: FloatArray, motion: BodyPoses, reference: BodyPoses) -> Performance:
    """What is seen of a teacher whose bodies move like `motion` and that stands upright in frame 0 of `reference`.

    A part both of whose ends are one point shows nothing and is left out.
    """
    frame = upright({name: values[0] for name, values in reference.positions.items()})
    riding = {body: turns @ (reference.rotations[body][0].T @ frame) for body, turns in motion.rotations.items()}
    pointing = {part: riding[body][:, :, axis] for part, (body, axis) in CARRIED.items() if body in riding}
    for side in SIDES:
        for part, (start, end) in ENDS.items():
            if {f"{side}_{start}", f"{side}_{end}"} <= motion.positions.keys():
                span = motion.positions[f"{side}_{end}"] - motion.positions[f"{side}_{start}"]
                if (np.linalg.norm(span, axis=1) > 1e-6).all():
                    pointing[f"{side}_{part}"] = span
    seen = {part: unit(np.einsum("tji,tj->ti", riding["torso"], way)) for part, way in pointing.items()}
    directions = {part: seen[part] for part in PARTS if part in seen}
    points, bones, names = _skeleton(motion.positions, riding)
    begins = {part: names.index(BEGINS[part]) for part in directions if BEGINS[part] in names}
    return Performance(name, teacher, time, directions, points, bones, torso=riding["torso"], begins=begins)


def _skeleton(
    positions: Mapping[str, FloatArray], riding: Mapping[str, FloatArray]
) -> tuple[FloatArray, tuple[tuple[int, int], ...], list[str]]:
    """Points, bones and points' names of a stick figure; nose and toes are drawn where the parts' directions point."""
    at = dict(positions)
    for middle, ends in (("neck", "shoulder"), ("waist", "hip")):
        if {f"{side}_{ends}" for side in SIDES} <= at.keys():
            at[middle] = (at[f"left_{ends}"] + at[f"right_{ends}"]) / 2
    if {"neck", "waist"} <= at.keys():
        size = float(np.linalg.norm(at["neck"][0] - at["waist"][0]))
        if "head" in riding:
            at["crown"] = at["neck"] + 0.45 * size * riding["head"][:, :, 2]
            at["nose"] = at["neck"] + size * (0.3 * riding["head"][:, :, 2] + 0.2 * riding["head"][:, :, 0])
        at |= {
            f"{side}_toes": at[f"{side}_ankle"] + 0.3 * size * riding[f"{side}_foot"][:, :, 0]
            for side in SIDES
            if f"{side}_ankle" in at and f"{side}_foot" in riding
        }
    chains: list[Sequence[str]] = [("waist", "neck", "crown", "nose")]
    for side in SIDES:
        chains.append(("neck", *(f"{side}_{name}" for name in ("shoulder", "elbow", "wrist"))))
        chains.append(("waist", *(f"{side}_{name}" for name in ("hip", "knee", "ankle", "toes"))))
    pairs = [(a, b) for chain in chains for a, b in pairwise(name for name in chain if name in at)]
    names = list(dict.fromkeys(name for pair in pairs for name in pair))
    bones = tuple((names.index(a), names.index(b)) for a, b in pairs)
    return np.stack([at[name] for name in names], axis=1), bones, names
