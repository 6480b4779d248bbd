"""What is seen of robots: analytic poses, left is left, and nothing depends on size, place or heading."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.errors import BodyError
from models.motion import JointTrajectory
from models.teachers import anatomy, robots
from models.teachers.acts import single_act
from models.teachers.demonstrations import DEMONSTRATIONS
from models.teachers.performance import PARTS, Performance, TeacherError
from models.teachers.performing import joint_motion, minimum_jerk, perform, perform_motion

FORWARD, LEFT, UP = np.eye(3)
ARMS_AT_ZERO = {"romeo": (FORWARD, FORWARD), "hoap2": (FORWARD, FORWARD), "g1": (-UP, FORWARD)}
"""Upper arm and forearm in each robot's zero posture; all others let them hang."""
LIMITS_ONE_JOINT_OFF = {"simple_humanoid"}
"""Its URDF lists ranges that belong to neighbouring joints (a knee of -2.1 .. 0.7, an ankle roll of 0 .. 2.62)."""

performed = cache(perform)


def still(robot: str, **degrees: float) -> dict[str, np.ndarray]:
    """Directions of a robot that holds still, a few joints turned."""
    angles = np.tile(np.deg2rad(list(degrees.values())), (3, 1))
    joints = tuple(degrees) or tuple(robots.load(robot).limits)[:1]
    angles = angles if degrees else np.zeros((3, 1))
    seen = perform_motion(robot, JointTrajectory("still", np.arange(3.0), joints, angles))
    return {part: directions[0] for part, directions in seen.directions.items()}


def degrees_off(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.rad2deg(np.arccos(np.clip(one @ other, -1, 1))))


@pytest.mark.parametrize("robot", robots.ROBOTS)
def test_zero_posture(robot: str) -> None:
    """Legs hang, feet, nose and trunk are upright; elbows a little off their line are allowed for, 7 deg."""
    seen = still(robot)
    assert set(seen) == set(PARTS)
    upper_arm, forearm = ARMS_AT_ZERO.get(robot, (-UP, -UP))
    for side in ("left", "right"):
        for part, where in {"upper_arm": upper_arm, "forearm": forearm, "thigh": -UP, "shank": -UP}.items():
            assert degrees_off(seen[f"{side}_{part}"], where) < 7, part
        assert degrees_off(seen[f"{side}_foot"], FORWARD) < 1e-6
    assert degrees_off(seen["head"], FORWARD) < 1e-6
    assert degrees_off(seen["trunk"], UP) < 1e-6


SINE, COSINE = np.sin(np.deg2rad(40)), np.cos(np.deg2rad(40))


@pytest.mark.parametrize(
    ("robot", "joints", "part", "direction"),
    [
        ("human", {"left_shoulder_Z": 90}, "left_forearm", FORWARD),
        ("human", {"left_shoulder_X": 90}, "left_upper_arm", LEFT),
        ("human", {"right_shoulder_X": 90}, "right_upper_arm", -LEFT),
        ("human", {"right_elbow_Z": 90}, "right_forearm", FORWARD),
        ("human", {"left_hip_Z": 40}, "left_thigh", [SINE, 0, -COSINE]),
        ("human", {"left_knee_Z": 40}, "left_shank", [-SINE, 0, -COSINE]),
        ("icub", {"r_shoulder_roll": 90}, "right_forearm", -LEFT),
        ("icub", {"l_shoulder_roll": 90}, "left_forearm", LEFT),
        ("icub", {"torso_pitch": 40}, "trunk", [-SINE, 0, COSINE]),
        ("icub", {"torso_pitch": 40}, "right_thigh", [SINE, 0, -COSINE]),
        ("icub", {"neck_yaw": 40}, "head", [COSINE, SINE, 0]),
        ("romeo", {"RHipPitch": -40}, "right_thigh", [SINE, 0, -COSINE]),
        ("romeo", {"RHipPitch": -40}, "right_foot", [COSINE, 0, SINE]),
        ("romeo", {"NeckPitch": 40}, "head", [COSINE, 0, -SINE]),
        ("g1", {"left_knee_joint": 40}, "left_shank", [-SINE, 0, -COSINE]),
        ("g1", {"waist_pitch_joint": 20}, "trunk", [-np.sin(np.deg2rad(20)), 0, np.cos(np.deg2rad(20))]),
        ("talos", {"arm_left_2_joint": 90}, "left_upper_arm", LEFT),
        ("talos", {"head_1_joint": 40}, "head", [COSINE, 0, -SINE]),
        ("simple_humanoid", {"RLEG_HIP_P": -40}, "right_thigh", [SINE, 0, -COSINE]),
        ("simple_humanoid", {"LARM_SHOULDER_R": 40}, "left_forearm", [0, SINE, -COSINE]),
        ("hoap2", {"left_arm_joint_1": 40}, "left_forearm", [COSINE, 0, -SINE]),
        ("hoap2", {"body_joint_1": 40}, "trunk", [-SINE, 0, COSINE]),
        ("hoap2", {"head_joint_1": 40}, "head", [COSINE, SINE, 0]),
    ],
)
def test_one_joint_at_a_time(robot: str, joints: dict[str, float], part: str, direction: list[float]) -> None:
    """Within 10 deg, for elbows lie a little off their line and some shoulder axes are tilted."""
    assert degrees_off(still(robot, **joints)[part], np.asarray(direction, dtype=float)) < 10


