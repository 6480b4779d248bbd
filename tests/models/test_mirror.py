"""The mirror agrees with Pinocchio; acts move one part alone; any URDF teaches as far as its limbs go."""

from pathlib import Path

import numpy as np
import pytest

from models.errors import BodyError
from models.hoap2.facts import JOINTS
from models.hoap2.kinematics import directions
from models.loading import load_body
from models.mirror import Mirror, blurred
from models.motion import JointTrajectory
from models.teachers import robots
from models.teachers.acts import LEAST, joints_of, movable, single_act
from models.teachers.demonstrations import DEMONSTRATIONS
from models.teachers.performance import PARTS, TeacherError
from models.teachers.performing import joint_motion, perform_motion
from models.teachers.urdf import perform_urdf, read_urdf, remarks

TOLD_APART_DEG = {"g1": 12.0}
"""G1's joints of a ball lie apart along the limb; which of them is the shoulder is a matter of taste."""


def test_mirror_shows_what_pinocchio_computes() -> None:
    body = load_body("hoap2", copies=1)
    low, high = body.joint_range.T
    angles = np.random.default_rng(0).uniform(low, high, (20, 25))
    mirror = Mirror(body)
    assert mirror.parts == PARTS and body.joints == JOINTS
    np.testing.assert_allclose(mirror.shown(angles), directions(angles), atol=1e-9)


def test_arrows_run_along_the_limbs_from_joint_to_joint() -> None:
    body = load_body("hoap2", copies=1)
    low, high = body.joint_range.T
    mirror = Mirror(body)
    begins, ways = mirror.arrows(np.random.default_rng(0).uniform(low, high, (20, 25)))
    for inner, outer in (("left_thigh", "left_shank"), ("right_upper_arm", "right_forearm")):
        one, other = mirror.parts.index(inner), mirror.parts.index(outer)
        span = begins[:, other] - begins[:, one]
        along = np.einsum("ti,ti->t", span, ways[:, one]) / np.linalg.norm(span, axis=1)
        assert along.min() > 0.9, (inner, along.min())  # elbows and knees lie a little beside the axis


def test_every_copy_sees_itself() -> None:
    body = load_body("hoap2", copies=3)
    mirror = Mirror(body)
    body.reset()
    body.act(np.random.default_rng(1).uniform(-0.4, 0.4, (3, 25)))
    np.testing.assert_allclose(mirror.look(), mirror.shown(body.joint_angles), atol=1e-12)


def test_noise_of_seeing() -> None:
    true = np.tile([0.0, 0.0, 1.0], (20_000, 1))
    seen = blurred(true, np.deg2rad(3), np.random.default_rng(2))
    np.testing.assert_allclose(np.linalg.norm(seen, axis=1), 1)
    angle = np.rad2deg(np.arccos(np.clip(seen[:, 2], -1, 1)))
    assert angle.mean() == pytest.approx(3 * np.sqrt(np.pi / 2), rel=0.02)
    np.testing.assert_array_equal(blurred(true, 0.0, np.random.default_rng(2)), true)


