"""HOAP-2 shows the directions it was shown: an exact body image, limits kept, nothing hidden."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.mirroring import angles_between
from experiments.shared.oracle import SPEED, Retargeted, known_image, retarget
from imitation.acting.movement import slowed
from imitation.correspondence.correspondence import MARGIN
from imitation.correspondence.inversion import LimbView, choose
from imitation.correspondence.limbs import own_limbs
from imitation.correspondence.smooth_path import SLOWEST
from models.hoap2.facts import JOINTS, RANGES_DEG
from models.hoap2.kinematics import directions
from models.motion import JointTrajectory
from models.teachers.demonstrations import DEMONSTRATIONS
from models.teachers.performance import PARTS, Performance
from models.teachers.performing import perform

DT = 0.02
CLIPS = ("02_01", "02_05", "02_06", "02_10")
LOW, HIGH = np.deg2rad([RANGES_DEG[joint] for joint in JOINTS]).T
NUMBER = {part: number for number, part in enumerate(PARTS)}


def postures(count: int, seed: int, share: float = 1.0) -> np.ndarray:
    """(count, 25) angles drawn at random from the middle `share` of every joint's range."""
    rng = np.random.default_rng(seed)
    return (LOW + HIGH) / 2 + share * (HIGH - LOW) * rng.uniform(-0.5, 0.5, (count, len(JOINTS)))


def shows(angles: np.ndarray, *parts: str) -> Performance:
    """HOAP-2 itself as teacher, all of its parts or some."""
    found, time = directions(angles), DT * np.arange(len(angles))
    way = {part: found[:, NUMBER[part]] for part in parts or PARTS}
    return Performance("made", "hoap2", time, way, np.zeros((len(time), 1, 3)), ())


def standing(count: int, **of: np.ndarray) -> np.ndarray:
    """(count, 25) angles, at zero but for the joints named."""
    angles = np.zeros((count, len(JOINTS)))
    for joint, values in of.items():
        angles[:, JOINTS.index(joint)] = values
    return angles


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


def leaping(result: Retargeted) -> np.ndarray:
    """(T, P) whether a joint of the part's limb, found frame by frame, leaps nearby."""
    late = np.zeros(result.error_deg.shape, bool)
    fast = np.abs(np.diff(result.found.chosen, axis=0, prepend=result.found.chosen[:1])) / DT > SLOWEST * 0.95 * SPEED
    for limb in own_limbs(known_image().moves):
        near = np.convolve(fast[:, limb.factors].any(1), np.ones(21), "same") > 0
        late[:, [result.found.parts.index(PARTS[part]) for part in limb.parts]] = near[:, None]
    return late


# --- the exact body image -----------------------------------------------------------------------------------------


def test_the_image_is_exact() -> None:
    """Three looks per joint decide all harmonics of a body of hinges: it is met in postures never looked at."""
    image, angles = known_image(), postures(50, seed=2)
    np.testing.assert_allclose(image.expected(angles), directions(angles), atol=1e-12)
    np.testing.assert_array_equal(image.moves.sum(1), [2, 4, 4, 5, 6] * 2 + [2, 1])


def test_directions_of_reachable_postures_are_recovered() -> None:
    """Frame by frame, nine of ten to 0.1 deg; to 1 deg for a foot, which counts least."""
    image, rest = known_image(), np.tile(known_image().rest, (1, 1))
    for limb in own_limbs(image.moves):
        view = LimbView(image, limb, list(limb.parts), rest, MARGIN)
        row, doubt = np.zeros(1, int), np.zeros(len(limb.parts))
        weights = np.array([limb.tolerances]) ** -2.0 * limb.tolerances[0] ** 2
        errors = []
        for angles in np.random.default_rng(5).uniform(view.low, view.high, (25, len(view.low))):
            wanted, _ = view.directions(angles[None], row)
            found, _ = view.directions(choose(view, wanted, weights, doubt), row)
            errors.append(np.rad2deg(angles_between(found[0], wanted[0])))
        for part, error in zip(limb.parts, np.percentile(errors, 90, axis=0), strict=True):
            assert error < (1 if "foot" in PARTS[part] else 0.1), PARTS[part]


