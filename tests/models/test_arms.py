"""Two arms are found in robots whose joints have any names: bones that keep their length, left on the left."""

import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from models.motion import JointTrajectory
from models.teachers.arms import built_arms
from models.teachers.performance import SIDES, TeacherError
from models.teachers.robots import folder
from models.teachers.urdf import perform_urdf, read_urdf

ARMS = {
    "baxter_description/urdf/baxter.urdf": ("{}_s1", "{}_e1", "{}_w1"),
    "tiago_description/robots/tiago_dual.urdf": tuple(f"arm_{{}}_{i}_joint" for i in (2, 4, 6)),
    "tiago_pro_description/urdf/tiago_pro.urdf": tuple(f"arm_{{}}_{i}_joint" for i in (2, 4, 6)),
    "talos_data/robots/talos_reduced.urdf": tuple(f"arm_{{}}_{i}_joint" for i in (2, 4, 5)),
}
NUMBERED = "centauro_description/urdf/centauro.urdf"


def urdf(name: str) -> Path:
    path = next(iter(folder().glob(f"**/{Path(name).name}")), None)
    if path is None:
        pytest.skip(f"{name} is not installed")
    return path


@pytest.mark.parametrize("name", ARMS)
def test_both_arms_are_found(name: str) -> None:
    found = read_urdf(urdf(name))
    there = {
        mark: found.model.names[joint] for mark, joint in found.landmarks.items() if "arm" in mark or mark[-5:] != "x"
    }
    for side in SIDES:
        for mark, joint in zip(("shoulder", "elbow", "wrist"), ARMS[name], strict=True):
            assert there[f"{side}_{mark}"] == joint.format(side)
    assert not {part for part in found.missing if part.endswith("arm")}
    assert "head" in found.carriers
    assert not {*found.slides} & {
        name for names in ARMS.values() for side in SIDES for name in map(str.format, names, [side] * 3)
    }
    assert ("torso_lift_joint" in found.slides) == ("tiago" in name)


def test_arms_that_are_only_numbered_are_left_and_right_by_place() -> None:
    found = read_urdf(urdf(NUMBERED))
    at = found.reference.positions
    for mark, joint in (("shoulder", 2), ("elbow", 4), ("wrist", 6)):
        assert found.model.names[found.landmarks[f"left_{mark}"]] == f"j_arm1_{joint}"
        assert at[f"left_{mark}"][0, 1] > 0.1 > -0.1 > at[f"right_{mark}"][0, 1]
    assert found.model.names[found.carriers["torso"]] == "torso_yaw"


@pytest.mark.parametrize("name", [*ARMS, NUMBERED])
def test_bones_keep_their_length_in_postures_never_looked_at(name: str) -> None:
    found = read_urdf(urdf(name))
    rng = np.random.default_rng(99)
    neutral = pin.neutral(found.model)
    postures = np.array([pin.integrate(found.model, neutral, rng.normal(size=found.model.nv)) for _ in range(40)])
    at = found.motion(postures).positions
    for side in SIDES:
        for one, two in (("shoulder", "elbow"), ("elbow", "wrist")):
            lengths = np.linalg.norm(at[f"{side}_{one}"] - at[f"{side}_{two}"], axis=1)
            assert np.ptp(lengths) < 0.2 * lengths.max() and lengths.min() > 0.1
        away = np.linalg.norm(at[f"{side}_shoulder"] - at[f"{side}_wrist"], axis=1)
        assert np.ptp(away) > 0.2 * away.max()  # the elbow bends


@pytest.mark.parametrize(
    "name", ["pr2_description/urdf/pr2.urdf", "g1_description/urdf/g1_29dof_rev_1_0.urdf", *list(ARMS)[:1]]
)
def test_names_do_not_matter(name: str) -> None:
    """The same bones without any names as where these told before (numbers keep the order of the alphabet, and joints
    with it their own)."""
    path = urdf(name)
    text, named = path.read_text(), read_urdf(path)
    joint = re.compile(r'(<(?:joint|mimic)\b[^>]*?(?:name|joint)=")([^"]+)(")')
    numbers = {old: f"x{number:04}" for number, old in enumerate(sorted({told[1] for told in joint.findall(text)}))}
    model = pin.buildModelFromXML(joint.sub(lambda told: told[1] + numbers[told[2]] + told[3], text))
    assert [numbers.get(old, old) for old in named.model.names] == list(model.names)
    found = built_arms(model, [joint for mark, joint in named.landmarks.items() if mark.endswith(("hip", "knee"))])
    data = named.model.createData()
    pin.forwardKinematics(named.model, data, pin.neutral(named.model))
    for side in SIDES:
        for one, two in (("shoulder", "elbow"), ("elbow", "wrist")):
            bones = [
                data.oMi[joints[f"{side}_{two}"]].translation - data.oMi[joints[f"{side}_{one}"]].translation
                for joints in (found, named.landmarks)
            ]
            cosine = min(np.dot(*bones) / np.prod(np.linalg.norm(bones, axis=1)), 1.0)
            assert np.rad2deg(np.arccos(cosine)) < 12, (side, one)


@pytest.mark.parametrize(
    "name",
    [
        "alexander_description/urdf/alexander_v1.lowerBodyOnly.urdf", "go2_description/urdf/go2.urdf",
        "allegro_hand_description/urdf/allegro_left_hand.urdf", "panda_description/urdf/panda.urdf",
        "anymal_b_simple_description/robots/anymal.urdf", "solo_description/robots/solo12.urdf",
    ],
)  # fmt: skip
def test_who_has_no_two_arms_is_given_none(name: str) -> None:
    try:
        found = read_urdf(urdf(name))
    except TeacherError:
        return
    assert not [mark for mark in found.landmarks if mark.endswith(("shoulder", "elbow", "wrist"))]


def test_baxter_shows_what_its_elbow_does() -> None:
    path = urdf("baxter_description/urdf/baxter.urdf")
    bent = np.linspace(0, np.pi / 2, 5)
    seen, _ = perform_urdf(path, JointTrajectory("bend", np.arange(5.0), ("left_e1",), bent[:, None]))
    turned = np.rad2deg(np.arccos(seen.directions["left_forearm"] @ seen.directions["left_forearm"][0]))
    np.testing.assert_allclose(turned, np.rad2deg(bent), atol=1.5)
    assert np.ptp(seen.directions["left_upper_arm"], axis=0).max() < 1e-9
    assert np.ptp(seen.directions["right_forearm"], axis=0).max() < 1e-9
