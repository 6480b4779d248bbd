"""Skeletons of any names and conventions show what the same movement shows without a file, left and right included."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.errors import BodyError
from models.teachers.performance import PARTS, Performance
from models.teachers.performing import perform
from models.teachers.skeletons import Skeleton
from tests.models.captures import moving, postures, shown, write_bvh

ROWS = {
    "CMU's bones": {},
    "Biped": {
        "humerus": "{S} UpperArm", "radius": "{S} Forearm", "hand": "{S} Hand", "femur": "{S} Thigh",
        "tibia": "{S} Calf", "foot": "{S} Foot", "": "Bip01 ",
    },
    "Mixamo": {
        "clavicle": "{Side}Shoulder", "humerus": "{Side}Arm", "radius": "{Side}ForeArm", "hand": "{Side}Hand",
        "femur": "{Side}UpLeg", "tibia": "{Side}Leg", "foot": "{Side}Foot", "toes": "{Side}ToeBase", "": "mixamorig:",
    },
    "SMPL": {
        "clavicle": "{S}_Collar", "humerus": "{S}_Shoulder", "radius": "{S}_Elbow", "hand": "{S}_Wrist",
        "fingers": "{S}_Hand", "femur": "{S}_Hip", "tibia": "{S}_Knee", "foot": "{S}_Ankle", "toes": "{S}_Foot",
    },
    "Xsens": {
        "clavicle": "{Side}Shoulder", "humerus": "{Side}UpperArm", "radius": "{Side}ForeArm", "hand": "{Side}Hand",
        "femur": "{Side}UpperLeg", "tibia": "{Side}LowerLeg", "foot": "{Side}Foot", "toes": "{Side}Toe",
    },
    "Rokoko": {
        "humerus": "{Side}Arm", "radius": "{Side}ForeArm", "hand": "{Side}Hand", "femur": "{Side}Thigh",
        "tibia": "{Side}Shin", "foot": "{Side}Foot", "toes": "{Side}Toe",
    },
    "paths": {
        "humerus": "rig/chest/shoulder_{s}", "radius": "rig/elbow_{s}", "wrist": "rig/wrist_{s}",
        "femur": "rig/pelvis/hip_{s}", "tibia": "rig/knee_{s}", "foot": "rig/ankle_{s}",
    },
    "Rigify": {
        "humerus": "upper_arm.{S}", "radius": "forearm.{S}", "hand": "hand.{S}", "femur": "thigh.{S}",
        "tibia": "shin.{S}", "foot": "foot.{S}", "toes": "toe.{S}",
    },
    "Spanish": {
        "humerus": "Brazo.{S}", "radius": "Antebrazo.{S}", "hand": "Mano.{S}", "femur": "Muslo.{S}",
        "tibia": "Pierna.{S}", "foot": "Pie.{S}",
    },
    "numbers": {"*": "joint_{number}"},
    "numbers in no order": {"*": "{shuffled}"},
}  # fmt: skip
"""Convention -> CMU's bone, side left out -> what the joint is called; "*": all of them; "": a prefix of all."""
SHUFFLED = np.random.default_rng(0).permutation(100)


def called(table: Mapping[str, str]) -> object:
    def name(number: int, bone: str) -> str:
        paired = bone[0] in "lr" and bone not in ("root", "lowerback", "lowerneck")
        side = {"l": "Left", "r": "Right"}[bone[0]] if paired else ""
        form = table.get("*") or table.get(bone[1:] if paired else bone, bone if not table else f"part {number}")
        told = form.format(S=side[:1], s=side[:1].lower(), Side=side, number=number, shuffled=SHUFFLED[number])
        return table.get("", "") + told

    return name


def off(one: Performance, other: Performance) -> dict[str, float]:
    """Part -> mean degrees between two performances."""
    cosine = {part: (one.directions[part] * way).sum(1) for part, way in other.directions.items()}
    return {part: float(np.rad2deg(np.arccos(np.clip(c, -1, 1))).mean()) for part, c in cosine.items()}


@pytest.mark.parametrize("convention", ROWS)
def test_names_do_not_matter(tmp_path: Path, convention: str) -> None:
    seen = perform(write_bvh(tmp_path / "a.bvh", None, called(ROWS[convention])))
    assert set(seen.directions) == set(PARTS) and seen.remarks == ()
    # a hand taken for the end of a forearm of which the wrist is a joint of its own: on one line where it only turns
    assert max(off(shown(), seen).values()) < 0.02