@given(st.integers(0, 2**31))
@settings(max_examples=3, deadline=None)
def test_slow_movements_come_back(seed: int) -> None:
    """HOAP-2 is shown a slow movement of its own through random postures: it shows the same directions (an arm may lose
    its way for a moment where it is stretched out)."""
    keys = JointTrajectory("keys", 2.5 * np.arange(5.0), JOINTS, postures(5, seed, share=0.6))
    inside = np.clip(keys.resampled(DT).angles, LOW + MARGIN, HIGH - MARGIN)
    result = retarget(shows(inside), DT)
    limbs = [NUMBER[part] for part in PARTS if "foot" not in part]
    assert result.error_deg[:, limbs].mean() < 0.3
    assert np.percentile(result.error_deg[:, limbs], 95) < 0.6


# --- every demonstration and clip ---------------------------------------------------------------------------------


def test_limits_are_kept(case: tuple[Performance, Retargeted]) -> None:
    seen, result = case
    angles = result.angles
    assert seen.time[-1] - DT < DT * (len(angles) - 1) <= seen.time[-1] + 1e-9
    assert (angles >= LOW + MARGIN - 1e-9).all() and (angles <= HIGH - MARGIN + 1e-9).all()
    assert (result.speeds(DT) <= SPEED).all()
    assert (np.abs(np.diff(slowed(angles, result.found.slowed), axis=0)) / DT <= 1.03 * SPEED).all()
    assert (angles[:, [JOINTS.index(f"{side}_arm_joint_5") for side in ("left", "right")]] == 0).all()


def test_smoothing_moves_no_reachable_direction_by_more_than_a_degree(case: tuple[Performance, Retargeted]) -> None:
    """But where a limb leaps from one way of showing it to another."""
    _, result = case
    free = result.found.reachable & ~leaping(result)
    moved = np.rad2deg(angles_between(directions(result.found.chosen), result.shown))
    np.testing.assert_allclose(moved, np.rad2deg(result.found.moved), atol=0.1)
    assert (moved[free] <= 1).all()
    assert (np.rad2deg(angles_between(result.shown, result.found.wanted))[free] <= 6).all()


def test_errors_are_those_that_others_measure(case: tuple[Performance, Retargeted]) -> None:
    seen, result = case
    time = DT * np.arange(len(result.angles))
    for number, part in enumerate(PARTS):
        places = np.column_stack([np.interp(time, seen.time, axis) for axis in seen.directions[part].T])
        places /= np.linalg.norm(places, axis=1, keepdims=True)
        off = np.rad2deg(angles_between(directions(result.angles)[:, number], places))
        np.testing.assert_allclose(result.error_deg[:, number], off, atol=0.8)
        assert result.error_deg_by_part[part] == pytest.approx(result.error_deg[:, number].mean())
    assert result.mean_error_deg(np.ones_like(result.found.reachable)) == pytest.approx(result.error_deg.mean())
    assert result.mean_error_deg(np.zeros_like(result.found.reachable)) == 0
    assert result.found.reachable.mean() > 0.5


@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_built_in_demonstrations_are_within_reach(name: str) -> None:
    _, result = shown(name)
    assert result.found.reachable.all()
    assert result.found.slowed == 1
    assert result.error_deg.mean() < 0.15
    feet = np.array(["foot" in part for part in PARTS])
    assert result.error_deg[:, feet].max() < 3 and result.error_deg[:, ~feet].max() < 1


def test_people_are_followed(cmu: Path) -> None:
    """Arms and legs of four people's movements, over the frames that are within reach."""
    limbs = np.array(["arm" in part or part.endswith(("thigh", "shank")) for part in PARTS])
    for clip in CLIPS:
        _, result = shown(str(cmu / f"{clip}.amc"))
        assert result.mean_error_deg(result.found.reachable & limbs) < 1.0, clip
        assert result.found.reachable[:, limbs].mean() > 0.8, clip


def test_the_robot_does_what_the_teacher_does() -> None:
    """Left is left, up is up: the waving arm is the right one, its forearm is up; the bow lifts both thighs forward."""
    joints_of = {
        name: dict(zip(JOINTS, np.rad2deg(shown(name)[1].angles).T, strict=True))
        for name in ("icub-wave", "romeo-bow", "human-raise", "icub-reach")
    }
    wave = joints_of["icub-wave"]
    assert np.ptp(wave["right_arm_joint_4"]) > 40 > 5 > np.ptp(wave["left_arm_joint_4"])
    assert shown("icub-wave")[1].shown[110, NUMBER["right_forearm"], 2] > 0.8
    bow = joints_of["romeo-bow"]
    assert bow["left_leg_joint_3"].min() < -45 and bow["right_leg_joint_3"].min() < -45
    assert bow["head_joint_2"].max() > 20
    assert joints_of["human-raise"]["left_arm_joint_1"].min() < -45
    assert joints_of["icub-reach"]["body_joint_1"].max() > 15