def test_mirror_refuses_another_body(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(
        """<mujoco><worldbody><body><joint name="hinge" range="-60 60"/><geom size="0.1"/></body></worldbody>
        <actuator><position joint="hinge" kp="5"/></actuator></mujoco>"""
    )
    with pytest.raises(BodyError, match=r"limb directions can be shown to hoap2, hoap2-worn, .* only"):
        Mirror(load_body(tmp_path / "arm.xml"))


@pytest.mark.parametrize("robot", robots.ROBOTS)
def test_an_act_moves_its_part_and_what_hangs_from_it(robot: str) -> None:
    rng = np.random.default_rng(3)
    for part in movable(robot):
        seen = single_act(robot, part, rng).directions
        turned = {name: float(np.arccos(np.clip(d[0] @ d[-1], -1, 1))) for name, d in seen.items()}
        assert turned[part] >= LEAST - 1e-6
        side, _, name = part.partition("_")
        inner = {"forearm": ["upper_arm"], "shank": ["thigh"], "foot": ["thigh", "shank"]}.get(name, [])
        other = {"left": "right", "right": "left"}.get(side)
        still = [f"{side}_{one}" for one in inner] + [one for one in PARTS if other and one.startswith(other)]
        assert all(turned[one] < 1e-6 for one in still), part


def test_acts_say_what_cannot_be() -> None:
    with pytest.raises(TeacherError, match="teacher g1: no joint moves its head alone"):
        joints_of("g1", "head")
    with pytest.raises(TeacherError, match="unknown body part 'left_toot'"):
        joints_of("icub", "left_toot")
    assert "trunk" not in movable("romeo"), "Romeo's trunk only turns about the spine"


@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_limbs_of_a_urdf_are_found_by_name(name: str) -> None:
    """What a file's names tell alone agrees with what is told of the built-in robots beside them."""
    robot = DEMONSTRATIONS[name].robot
    path = robots.folder() / robots.ROBOTS[robot].file
    table = perform_motion(robot, joint_motion(name)).directions
    found, _ = perform_urdf(path, joint_motion(name))
    assert set(PARTS) - set(found.directions) <= {"head"}
    for part, way in found.directions.items():
        off = np.rad2deg(np.arccos(np.clip((way * table[part]).sum(1), -1, 1)))
        assert off.max() <= TOLD_APART_DEG.get(robot, 0.1), part


def urdf(names: dict[str, str], mesh: str = "") -> str:
    """A chain for each child -> parent, a hinge about y and 0.2 m down each."""
    links = "".join(f'<link name="{name}">{mesh}</link>' for name in ("base", *names))
    joints = "".join(
        f'<joint name="{child}_joint" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0 {0.1 if "left" in child and parent == "base" else 0} -0.2"/><axis xyz="0 1 0"/>'
        '<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>'
        for child, parent in names.items()
    )
    return f'<robot name="toy">{links}{joints}</robot>'


ONE_LEG = {"left_hip": "base", "left_knee": "left_hip", "left_ankle": "left_knee"}


def moving(*joints: str) -> JointTrajectory:
    angles = np.tile(np.linspace(0, 0.5, 5)[:, None], (1, len(joints)))
    return JointTrajectory("swing.csv", np.arange(5) * 0.1, joints, angles)


def test_one_limb_is_enough(tmp_path: Path) -> None:
    path = tmp_path / "toy.urdf"
    mesh = '<visual><geometry><mesh filename="package://toy/meshes/leg.stl"/></geometry></visual>'
    path.write_text(urdf(ONE_LEG, mesh))
    seen, found = perform_urdf(path, moving("left_hip_joint"))
    assert set(seen.directions) == {"left_thigh", "left_shank", "left_foot"}
    np.testing.assert_allclose(seen.directions["left_thigh"][-1], [-np.sin(0.5), 0, -np.cos(0.5)], atol=1e-9)
    said = remarks(found, path)
    assert "not in left_upper_arm (no shoulder and elbow)" in said[0] and "right_thigh (no hip and knee)" in said[0]
    assert "meshes are not there, first 'package://toy/meshes/leg.stl'; kinematics is used" in said[1]


def test_urdf_errors_name_what_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "toy.urdf"
    path.write_text(urdf({"wheel": "base", "left_hip": "base"}))
    with pytest.raises(TeacherError, match=r"no limb was found: of left_shoulder.*it has left_hip; name joints so"):
        read_urdf(path)
    path.write_text(urdf(ONE_LEG))
    with pytest.raises(TeacherError, match=r"unknown joint of toy 'left_hop_joint'.*did you mean 'left_hip_joint'"):
        perform_urdf(path, moving("left_hop_joint"))
    path.write_text('<!DOCTYPE robot [<!ENTITY a "b">]>' + urdf(ONE_LEG))
    with pytest.raises(TeacherError, match="declares entities"):
        read_urdf(path)
    path.write_text("<html/>")
    with pytest.raises(TeacherError, match="holds no <robot>"):
        read_urdf(path)
    with pytest.raises(BodyError, match="no such file"):
        read_urdf(tmp_path / "absent.urdf")
