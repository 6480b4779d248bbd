"""Bodies that are not a line: hysteresis by its laws, springs and payloads by their analytic torques."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from models.body import SimulatedBody
from models.errors import BodyError
from models.hoap2 import facts
from models.loading import compiled, load_body
from models.robots import ROBOTS
from models.wear import Wear, ball_radius

Array = NDArray[np.float64]
PLAYS = Wear(1.0, (0.0, 0.1, 0.3), (0.5, 0.3, 0.2))


def followed(wear: Wear, commands: Array) -> Array:
    """What follows (T,) commands, from rest at 0."""
    played = np.zeros((len(wear.backlash), 1, 1))
    return np.array([wear.follow(played, np.full((1, 1), one), -1.0, 1.0)[0, 0] for one in commands])


def leg(start: float, end: float, steps: int) -> Array:
    return np.linspace(start, end, steps + 1)[1:]


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=2, max_size=8), st.integers(1, 9))
def test_hysteresis_does_not_depend_on_rate(turns: list[float], steps: int) -> None:
    """The same turning points in one step or in many: the same end, bit by bit the same memory."""
    slow = np.concatenate([leg(a, b, steps) for a, b in zip([0.0, *turns], turns, strict=False)])
    np.testing.assert_allclose(followed(PLAYS, slow)[steps - 1 :: steps], followed(PLAYS, np.array(turns)), atol=1e-12)


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.9, 0.9), st.floats(-0.9, 0.9), st.floats(0.3, 1.0))
def test_an_inner_loop_closes_and_is_forgotten(first: float, second: float, end: float) -> None:
    """Return-point memory: a loop between two turning points comes back to where it began, and leaves no trace."""
    low, high = sorted((first, second))
    before, loop, after = [-1.0, high], [low, high], [1.0, -end]
    with_loop, without = followed(PLAYS, np.array(before + loop + after)), followed(PLAYS, np.array(before + after))
    assert with_loop[3] == pytest.approx(with_loop[1], abs=1e-12)
    np.testing.assert_allclose(with_loop[4:], without[2:], atol=1e-12)
    if high - low > 0.31:  # wider than the widest play: the loop is as wide as the law says
        up, down = with_loop[3], followed(PLAYS, np.array([-1.0, 1.0, high]))[-1]
        if high < 0.69:
            assert down - up == pytest.approx(np.dot(PLAYS.backlash, PLAYS.shares))


def test_equal_plays_are_one_play_and_one_is_a_clipped_gap() -> None:
    commands = np.random.default_rng(0).uniform(-1, 1, 200)
    one = followed(Wear(backlash=(0.3,)), commands)
    np.testing.assert_allclose(followed(Wear(1.0, (0.3, 0.3), (0.6, 0.4)), commands), one, atol=1e-12)
    at = 0.0
    for command, angle in zip(commands, one, strict=True):
        at = min(max(at, command - 0.15), command + 0.15)
        assert angle == at


@pytest.mark.parametrize(
    "widths, shares", [((0.1,), (0.5, 0.5)), ((-0.1,), (1.0,)), ((0.0, 0.1), (0.5, 0.6)), ((0.1, 0.0), (0.0, 1.0))]
)
def test_plays_that_are_none_are_refused(widths: tuple[float, ...], shares: tuple[float, ...]) -> None:
    with pytest.raises(BodyError, match="each width needs a share above 0, all shares make 1"):
        Wear(1.0, widths, shares)


def test_springs_and_shares_make_another_body() -> None:
    model = compiled(ROBOTS["hoap2-spring"])

    def fingerprint(wear: Wear = PLAYS) -> str:
        return SimulatedBody(model, name="h", wear=wear, threads=1).fingerprint

    prints = [fingerprint(), fingerprint(replace(PLAYS, shares=(0.5, 0.2, 0.3)))]
    model.tendon_stiffness[0] *= 1.01
    prints.append(fingerprint())
    model.tendon_lengthspring[0, 0] -= 0.01
    assert len({*prints, fingerprint()}) == 4


def test_a_kilogram_of_steel_is_a_ball_of_127_cm3() -> None:
    assert 4 / 3 * np.pi * ball_radius(1.0) ** 3 == pytest.approx(127.4e-6, rel=1e-3)


def torque(name: str, joint: str, fraction: float) -> float:
    """Passive torque on a joint at rest at this fraction of its range, everything else at home."""
    body = load_body(name, threads=1)
    j, data = body.joints.index(joint), mujoco.MjData(body.model)
    low, high = body.joint_range[j]
    mujoco.mj_resetDataKeyframe(body.model, data, 0)
    data.qpos[body._qpos[j]] = low + fraction * (high - low)
    mujoco.mj_forward(body.model, data)
    return float(data.qfrc_passive[body._dof[j]])


@pytest.mark.parametrize("joint, bent", [("left_arm_joint_4", -1), ("right_arm_joint_4", -1), ("left_leg_joint_4", 1)])
def test_a_spring_pushes_back_from_mid_range_on(joint: str, bent: int) -> None:
    """k (mid - angle) beyond the middle, nothing before; three quarters of the servo's torque at the end."""
    limit = 0.75 * facts.TORQUE_LIMIT[facts.joint_class(joint)]
    for beyond in (0.0, 0.2, 0.5):
        assert torque("hoap2-spring", joint, 0.5 + bent * beyond) == pytest.approx(-bent * limit * beyond / 0.5)
        assert torque("hoap2-spring", joint, 0.5 - bent * beyond) == pytest.approx(0, abs=1e-9)
        assert torque("hoap2", joint, 0.5 + bent * beyond) == 0
    assert ROBOTS["hoap2-spring"].springs.keys() == set(facts.SPRUNG)


def test_a_sprung_joint_still_reaches_its_end() -> None:
    body = load_body("hoap2-spring", threads=1)
    columns = [body.joints.index(joint) for joint in facts.SPRUNG]
    target = body.joint_angles.copy()
    ends = np.array([body.joint_range[c][int("leg" in body.joints[c])] for c in columns])
    load = np.array([0.75 * facts.TORQUE_LIMIT[facts.joint_class(joint)] for joint in facts.SPRUNG])
    target[:, columns] = ends + np.sign(ends) * load / body.model.actuator_gainprm[columns, 0]
    for _ in range(100):
        body.act(body.command_angles(target))
    np.testing.assert_allclose(body.joint_angles[0, columns], ends, atol=np.deg2rad(1.5))