def test_the_same_movement_gives_the_same_bytes() -> None:
    seen, result = shown("icub-reach")
    assert retarget(seen, DT).angles.tobytes() == result.angles.tobytes()


# --- limits of the body -------------------------------------------------------------------------------------------


def test_what_is_out_of_reach_is_reported() -> None:
    """A nose that turns 90 deg to the left: the neck stops at 59, and the error is the missing 31."""
    time = np.arange(0, 4, DT)
    pan = np.deg2rad(90) * np.clip(time - 1, 0, 1)
    nose = np.column_stack([np.cos(pan), np.sin(pan), np.zeros_like(pan)])
    result = retarget(Performance("made", "nobody", time, {"head": nose}, np.zeros((len(time), 1, 3)), ()), DT)
    assert result.found.parts == ("head",)
    assert result.error_deg[-1] == pytest.approx(31, abs=0.1)
    assert not result.found.reachable[-1] and result.found.reachable[0]
    assert 0.2 < result.found.reachable.mean() < 0.8
    others = [number for number, joint in enumerate(JOINTS) if not joint.startswith("head")]
    assert np.ptp(result.angles[:, others], axis=0).max() == 0


@pytest.mark.parametrize("seconds", [0.2, 0.4])
def test_what_is_too_fast_is_slowed(seconds: float) -> None:
    """An elbow that bends by 90 deg in so short a time: as long as its limit of 5 rad/s asks, and the shape is kept."""
    time = np.arange(0, 3, DT)
    r = np.clip((time - 1.5) / seconds, 0, 1)
    bend = np.deg2rad(10 + 90 * r**3 * (10 - 15 * r + 6 * r * r))
    angles = standing(len(time), left_arm_joint_2=np.deg2rad(45) + 0 * time, left_arm_joint_4=-bend)
    result = retarget(shows(angles, "left_upper_arm", "left_forearm"), DT)
    assert result.found.slowed == pytest.approx(15 / 8 * np.deg2rad(90) / seconds / 5, rel=0.12)
    assert result.speeds(DT).max() <= 5
    assert result.error_deg.max() < 1.3 and result.error_deg[:60].max() < 0.2 > result.error_deg[-50:].max()
    held = slowed(result.angles, result.found.slowed)
    assert len(held) == int(149 * result.found.slowed + 1e-9) + 1
    assert (np.abs(np.diff(held, axis=0)) / DT).max() <= 5


def test_a_fast_movement_stays_fast() -> None:
    """An elbow that swings by 10 deg, four times a second, is not ironed out by more than the degree."""
    time = np.arange(0, 3, DT)
    swing = -np.deg2rad(60 + 10 * np.sin(2 * np.pi * 4 * time))
    arm = {"left_arm_joint_1": np.pi / 2 + 0 * time, "left_arm_joint_2": 0.2 + 0 * time, "left_arm_joint_4": swing}
    result = retarget(shows(standing(len(time), **arm), "left_upper_arm", "left_forearm"), DT)
    rise = np.rad2deg(np.arcsin([way[25:-25, 1, 2] for way in (result.shown, result.teacher)]))
    assert np.ptp(rise[0]) > np.ptp(rise[1]) - 2 > 17
    assert result.error_deg[:, 1].max() <= 1


def test_unseen_parts_leave_their_joints_at_rest() -> None:
    seen, whole = shown("icub-wave")
    arms = {part: way for part, way in seen.directions.items() if "arm" in part}
    part = retarget(replace(seen, directions=arms), DT)
    mine = np.array(["arm" in joint for joint in JOINTS])
    np.testing.assert_array_equal(part.angles[:, mine], whole.angles[:, mine])
    assert (part.angles[:, ~mine] == 0).all()


def test_shortest_movement() -> None:
    seen, _ = shown("icub-wave")
    first = {part: way[:3] for part, way in seen.directions.items()}
    short = replace(seen, time=seen.time[:3], directions=first, points=seen.points[:3])
    assert retarget(short, DT).angles.shape == (3, 25)