@pytest.mark.parametrize("convention", ["Mixamo", "numbers"])
@pytest.mark.parametrize("seed", range(3))
def test_nor_do_axes_units_and_orders_of_rotation(tmp_path: Path, convention: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    world, order = Rotation.random(rng=rng).as_matrix(), "".join(rng.permutation(list("XYZ")))
    seen = perform(write_bvh(tmp_path / "a.bvh", None, called(ROWS[convention]), world=world, order=order, scale=0.02))
    assert max(off(shown(), seen).values()) < 0.02
    names = {name for a, b in seen.bones for name in (a, b)}
    place = seen.points[:, sorted(names)]
    assert 1.2 < np.ptp(place[0, :, 2]) < 2.2 and np.ptp(place[0, :, 2]) > np.ptp(place[0, :, 0])  # metres, z is up


@pytest.mark.parametrize(
    "without",
    [
        ("lfingers", "rfingers", "lthumb", "rthumb"),
        ("lowerneck",),
        ("ltoes", "rtoes", "lfingers", "rfingers"),
        ("lhand", "rhand"),
    ],
)
def test_what_is_not_there_does_not_matter(tmp_path: Path, without: tuple[str, ...]) -> None:
    seen = perform(write_bvh(tmp_path / "a.bvh", None, called(ROWS["numbers"]), without=without))
    assert set(PARTS) - set(seen.directions) == ({"head"} if "lowerneck" in without else set())
    assert max(off(shown(), seen).values()) < 0.02


def test_the_root_may_be_anywhere() -> None:
    """A figure that hangs from its chest, its arms listed first."""
    arm, leg = (
        [(0, 0.2, 0), (0, 0.5, 0), (0, 0.8, 0)],
        [(0, 0.1, -0.5), (0, 0.1, -0.9), (0, 0.1, -1.3), (0.2, 0.1, -1.3)],
    )
    mirrored = [[(x, -y, z) for x, y, z in limb] for limb in (arm, leg)]
    places = np.array([(0, 0, 0), *mirrored[0], *arm, (0, 0, 0.1), (0, 0, 0.3), (0, 0, -0.5), *mirrored[1], *leg])
    parents = [-1, 0, 1, 2, 0, 4, 5, 0, 7, 0, 9, 10, 11, 12, 9, 14, 15, 16]
    landmarks, carriers = Skeleton([f"{i}" for i in range(18)], parents, places[None].astype(float)).found()
    chains = {
        "right_shoulder": 1,
        "left_shoulder": 4,
        "left_wrist": 6,
        "right_hip": 10,
        "left_hip": 14,
        "left_ankle": 16,
    }
    assert {mark: landmarks[mark] for mark in chains} == chains
    assert (carriers["torso"], carriers["pelvis"], carriers["head"]) == (0, 9, 8)


def test_without_toes_knees_tell_and_without_these_nobody(tmp_path: Path) -> None:
    none = ("ltoes", "rtoes")
    path = write_bvh(tmp_path / "a.bvh", None, called(ROWS["numbers"]), without=none, frames=slice(0, 6))
    with pytest.raises(BodyError, match="left and right cannot be told: no names such as LeftUpLeg") as fault:
        perform(path)
    assert str(fault.value).startswith(str(path)) and "\n" not in str(fault.value)
    perform(write_bvh(tmp_path / "a.bvh", None, called(ROWS["Spanish"]), without=none, frames=slice(0, 6)))


def test_what_has_not_two_legs_and_two_arms_is_refused(tmp_path: Path) -> None:
    for without in (("lclavicle", "rclavicle"), ("lfemur", "rfemur"), ("lclavicle",), ("ltibia", "rtibia")):
        path = write_bvh(tmp_path / "a.bvh", None, called(ROWS["numbers"]), without=without)
        with pytest.raises(BodyError) as fault:
            perform(path)
        assert str(fault.value).startswith(f"{path}: ") and "\n" not in str(fault.value)


def test_a_zero_posture_that_does_not_stand_is_told(tmp_path: Path) -> None:
    """Each joint's axes turned at random: at zero its bones point anywhere (some point all the same way at zero)."""
    zero = Rotation.random(len(moving(None)[0]), rng=np.random.default_rng(1)).as_matrix()
    path = write_bvh(tmp_path / "a.bvh", None, called(ROWS["numbers"]), zero=zero)
    seen = perform(path)
    assert "its zero posture does not stand upright; how it stands is taken from" in seen.remarks[0]
    away = off(shown(), seen)
    limbs = [away[part] for part in PARTS if part.endswith(("arm", "thigh", "shank"))]
    assert max(limbs) < 4 and max(away.values()) < 15
    path = write_bvh(tmp_path / "b.bvh", None, called(ROWS["Mixamo"]), zero=zero)
    head = path.read_text().split("MOTION")[0] + "MOTION\nFrames: 5\nFrame Time: 0.02\n"
    path.write_text(head + (" ".join(["0"] * (3 + 3 * len(zero))) + "\n") * 5)
    with pytest.raises(BodyError, match="stands upright neither at zero nor in any frame"):
        perform(path)


@pytest.mark.parametrize("clip", ["02_01", "02_05"])
@pytest.mark.parametrize("convention", ["Mixamo", "numbers"])
def test_a_real_clip_shows_the_same_as_amc_and_as_bvh(cmu: Path, tmp_path: Path, clip: str, convention: str) -> None:
    amc = cmu / f"{clip}.amc"
    seen = perform(write_bvh(tmp_path / "a.bvh", amc, called(ROWS[convention])))
    assert max(off(perform(amc), seen).values()) < 0.05
    zero = Rotation.random(len(postures(None)[0]), rng=np.random.default_rng(1)).as_matrix()[: len(moving(None)[0])]
    away = off(perform(amc), perform(write_bvh(tmp_path / "b.bvh", amc, called(ROWS[convention]), zero=zero)))
    assert max(away[part] for part in PARTS if part.endswith(("arm", "thigh", "shank"))) < 4
    assert max(away[part] for part in PARTS if part.endswith("foot")) < 8 and away["trunk"] < 11


@pytest.mark.parametrize("clip", ["12_01", "131_01"])
def test_real_captures_without_their_names_show_the_same(cmu: Path, tmp_path: Path, clip: str) -> None:
    path = cmu / "bvh" / f"{clip}.bvh"
    lines = path.read_text().splitlines()
    plain = [
        f"{w[0]} {i}" if (w := line.split()) and w[0] in ("ROOT", "JOINT") else line for i, line in enumerate(lines)
    ]
    (tmp_path / "a.bvh").write_text("\n".join(plain))
    assert max(off(perform(path), perform(tmp_path / "a.bvh")).values()) < 1e-6