@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_demonstrations_are_movements_like_a_persons(name: str) -> None:
    seen = performed(name)
    assert set(seen.directions) == set(PARTS)
    assert 4 <= seen.time[-1] <= 8
    np.testing.assert_allclose(np.diff(seen.time), 0.02, atol=1e-12)
    speed = max(np.linalg.norm(np.diff(way, axis=0), axis=1).max() / 0.02 for way in seen.directions.values())
    assert 1.5 < speed < 7
    for way in seen.directions.values():
        np.testing.assert_allclose(np.linalg.norm(way, axis=1), 1, atol=1e-12)
        assert np.abs(np.diff(way, 2, axis=0)).max() / 0.02**2 < 80, "a jump"
        np.testing.assert_allclose(way[0], way[-1], atol=0.05)
    bones = np.linalg.norm([seen.points[:, a] - seen.points[:, b] for a, b in seen.bones], axis=2)
    assert (bones > 0).all() and np.abs(seen.points).max() < 3


@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_demonstrations_keep_the_robots_limits(name: str) -> None:
    robot = DEMONSTRATIONS[name].robot
    if robot not in LIMITS_ONE_JOINT_OFF:
        joint_motion(name).check_ranges(robots.load(robot).limits)


@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_the_standing_foot_stays(name: str) -> None:
    demonstration = DEMONSTRATIONS[name]
    configurations = robots.load(demonstration.robot).postures(joint_motion(name))
    poses = robots.load(demonstration.robot).motion(configurations, demonstration.standing_on)
    foot = poses.positions[f"{demonstration.standing_on}_foot"]
    np.testing.assert_allclose(foot, foot[:1].repeat(len(foot), axis=0), atol=1e-9)


def test_the_same_name_gives_the_same_bytes() -> None:
    one, other = perform("icub-wave"), perform("icub-wave")
    assert all(one.directions[part].tobytes() == other.directions[part].tobytes() for part in PARTS)


def test_minimum_jerk() -> None:
    """Between rests the peak speed is 15/8 of the mean one, at the middle, and acceleration vanishes at both ends."""
    time, joints, angles = minimum_jerk(((0.0, {"a": 1.0}), (2.0, {"a": 2.0, "b": 1.0}), (3.0, {"b": -1.0})))
    assert joints == ("a", "b")
    speed = np.gradient(angles[:, 0], time)
    assert speed.max() == pytest.approx(15 / 8 * 0.5, rel=1e-3)
    assert time[speed.argmax()] == pytest.approx(1.0)
    assert abs(np.diff(angles[:3, 0], 2)[0]) / 0.02**2 < 0.2
    np.testing.assert_allclose(angles[time >= 2, 0], 2)
    np.testing.assert_allclose(angles[[0, 50, 100, 150], 1], [0, 0.5, 1, -1], atol=1e-12)


@given(st.integers(0, 2**31), st.floats(0.5, 3))
@settings(max_examples=10, deadline=None)
def test_size_place_and_heading_do_not_matter(seed: int, size: float) -> None:
    """A teacher that is larger, turned, and turning and walking away while it acts, is seen to do the same."""
    rng = np.random.default_rng(seed)
    configurations = robots.load("human").postures(joint_motion("human-raise"))[::20]
    time = np.arange(len(configurations)) * 0.4
    poses, reference = robots.load("human").motion(configurations), robots.load("human").reference
    turn = Rotation.from_rotvec(np.outer(time, rng.normal(size=3)) + rng.normal(size=3)).as_matrix()
    away = np.outer(time, rng.normal(size=3)) + rng.normal(size=3)
    moved = anatomy.BodyPoses(
        {body: turn @ rotation for body, rotation in poses.rotations.items()},
        {name: size * np.einsum("tij,tj->ti", turn, place) + away for name, place in poses.positions.items()},
    )
    seen = anatomy.perform("here", "human", time, poses, reference)
    elsewhere = anatomy.perform("there", "human", time, moved, reference)
    for part in PARTS:
        np.testing.assert_allclose(elsewhere.directions[part], seen.directions[part], atol=1e-9)


