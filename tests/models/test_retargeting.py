"""HOAP-2 shows the directions it was shown: kinematics against oracles, limits kept, nothing hidden."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.hoap2 import ROBOT
from models.hoap2.facts import JOINTS, RANGES_DEG, SPEED_LIMIT, joint_class
from models.hoap2.limbs import LIMBS
from models.motion import JointTrajectory
from models.retargeting import Retargeted, hoap2_directions, retarget
from models.retargeting.chain import chain, joints, ranges
from models.retargeting.retarget import LEAST_STIFFNESS, MARGIN
from models.retargeting.smooth import _within_speed
from models.retargeting.solve import solve
from models.teachers.demonstrations import DEMONSTRATIONS
from models.teachers.performance import PARTS, Performance
from models.teachers.performing import perform, perform_motion

DT = 0.02
CLIPS = ("02_01", "02_05", "02_06", "02_10")
LOW, HIGH = np.deg2rad([RANGES_DEG[joint] for joint in JOINTS]).T
SPEED = np.array([SPEED_LIMIT[joint_class(joint)] for joint in JOINTS])
SEGMENTS = {segment.part: segment for limb in LIMBS.values() for segment in limb.segments}


def poses(count: int, seed: int, share: float = 0.9) -> JointTrajectory:
    """Postures drawn at random from the middle `share` of every joint's range, one per second."""
    rng = np.random.default_rng(seed)
    angles = (LOW + HIGH) / 2 + share * (HIGH - LOW) * rng.uniform(-0.5, 0.5, (count, len(JOINTS)))
    return JointTrajectory("postures", np.arange(float(count)), JOINTS, angles)


