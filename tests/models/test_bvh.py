"""Skeletons in .bvh files: directions against rotations multiplied by hand, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import BodyError
from models.teachers.performing import perform

AXES = {"X": 0, "Y": 1, "Z": 2}
LIMBS = """
JOINT {s}Shoulder
{{
OFFSET {x} 1 0
CHANNELS 3 Zrotation Yrotation Xrotation
JOINT {s}Arm
{{
OFFSET {x} 0 0
CHANNELS 3 Zrotation Xrotation Yrotation
JOINT {s}ForeArm
{{
OFFSET {x} 0 0
CHANNELS 3 Yrotation Zrotation Xrotation
JOINT {s}Hand
{{
OFFSET {x} 0 0
CHANNELS 3 Zrotation Yrotation Xrotation
End Site
{{
OFFSET {x} 0 0
}}
}}
}}
}}
}}
"""
LEGS = """
JOINT {s}UpLeg
{{
OFFSET {x} 0 0
CHANNELS 3 Zrotation Yrotation Xrotation
JOINT {s}Leg
{{
OFFSET 0 -4 0
CHANNELS 3 Zrotation Yrotation Xrotation
JOINT {s}Foot
{{
OFFSET 0 -4 0
CHANNELS 3 Zrotation Yrotation Xrotation
End Site
{{
OFFSET 0 0 1
}}
}}
}}
}}
"""
ORDERS = ["ZYX", "ZYX", "ZYX", "ZXY", "YZX", "ZYX", "ZYX", "ZXY", "YZX", "ZYX", *["ZYX"] * 6]
"""Of hips, spine, left and right arms, left and right legs (y is up, z forward, left is +x)."""


def skeleton(frames: np.ndarray) -> str:
    """Text of a file with (T, 6 + 45) numbers."""
    both = [(side, x) for side, x in (("Left", 1), ("Right", -1))]
    arms = "".join(LIMBS.format(s=s, x=x) for s, x in both)
    legs = "".join(LEGS.format(s=s, x=x) for s, x in both)
    rows = "\n".join(" ".join(f"{value:.9f}" for value in frame) for frame in frames)
    return (
        "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\n"
        "CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n"
        "JOINT Spine\n{\nOFFSET 0 2 0\nCHANNELS 3 Zrotation Yrotation Xrotation\n" + arms + "}\n" + legs + "}\n"
        f"MOTION\nFrames: {len(frames)}\nFrame Time: 0.02\n{rows}\n"
    )


def turned(order: str, degrees: np.ndarray) -> np.ndarray:
    """R_1 R_2 R_3 about a joint's own axes."""
    found = np.eye(3)
    for letter, angle in zip(order, np.deg2rad(degrees), strict=True):
        i, j = [(1, 2), (2, 0), (0, 1)][AXES[letter]]
        one = np.eye(3)
        one[i, i] = one[j, j] = np.cos(angle)
        one[i, j], one[j, i] = -np.sin(angle), np.sin(angle)
        found = found @ one
    return found


@given(st.integers(0, 10_000))
def test_directions_are_the_products_of_rotations_down_the_chain(tmp_path_factory: pytest.TempPathFactory, seed: int):
    frames = np.random.default_rng(seed).uniform(-170, 170, (4, 51))
    path = tmp_path_factory.mktemp("bvh") / "one.bvh"
    path.write_text(skeleton(frames))
    shown = perform(path)
    for frame, directions in ((t, {p: d[t] for p, d in shown.directions.items()}) for t in range(4)):
        turns = [turned(order, part) for order, part in zip(ORDERS, frames[frame, 3:].reshape(16, 3), strict=True)]
        torso = turns[0] @ turns[1]
        arm = torso @ turns[2] @ turns[3]
        wanted = {
            "left_upper_arm": arm @ [1, 0, 0],
            "left_forearm": arm @ turns[4] @ [1, 0, 0],
            "right_thigh": turns[0] @ turns[13] @ [0, -1, 0],
            "right_shank": turns[0] @ turns[13] @ turns[14] @ [0, -1, 0],
            "right_foot": turns[0] @ turns[13] @ turns[14] @ turns[15] @ [0, 0, 1],
            "trunk": turns[0] @ [0, 1, 0],
        }
        for part, way in wanted.items():
            x, y, z = torso.T @ way  # forward is +z, left is +x, up is +y
            np.testing.assert_allclose(directions[part], [z, x, y], atol=1e-6)
    assert "head" not in shown.directions
    hips = np.linalg.norm(shown.points[0] - shown.points[0].mean(0), axis=1)
    assert hips.max() < 2.5  # metres, whatever the file's unit


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t.replace("HIERARCHY", "HIERACHY"), "is this a .bvh file"),
        (lambda t: t.replace("OFFSET 0 2 0", "OFFSET 0 2"), "not what stands in a HIERARCHY"),
        (lambda t: t.replace("OFFSET 0 2 0", "OFFSET 0 two 0"), "line 8: 'two' is not a finite number"),
        (lambda t: t.replace("CHANNELS 6", "CHANNELS 5"), "not what stands in a HIERARCHY"),
        (lambda t: t.replace("Zrotation", "Wrotation"), "channels are"),
        (lambda t: t.replace("}\nMOTION", "MOTION"), "braces"),
        (lambda t: t.replace("Frames: 4", "Frames: 5"), "4 frames of 0.02 s where 5 are told"),
        (lambda t: t.replace("Frame Time: 0.02", "Frame Time: 0"), "4 frames of 0 s"),
        (lambda t: t.replace("Frame Time", "Frame Tome"), "MOTION begins with"),
        (lambda t: t.rstrip()[:-12] + "\n", "where the HIERARCHY has 51 channels"),
        (
            lambda t: t.replace("LeftUpLeg", "x").replace("0 -4 0", "0 -9 0", 2),
            "no two legs and two arms, alike in pairs",
        ),
        (lambda t: t.replace("JOINT Spine", "ROOT Spine"), "one ROOT first"),
        (lambda t: t[:40], "is this a .bvh file"),
    ],
)
def test_broken_files_get_one_line(tmp_path: Path, change, said: str):
    path = tmp_path / "one.bvh"
    path.write_text(change(skeleton(np.zeros((4, 51)))))
    with pytest.raises(BodyError, match=said) as refused:
        perform(path)
    assert "\n" not in str(refused.value)