@given(st.integers(0, 2**31))
@settings(max_examples=10, deadline=None)
def test_it_is_drawn_from_in_front_whichever_way_it_turns(seed: int) -> None:
    """Turned about the upright while it acts, it is drawn as it was; its left shoulder is on the left."""
    rng = np.random.default_rng(seed)
    seen = perform("human-raise")
    turn = Rotation.from_rotvec(np.outer(np.cumsum(rng.normal(size=len(seen.time))), UP)).as_matrix()
    assert seen.torso is not None
    turned = replace(
        seen, points=np.einsum("tij,tkj->tki", turn, seen.points), torso=np.einsum("tij,tjk->tik", turn, seen.torso)
    )
    np.testing.assert_allclose(turned.ahead, seen.ahead, atol=1e-9)
    across = (turned.torso.swapaxes(1, 2) @ UP)[:, 2]
    assert (across > 0.9).all()  # it stands
    side = seen.torso[:, :, 1]
    yaw = np.arctan2(seen.torso[:, 1, 0] - seen.torso[:, 0, 1], seen.torso[:, 0, 0] + seen.torso[:, 1, 1])
    assert np.abs(np.cos(yaw) * side[:, 0] + np.sin(yaw) * side[:, 1]).max() < 0.2


@pytest.mark.parametrize("name", ["icub-reach", "g1-squat"])
def test_parts_point_along_the_bones_that_are_drawn(name: str) -> None:
    """Knee to ankle, elbow to wrist ...: the bone that begins where the part begins."""
    seen = perform(name)
    assert {"head", "trunk", "left_foot"} <= set(seen.begins) <= set(seen.directions)
    for part in (f"{side}_{limb}" for side in ("left", "right") for limb in anatomy.ENDS):
        begin = seen.begins[part]
        end = next(b for a, b in seen.bones if a == begin)
        bone = seen.ahead[:, end] - seen.ahead[:, begin]
        bone /= np.linalg.norm(bone, axis=1, keepdims=True)
        np.testing.assert_allclose(seen.pointing[part], bone, atol=1e-9, err_msg=part)
    assert not replace(seen, torso=None).pointing


def test_limbs_of_other_lengths_do_not_matter() -> None:
    """Each segment stretched by a factor of its own points where it pointed."""
    poses = reference = robots.load("icub").reference
    at = dict(poses.positions)
    for side in ("left", "right"):
        for chain, factors in ((("shoulder", "elbow", "wrist"), (0.5, 3)), (("hip", "knee", "ankle"), (2, 0.7))):
            for start, end, factor in zip(chain, chain[1:], factors, strict=False):
                span = poses.positions[f"{side}_{end}"] - poses.positions[f"{side}_{start}"]
                at[f"{side}_{end}"] = at[f"{side}_{start}"] + factor * span

    def seen(positions: dict[str, np.ndarray]) -> Performance:
        rotations = {body: rotation.repeat(3, axis=0) for body, rotation in poses.rotations.items()}
        places = {name: place.repeat(3, axis=0) for name, place in positions.items()}
        return anatomy.perform("x", "icub", np.arange(3.0), anatomy.BodyPoses(rotations, places), reference)

    for part in PARTS:
        np.testing.assert_allclose(seen(at).directions[part], seen(dict(poses.positions)).directions[part], atol=1e-12)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("icub-wav", "unknown demonstration 'icub-wav'; there are .*; did you mean 'icub-wave'"),
        ("nowhere/clip.amc", "nowhere/clip.amc: there is no such file"),
        ("clip.bvh", "clip.bvh: there is no such file"),
    ],
)
def test_unknown_demonstrations(name: str, message: str) -> None:
    with pytest.raises(BodyError, match=message):
        perform(name)


def test_unknown_joints_and_teachers() -> None:
    trajectory = JointTrajectory("x", np.arange(3.0), ("l_elbo",), np.zeros((3, 1)))
    with pytest.raises(TeacherError, match=r"x: unknown joint of icub 'l_elbo'; .*did you mean 'l_elbow'"):
        perform_motion("icub", trajectory)
    with pytest.raises(TeacherError, match=r"unknown teacher 'icup'.*did you mean 'icub'"):
        perform_motion("icup", trajectory)


def test_performances_cannot_be_changed() -> None:
    seen = performed("icub-wave")
    with pytest.raises(ValueError, match="read-only"):
        seen.directions["head"][0] = 1


@pytest.mark.parametrize("share", [1.0, 0.25])
def test_an_act_goes_its_share_of_the_way_and_others_move_along_only_when_asked(share: float) -> None:
    def way(along: tuple[str, ...]) -> dict[str, float]:
        seen = single_act("icub", "left_forearm", np.random.default_rng(3), share, along).directions
        return {part: float(np.arccos(np.clip(d[0] @ d[-1], -1, 1))) for part, d in seen.items()}

    alone, together = way(()), way(("right_thigh",))
    assert {part for part, turn in alone.items() if turn > 1e-6} == {"left_forearm"}
    whole = single_act("icub", "left_forearm", np.random.default_rng(3)).directions["left_forearm"]
    assert alone["left_forearm"] == pytest.approx(share * np.arccos(whole[0] @ whole[-1]), rel=0.1)
    assert together["left_forearm"] == pytest.approx(alone["left_forearm"])
    assert together["right_thigh"] > 0.01 and together["left_thigh"] < 1e-6
