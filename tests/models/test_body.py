"""The simulated body: the same whatever the threads, honest about noise, play and pulses; MuJoCo as oracle."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.body import SimulatedBody
from models.errors import BodyError
from models.loading import compiled, load_body, servos
from models.robots import ROBOTS, Robot
from models.wear import Wear
from models.wiring import Wiring


def moves(body: SimulatedBody, ticks: int, seed: int = 0) -> np.ndarray:
    """(T, B, M) smooth enough commands."""
    rng = np.random.default_rng(seed)
    steps = rng.uniform(-0.02, 0.02, (ticks, body.copies, len(body.motor_low)))
    return np.clip(np.cumsum(steps, 0), -0.5, 0.5)


def felt(body: SimulatedBody, commands: np.ndarray) -> np.ndarray:
    return np.stack([body.reset(), *(body.act(c) for c in commands)])


@pytest.mark.parametrize("robot", ["arm", "hoap2"])
def test_the_same_seed_feels_the_same_at_one_and_two_threads(robot: str, arm: Path) -> None:
    name = arm if robot == "arm" else robot
    bodies = [load_body(name, copies=5, threads=threads, noise=0.01, seed=3, scramble=1) for threads in (1, 2)]
    one, two = (felt(body, moves(body, 12)) for body in bodies)
    assert one.tobytes() == two.tobytes()
    other = load_body(name, copies=5, noise=0.01, seed=4, scramble=1)
    assert felt(other, moves(other, 12)).tobytes() != one.tobytes()


def test_copies_live_apart_and_alike(arm: Path) -> None:
    body, alone = load_body(arm, copies=6), load_body(arm)
    commands = moves(body, 20)
    together = felt(body, commands)
    for copy in (0, 5):
        assert (felt(alone, commands[:, copy : copy + 1])[:, 0] == together[:, copy]).all()


def test_reset_forgets_everything(arm: Path) -> None:
    body = load_body(arm, copies=3)
    first = felt(body, moves(body, 15, seed=1))
    felt(body, moves(body, 15, seed=2))
    assert (felt(body, moves(body, 15, seed=1)) == first).all()
    assert body.time == pytest.approx(15 * body.tick_s)


def test_reseeded_noise_depends_on_the_number_alone(arm: Path) -> None:
    body = load_body(arm, copies=2, noise=0.01, seed=5)
    body.reseed(7)
    first = felt(body, moves(body, 4))
    felt(body, moves(body, 9))
    body.reseed(7)
    assert (felt(body, moves(body, 4)) == first).all()


def test_noise_has_the_size_it_says(arm: Path) -> None:
    """Angles: sigma; speeds: sqrt(2) sigma / tick, as of two differenced readings."""
    sigma = 0.02
    body, still = load_body(arm, copies=4000, noise=sigma, seed=1), load_body(arm)
    error = body.reset() - still.reset()
    np.testing.assert_allclose(error[:, :3].std(0), sigma, rtol=0.05)
    np.testing.assert_allclose(error[:, 3:].std(0), np.sqrt(2) * sigma / body.tick_s, rtol=0.05)
    np.testing.assert_allclose(error.mean(0) / error.std(0), 0, atol=4.5 / np.sqrt(4000))
    assert abs(np.corrcoef(error.T)[~np.eye(6, dtype=bool)]).max() < 0.08


def test_hoap2_reads_whole_pulses() -> None:
    """209 pulses per degree (data sheet of the encoders)."""
    body = load_body("hoap2", copies=3)
    angles = felt(body, moves(body, 5))[..., :25]
    pulses = np.rad2deg(angles) * 209
    np.testing.assert_allclose(pulses, np.rint(pulses), atol=1e-6)
    assert np.abs(angles[-1] - body.joint_angles).max() <= np.deg2rad(0.5 / 209) * (1 + 1e-9)


def worn(arm: Path, backlash: float) -> SimulatedBody:
    model = compiled(Robot(arm, "arm"))
    servos(model, "arm")
    return SimulatedBody(model, name="arm", wear=Wear(backlash=(backlash,)))


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**31), st.floats(0.001, 0.3))
def test_backlash_is_a_play_operator(arm_path: Path, seed: int, width: float) -> None:
    """The transmitted angle y follows x so that |x - y| <= width / 2, and moves only when pushed at an end.

    It forgets by extremes: a swing larger than the width, there and back, leaves no trace of what was before.
    """
    body = worn(arm_path, width)
    commands = np.random.default_rng(seed).uniform(-0.2, 0.2, (30, 1, 3))
    body.reset()
    before = body.batch.ctrl.copy()
    for command in commands:
        body.act(command)
        x, y = body.commands(command), body.batch.ctrl
        gap = np.abs(x - y)
        assert (gap <= width / 2 + 1e-12).all()
        moved = np.abs(y - before) > 1e-12
        np.testing.assert_allclose(gap[moved], width / 2, atol=1e-12)
        stayed = np.abs(x - before) <= width / 2
        assert (~moved[stayed]).all()
        before = y.copy()
    other = worn(arm_path, width)
    swing = [other.command_angles(angles)[None] for angles in (np.array([0.7, 1.9, 0.9]), np.array([-1.2, -0.3, -0.9]))]
    for command in swing:
        body.act(command)
        other.act(command)
    np.testing.assert_allclose(body.batch.ctrl, other.batch.ctrl, atol=1e-12)


@pytest.fixture(scope="module")
def arm_path(arm: Path) -> Path:
    return arm


def test_no_backlash_is_no_play_and_worn_joints_stick(arm: Path) -> None:
    body = worn(arm, 0.0)
    commands = moves(body, 5)
    body.reset()
    for command in commands:
        body.act(command)
        assert (body.batch.ctrl == body.commands(command)).all()
    fresh, old = load_body("hoap2"), load_body("hoap2-worn")
    np.testing.assert_allclose(old.model.dof_frictionloss, 30 * fresh.model.dof_frictionloss)
    assert old.wear.backlash == pytest.approx((np.deg2rad(0.5),))
    assert fresh.fingerprint != old.fingerprint


@pytest.mark.parametrize("robot", ["arm", "hoap2"])
def test_at_rest_servos_hold_what_inverse_dynamics_asks(robot: str, arm: Path) -> None:
    """Where nothing moves, kp (command - angle) is mj_inverse's torque (gravity), up to dry friction."""
    body = load_body(arm if robot == "arm" else robot)
    target = 0.6 * body.joint_range[:, 0] + 0.4 * body.joint_range[:, 1]
    if robot == "hoap2":
        target = body.joint_angles[0] + np.deg2rad(5) * np.sign(body.joint_range.mean(1) - body.joint_angles[0])
    motors = body.command_angles(target)[None]
    for _ in range(250):
        body.act(motors)
    assert np.abs(body.batch.qvel).max() < 1e-4
    data = mujoco.MjData(body.model)
    data.qpos[:] = body.batch.qpos[0]
    mujoco.mj_inverse(body.model, data)
    gravity = data.qfrc_inverse[body._dof]
    held = body.model.actuator_gainprm[:, 0] * (target - body.joint_angles[0])
    assert np.abs(gravity).max() > 0.3
    assert (np.abs(held - gravity) <= body.model.dof_frictionloss[body._dof] + 1e-3).all()