def degrees(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.rad2deg(2 * np.arcsin(np.clip(np.linalg.norm(one - other, axis=-1) / 2, 0, 1)))


def hoap2_like(directions: dict[str, np.ndarray], time: np.ndarray) -> Performance:
    return Performance("made", "nobody", time, directions, np.zeros((len(time), 1, 3)), ())


@cache
def shown(name: str) -> tuple[Performance, Retargeted]:
    """A demonstration, or the first six seconds of a clip, and HOAP-2's version of it."""
    seen = perform(name)
    first = seen.time <= 6 if name not in DEMONSTRATIONS else np.ones(len(seen.time), dtype=bool)
    cut = {part: way[first] for part, way in seen.directions.items()}
    seen = replace(seen, time=seen.time[first], directions=cut, points=seen.points[first])
    return seen, retarget(seen, DT)


@pytest.fixture(params=[*DEMONSTRATIONS, *CLIPS])
def case(request: pytest.FixtureRequest) -> tuple[Performance, Retargeted]:
    if request.param in DEMONSTRATIONS:
        return shown(request.param)
    folder: Path = request.getfixturevalue("cmu")
    return shown(str(folder / f"{request.param}.amc"))


# --- kinematics ---------------------------------------------------------------------------------------------------


def test_body_is_the_declared_one() -> None:
    assert joints() == JOINTS
    np.testing.assert_allclose(np.array(list(ranges().values())).T, [LOW, HIGH], atol=1e-9)
    assert set(SEGMENTS) == set(PARTS)


def test_directions_agree_with_mujoco() -> None:
    model = mujoco.MjModel.from_xml_path(str(ROBOT))
    data = mujoco.MjData(model)
    trajectory = poses(30, seed=1, share=1)
    found = hoap2_directions(trajectory)
    for frame, posture in enumerate(trajectory.angles):
        for joint, angle in zip(JOINTS, posture, strict=True):
            data.joint(joint).qpos[0] = angle
        mujoco.mj_kinematics(model, data)
        torso = data.body("torso").xmat.reshape(3, 3)
        for part, segment in SEGMENTS.items():
            body = data.xmat[model.joint(segment.joint).bodyid[0]].reshape(3, 3)
            np.testing.assert_allclose(found[part][frame], torso.T @ body @ segment.axis, atol=1e-9)


def test_chains_agree_with_pinocchio() -> None:
    """The arm and head chains start at the torso; the legs' start at the pelvis, which is at zero here."""
    trajectory = poses(50, seed=2, share=1)
    angles = trajectory.angles.copy()
    angles[:, JOINTS.index("body_joint_1")] = 0
    found = hoap2_directions(replace(trajectory, angles=angles))
    for name, limb in LIMBS.items():
        if name != "trunk":
            columns = [JOINTS.index(joint) for joint in limb.joints]
            mine, _ = chain(limb.joints, limb.segments).directions(angles[:, columns])
            for number, segment in enumerate(limb.segments):
                np.testing.assert_allclose(mine[:, number], found[segment.part], atol=1e-12)


@pytest.mark.parametrize("name", LIMBS)
def test_derivatives_are_those_of_the_directions(name: str) -> None:
    own = chain(LIMBS[name].joints, LIMBS[name].segments)
    angles = np.random.default_rng(3).uniform(own.low, own.high, (20, len(own.low)))
    _, slope = own.directions(angles)
    for joint in range(len(own.low)):
        step = 1e-6 * np.eye(len(own.low))[joint]
        change = (own.directions(angles + step)[0] - own.directions(angles - step)[0]) / 2e-6
        np.testing.assert_allclose(slope[..., joint], change, atol=1e-8)


def test_hoap2_as_teacher_is_seen_as_its_kinematics_say() -> None:
    """The anatomical frames found from shoulders, hips and ankles are the ones HOAP-2 is drawn in."""
    trajectory = poses(20, seed=4)
    seen, computed = perform_motion("hoap2", trajectory), hoap2_directions(trajectory)
    for part in PARTS:
        np.testing.assert_allclose(seen.directions[part], computed[part], atol=1e-9)


# --- inverse kinematics -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", LIMBS)
def test_directions_of_reachable_postures_are_recovered(name: str) -> None:
    """To 0.1 deg; to 1 deg for a foot, which counts least and moves near-free joints when the knee is straight."""
    limb = LIMBS[name]
    own = chain(limb.joints, limb.segments, MARGIN)
    wanted, _ = own.directions(np.random.default_rng(5).uniform(own.low, own.high, (400, len(own.low))))
    rest = np.clip(np.zeros(len(own.low)), own.low, own.high)
    stiffness = np.array([limb.stiffness.get(joint, LEAST_STIFFNESS) for joint in limb.joints])
    weights = np.array([segment.weight for segment in limb.segments])
    error = degrees(own.directions(solve(own, wanted, weights, rest, stiffness, jump=0))[0], wanted)
    for number, segment in enumerate(limb.segments):
        assert np.percentile(error[:, number], 99) < (1 if "foot" in segment.part else 0.1), segment.part


@given(st.integers(0, 2**31))
@settings(max_examples=3, deadline=None)
def test_slow_movements_come_back(seed: int) -> None:
    """HOAP-2 is shown a slow movement of its own through random postures: it shows the same directions."""
    keys = replace(poses(5, seed, share=0.6), time=2.5 * np.arange(5.0))
    trajectory = keys.resampled(DT)
    inside = np.clip(trajectory.angles, LOW + MARGIN, HIGH - MARGIN)
    result = retarget(hoap2_like(hoap2_directions(replace(trajectory, angles=inside)), trajectory.time), DT)
    limbs = [part for part in PARTS if "foot" not in part]
    assert np.mean([result.error_deg[part].mean() for part in limbs]) < 0.1
    assert np.percentile([result.error_deg[part] for part in limbs], 95) < 0.6


# --- every demonstration and clip ---------------------------------------------------------------------------------


def test_limits_are_kept(case: tuple[Performance, Retargeted]) -> None:
    seen, result = case
    angles = result.trajectory.angles
    assert result.trajectory.joints == JOINTS
    np.testing.assert_allclose(np.diff(result.trajectory.time), DT, atol=1e-9)
    assert seen.time[-1] - DT < result.trajectory.duration <= seen.time[-1] + 1e-9
    assert (angles >= LOW + MARGIN - 1e-9).all() and (angles <= HIGH - MARGIN + 1e-9).all()
    assert (np.abs(np.diff(angles, axis=0)) / DT <= SPEED).all()
    assert (angles[:, [JOINTS.index(f"{side}_arm_joint_5") for side in ("left", "right")]] == 0).all()


def test_smoothing_moves_no_reachable_direction_by_more_than_a_degree(case: tuple[Performance, Retargeted]) -> None:
    """Where no joint is at its speed limit; and away from such places nothing is late either."""
    _, result = case
    for part in PARTS:
        free = result.reachable[part] & ~result.hurried[part]
        assert (result.moved_deg[part][free] <= 1).all(), part
        assert (result.error_deg[part][free] <= 6).all(), part


def test_errors_are_those_that_others_measure(case: tuple[Performance, Retargeted]) -> None:
    seen, result = case
    found = hoap2_directions(result.trajectory)
    for part in PARTS:
        places = np.column_stack(
            [np.interp(result.trajectory.time, seen.time, axis) for axis in seen.directions[part].T]
        )
        places /= np.linalg.norm(places, axis=1, keepdims=True)
        np.testing.assert_allclose(result.error_deg[part], degrees(found[part], places), atol=0.8)
    assert result.mean_error_deg == pytest.approx(np.mean([result.error_deg[part].mean() for part in PARTS]))
    assert 0 <= result.unreachable_share < 0.5


@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_built_in_demonstrations_are_within_reach(name: str) -> None:
    _, result = shown(name)
    assert result.unreachable_share == 0
    assert not any(late.any() for late in result.hurried.values())
    assert result.mean_error_deg < 0.2
    assert all(way.max() < (3 if "foot" in part else 1) for part, way in result.error_deg.items())


def test_people_are_followed(cmu: Path) -> None:
    """Arms and legs of four people's movements, over the frames that are within reach."""
    limbs = [part for part in PARTS if "arm" in part or part.endswith(("thigh", "shank"))]
    for clip in CLIPS:
        _, result = shown(str(cmu / f"{clip}.amc"))
        errors = np.concatenate([result.error_deg[part][result.reachable[part]] for part in limbs])
        assert errors.mean() < 1.0, clip
        assert np.mean([result.reachable[part].mean() for part in limbs]) > 0.8, clip


def test_the_robot_does_what_the_teacher_does() -> None:
    """Left is left, up is up: the waving arm is the right one, its forearm is up; the bow lifts both thighs forward."""
    joints_of = {
        name: dict(zip(JOINTS, np.rad2deg(shown(name)[1].trajectory.angles).T, strict=True))
        for name in ("icub-wave", "romeo-bow", "human-raise", "icub-reach")
    }
    wave = joints_of["icub-wave"]
    assert np.ptp(wave["right_arm_joint_4"]) > 40 > 5 > np.ptp(wave["left_arm_joint_4"])
    assert hoap2_directions(shown("icub-wave")[1].trajectory)["right_forearm"][110, 2] > 0.8
    bow = joints_of["romeo-bow"]
    assert bow["left_leg_joint_3"].min() < -45 and bow["right_leg_joint_3"].min() < -45
    assert bow["head_joint_2"].max() > 20
    assert joints_of["human-raise"]["left_arm_joint_1"].min() < -45
    assert joints_of["icub-reach"]["body_joint_1"].max() > 15


def test_the_same_movement_gives_the_same_bytes() -> None:
    seen, result = shown("icub-reach")
    assert retarget(seen, DT).trajectory.angles.tobytes() == result.trajectory.angles.tobytes()


# --- limits of the body -------------------------------------------------------------------------------------------


def test_what_is_out_of_reach_is_reported() -> None:
    """A nose that turns 90 deg to the left: the neck stops at 59, and the error is the missing 31."""
    time = np.arange(0, 4, DT)
    pan = np.deg2rad(90) * np.clip(time - 1, 0, 1)
    nose = np.column_stack([np.cos(pan), np.sin(pan), np.zeros_like(pan)])
    result = retarget(hoap2_like({"head": nose}, time), DT)
    assert set(result.error_deg) == {"head"}
    assert result.error_deg["head"][-1] == pytest.approx(31, abs=0.1)
    assert not result.reachable["head"][-1] and result.reachable["head"][0]
    assert 0.2 < result.unreachable_share < 0.8
    others = [joint for joint in JOINTS if not joint.startswith("head")]
    assert np.ptp(result.trajectory.angles[:, [JOINTS.index(joint) for joint in others]], axis=0).max() == 0


def test_what_is_too_fast_comes_late_and_is_said_to() -> None:
    """An elbow that bends 90 deg at once takes as long as its speed limit asks, shared before and after."""
    time = np.arange(0, 3, DT)
    bend = np.deg2rad(np.where(time < 1.5, 10, 100))
    arm = np.tile([np.sqrt(0.5), np.sqrt(0.5), 0], (len(time), 1))
    angles = np.zeros((len(time), len(JOINTS)))
    angles[:, JOINTS.index("left_arm_joint_2")] = np.deg2rad(45)
    angles[:, JOINTS.index("left_arm_joint_4")] = -bend
    wanted = hoap2_directions(JointTrajectory("x", time, JOINTS, angles))
    np.testing.assert_allclose(wanted["left_upper_arm"], arm, atol=1e-12)
    result = retarget(hoap2_like({part: wanted[part] for part in ("left_upper_arm", "left_forearm")}, time), DT)
    speed = np.abs(np.diff(result.trajectory.angles, axis=0)) / DT
    assert speed.max() <= 5
    assert result.hurried["left_forearm"].any() and not result.hurried["left_forearm"][:20].any()
    late = result.error_deg["left_forearm"] > 5
    assert 0.25 < late.sum() * DT < np.deg2rad(90) / 5 + 0.2
    assert result.error_deg["left_upper_arm"].max() < 10


def test_a_fast_movement_stays_fast() -> None:
    """An elbow that swings by 10 deg, four times a second, is not ironed out by more than the degree."""
    time = np.arange(0, 3, DT)
    angles = np.zeros((len(time), len(JOINTS)))
    angles[:, JOINTS.index("left_arm_joint_1")] = np.pi / 2
    angles[:, JOINTS.index("left_arm_joint_2")] = 0.2
    angles[:, JOINTS.index("left_arm_joint_4")] = -np.deg2rad(60 + 10 * np.sin(2 * np.pi * 4 * time))
    wanted = hoap2_directions(JointTrajectory("x", time, JOINTS, angles))
    result = retarget(hoap2_like({part: wanted[part] for part in ("left_upper_arm", "left_forearm")}, time), DT)
    forearm = hoap2_directions(result.trajectory)["left_forearm"]
    rise = np.rad2deg(np.arcsin([way[25:-25, 2] for way in (forearm, wanted["left_forearm"])]))
    assert np.ptp(rise[0]) > np.ptp(rise[1]) - 2 > 17
    assert result.error_deg["left_forearm"].max() <= 1
    assert not result.hurried["left_forearm"].any()


@given(st.integers(0, 2**31))
@settings(max_examples=30, deadline=None)
def test_nearest_movement_within_speed(seed: int) -> None:
    """It keeps limit and range, leaves alone what already keeps the limit, and no such movement is nearer."""
    rng = np.random.default_rng(seed)
    angles, step = rng.normal(size=(40, 2)).cumsum(axis=0), np.array([0.5, 2.0])
    kept = _within_speed(angles, step)
    assert (np.abs(np.diff(kept, axis=0)) <= step + 1e-12).all()
    assert (kept >= angles.min(axis=0) - 1e-12).all() and (kept <= angles.max(axis=0) + 1e-12).all()
    np.testing.assert_allclose(_within_speed(kept, step), kept, atol=1e-12)
    gap = np.abs(np.arange(40)[:, None] - np.arange(40))[:, :, None] * step
    least = ((angles[:, None] - angles[None]) - gap).max(axis=(0, 1)) / 2
    np.testing.assert_allclose(np.abs(kept - angles).max(axis=0), least.clip(0), atol=1e-9)


def test_unseen_parts_leave_their_joints_at_rest() -> None:
    seen, whole = shown("icub-wave")
    arms = {part: way for part, way in seen.directions.items() if "arm" in part}
    part = retarget(replace(seen, directions=arms), DT)
    for joint in JOINTS:
        column = JOINTS.index(joint)
        if "arm" in joint:
            np.testing.assert_array_equal(part.trajectory.angles[:, column], whole.trajectory.angles[:, column])
        else:
            assert (part.trajectory.angles[:, column] == 0).all()


def test_shortest_movement() -> None:
    seen, _ = shown("icub-wave")
    first = {part: way[:3] for part, way in seen.directions.items()}
    short = replace(seen, time=seen.time[:3], directions=first, points=seen.points[:3])
    assert retarget(short, DT).trajectory.angles.shape == (3, 25)