def test_copies_step_as_plain_mujoco_does(arm: Path) -> None:
    body = load_body(arm, copies=2)
    data = mujoco.MjData(body.model)
    body.reset()
    data.ctrl[:] = body.batch.ctrl[0]
    for command in moves(body, 30):
        body.act(command)
        data.ctrl[:] = body.commands(command)[0]
        for _ in range(body.substeps):
            mujoco.mj_step(body.model, data)
    np.testing.assert_array_equal(body.batch.qpos[0], data.qpos)


def wild(arm: Path, tmp_path: Path, joint: str) -> Path:
    path = tmp_path / "wild.xml"
    path.write_text(arm.read_text().replace(f'<position name="{joint}"', f'<position kp="4e5" kv="0" name="{joint}"'))
    return path


@pytest.mark.parametrize("joint", ["shoulder", "elbow", "wrist"])
def test_unstable_physics_names_the_joint_and_the_time(
    arm: Path, tmp_path: Path, joint: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    body = load_body(wild(arm, tmp_path, joint), copies=4)
    with pytest.raises(BodyError, match=rf"unstable at joint '{joint}' after \d+\.\d\d s; lower its actuator's gain"):
        felt(body, moves(body, 100))
    assert capfd.readouterr() == ("", "")  # MuJoCo's own warnings are not repeated
    assert [p.name for p in tmp_path.iterdir()] == ["wild.xml"]  # nor written into a log file


def test_what_is_no_command_and_no_tick(arm: Path) -> None:
    body = load_body(arm)
    with pytest.raises(BodyError, match=r"motor command is not a number at 0\.00 s"):
        body.act(np.array([[0.0, np.nan, 0.0]]))
    with pytest.raises(BodyError, match=r"a control tick of 0\.012 s is 2\.4 physics steps of 0\.005 s"):
        SimulatedBody(body.model, name="arm", tick_s=0.012)


def test_fingerprints_tell_bodies_apart(arm: Path, tmp_path: Path) -> None:
    heavier = tmp_path / "heavier.xml"
    heavier.write_text(arm.read_text().replace('mass="0.2"', 'mass="0.21"'))
    prints = [
        load_body(arm).fingerprint,
        load_body(heavier).fingerprint,
        load_body(arm, scramble=0).fingerprint,
        load_body(arm, scramble=1).fingerprint,
        worn(arm, 0.01).fingerprint,
    ]
    assert len(set(prints)) == 5
    assert load_body(arm, copies=7, threads=1, noise=0.1, seed=9).fingerprint == prints[0]


def test_straight_wiring_is_the_default(arm: Path) -> None:
    body = load_body(arm)
    straight = Wiring.straight(3, 6)
    assert (body.wiring.motor == straight.motor).all() and (body.wiring.sense == straight.sense).all()
    angles = np.array([0.3, 1.0, -0.5])
    np.testing.assert_allclose(body.commands(body.command_angles(angles)), angles, atol=1e-12)


def test_a_body_of_some_motors_is_the_whole_whose_rest_holds_still() -> None:
    model, some = compiled(ROBOTS["hoap2"]), ("head_joint_2", "left_arm_joint_1")
    whole, part = (SimulatedBody(model, name="h", copies=2, motors=motors) for motors in ((), some))
    columns = [whole.joints.index(joint) for joint in some]
    command, rng = whole.command_angles(whole.joint_angles), np.random.default_rng(0)
    for _ in range(20):
        command[:, columns] += 0.02 * rng.standard_normal((2, 2))
        felt, all_felt = part.act(command[:, columns]), whole.act(command)
        np.testing.assert_allclose(part.joint_angles, whole.joint_angles[:, columns], atol=1e-12)
        for channel in ("angle", "speed"):
            np.testing.assert_allclose(
                part.senses.read(felt, channel), whole.senses.read(all_felt, channel, some), atol=1e-9
            )
    assert whole.fingerprint != part.fingerprint
    with pytest.raises(BodyError, match=r"unknown joint with a motor 'head_joint_3'.*did you mean"):
        SimulatedBody(model, name="h", motors=("head_joint_3",))


def gravity(body: SimulatedBody) -> np.ndarray:
    """(nv,) torque of gravity where copy 0 is, by the model that the batch really steps."""
    model, data = body.batch.get_model(0), mujoco.MjData(body.model)
    data.qpos[:] = body.batch.qpos[0]
    mujoco.mj_forward(model, data)
    return np.array(data.qfrc_bias)


def test_a_payload_weighs_m_g_r(arm: Path) -> None:
    """Three links hang straight down at 0; with the shoulder at q the hand's centre is .6 m down the arm."""
    body, angle = load_body(arm, threads=1), 0.7
    body.batch.qpos[0] = (angle, 0.0, 0.0)
    before, print_ = gravity(body), body.fingerprint
    body.carry(0.2, "hand")
    added, lever = gravity(body) - before, np.array([0.6, 0.3, 0.0])
    np.testing.assert_allclose(np.abs(added), 0.2 * 9.81 * lever * np.sin(angle), atol=1e-9)
    body.carry(0.0, "hand")
    np.testing.assert_allclose(gravity(body), before, atol=1e-12)
    assert body.fingerprint == print_
    with pytest.raises(BodyError, match=r"0\.2 kg on 'nose': 0 kg or more, on one of upper, fore, hand"):
        body.carry(0.2, "nose")
    with pytest.raises(BodyError, match="-1 kg on 'hand'"):
        body.carry(-1, "hand")


def test_a_payload_taken_up_is_the_payload_carried_from_birth() -> None:
    born, later = load_body("hoap2-payload"), load_body("hoap2")
    fresh = felt(later, moves(later, 15))
    later.carry(0.2, "right_hand")
    np.testing.assert_allclose(felt(later, moves(later, 15)), felt(born, moves(born, 15)), atol=1e-4)  # a pulse
    assert np.abs(felt(later, moves(later, 15)) - fresh).max() > 0.01
    for constant in ("dof_invweight0", "dof_M0"):  # what the solver takes from the masses has followed
        model = later.batch.get_model(0)
        np.testing.assert_allclose(getattr(model, constant), getattr(born.model, constant), rtol=1e-6)
    assert born.fingerprint != later.fingerprint


def test_a_jammed_joint_stays_where_it_was_and_the_rest_does_not(arm: Path) -> None:
    """In mid movement; in the copies named; less than a pulse of 209 a degree in ten seconds of other commands."""
    body, whole = load_body(arm, copies=3), load_body(arm, copies=3)
    commands, then = moves(body, 20), moves(body, 500, seed=1)
    for one in (body, whole):
        felt(one, commands)
    assert np.abs(body.batch.qvel[1:, 1]).max() > 0.05
    body.jam("elbow", np.array([1, 2]))
    at = body.joint_angles[:, 1].copy()
    path = []
    for command in then:
        body.act(command)
        whole.act(command)
        path.append(body.joint_angles.copy())
    travel = np.ptp(path, axis=0)
    assert np.abs(np.array(path)[:, 1:, 1] - at[1:]).max() < np.deg2rad(1 / 209)
    assert (travel[:, [0, 2]] > 0.2).all() and travel[0, 1] > 0.2
    np.testing.assert_array_equal(body.joint_angles[0], whole.joint_angles[0])
    with pytest.raises(BodyError, match=r"unknown joint with a motor 'elbo'.*did you mean 'elbow'"):
        body.jam("elbo")


def test_a_jammed_joint_holds_the_torque_limit_of_a_heavy_robot() -> None:
    body = load_body("hoap2", copies=2)
    column = body.joints.index("left_leg_joint_4")
    at = body.joint_angles[0, column]
    body.jam("left_leg_joint_4")
    full = np.random.default_rng(0).uniform(-0.5, 0.5, (2, 25))
    full[:, column] = [-0.6, 0.6]  # 9 N m either way
    for _ in range(100):
        body.act(full)
    assert np.abs(body.joint_angles[:, column] - at).max() < np.deg2rad(0.1 / 209)


def test_rewired_lines_have_changed_places_and_mending_undoes_all(arm: Path) -> None:
    body, whole = (load_body(arm, copies=2, scramble=3) for _ in range(2))
    commands = moves(body, 30)
    straight, print_ = felt(whole, commands), body.fingerprint
    body.rewire(0, 2, np.array([1]))
    swapped = commands.copy()
    swapped[:, 1] = commands[:, 1][:, [2, 1, 0]]
    rewired = felt(body, commands)
    np.testing.assert_array_equal(rewired, felt(whole, swapped))
    assert np.abs(rewired - straight)[:, 1].max() > 0.05 and (rewired[:, 0] == straight[:, 0]).all()
    body.jam("elbow")
    body.carry(0.3, "fore")
    with pytest.raises(BodyError, match="motor lines 1 and 3 of 0 to 2"):
        body.rewire(1, 3)
    assert (felt(body, commands) != rewired).any()
    body.mend()
    np.testing.assert_array_equal(felt(body, commands), straight)
    assert body.fingerprint == print_
