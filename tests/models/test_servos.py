"""Motors in normal form: the same motion however they are written, servos of a closed form, refusals of one line."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from models.body import JAMMED
from models.errors import BodyError
from models.loading import load_body
from models.servos import BANDWIDTH_HZ, DAMPING_RATIO, driven, gains, posed, position, reach, resting, servos

Model = mujoco.MjModel
SHOULDER = "-1.2 1.5"


def robot(actuators: str, more: str = "", timestep: float = 0.002) -> str:
    """A shoulder, a slide, and two fingers that one equality ties together."""
    return f"""<mujoco><compiler autolimits="true" angle="radian"/><option timestep="{timestep}" gravity="0 0 -9.81"
      integrator="implicitfast"/><worldbody><body name="arm" pos="0 0 1"><joint name="shoulder" axis="0 1 0"
      range="{SHOULDER}" damping="0.2" armature="0.01"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.3" size=".02" mass=".4"/>
      <body name="rail"><joint name="rail" type="slide" axis="0 0 -1" range="0 .3"/><geom size=".03" mass=".3"/>
      <body name="left"><joint name="left" axis="0 0 1" range="-.5 1"/><geom size=".02" pos=".1 0 0" mass=".1"/></body>
      <body name="right"><joint name="right" axis="0 0 1" range="-.5 1"/>
      <geom size=".02" pos=".1 0 0" mass=".1"/></body>
      </body></body></worldbody>
      <tendon><fixed name="grip"><joint joint="left" coef=".5"/><joint joint="right" coef="1.5"/></fixed></tendon>
      <equality><joint joint1="left" joint2="right"/></equality><actuator>{actuators}</actuator>{more}</mujoco>"""


def affine(where: str, gain: float, bias: str, more: str) -> str:
    return f'<general name="m" {where} gainprm="{gain}" biastype="affine" biasprm="{bias}" {more}/>'


def compiled(text: str) -> Model:
    return Model.from_xml_string(text)


def driven_by(model: Model, commands: np.ndarray) -> np.ndarray:
    """(T, nq + nv) configurations and torques of its actuators on the joints, under (T, nu) commands."""
    data = mujoco.MjData(model)
    data.qpos[:] = resting(model)
    rows = []
    for command in commands:
        data.ctrl[:] = command
        mujoco.mj_step(model, data)
        rows.append([*data.qpos, *data.qfrc_actuator])
    return np.array(rows)


WAYS = {
    "as it should be": ('joint="shoulder"', 20, "0 -20 -1", "", 1),
    "gear": ('joint="shoulder"', 20, "0 -20 -1", 'gear="3" forcerange="-1 2"', 3),
    "backward": ('joint="shoulder"', 20, "0 -20 -1", 'gear="-2" forcerange="-1 2" ctrlrange="-2 1"', -2),
    "gain": ('joint="shoulder"', 0.3, "0 -20 -1", 'ctrlrange="0 255"', 1),
    "offset": ('joint="shoulder"', 4, "7 -20 -1", 'gear="1.5" ctrlrange="-3 5" forcerange="-2 4"', 1.5),
    "without damping": ('joint="shoulder"', 20, "0 -20 0", 'gear="2"', 2),
    "slide": ('joint="rail"', 30, "3 -300 -9", 'gear="2"', 2),
    "tendon": ('tendon="grip"', 0.02, "0 -9 -.3", 'gear="2" ctrlrange="0 255" forcerange="-2 1"', 2),
    "joint of its parent": ('jointinparent="shoulder"', 3, "0 -20 -1", 'gear="2"', 2),
}


@pytest.mark.parametrize("way", WAYS)
def test_a_servo_moves_as_the_file_wrote_it(way: str) -> None:
    """Stepped by MuJoCo itself; c asks for where the force g c + b0 + b1 gear q is nothing."""
    where, gain, bias, more, gear = WAYS[way]
    written, normal = (compiled(robot(affine(where, gain, bias, more))) for _ in range(2))
    assert servos(normal, "m") == {}
    b0, b1, _ = map(float, bias.split())
    rng = np.random.default_rng(0)
    low, high = written.actuator_ctrlrange[0] if written.actuator_ctrllimited[0] else (-1.0, 1.0)
    limited = 'ctrlrange="' in more
    told = rng.uniform(low, high, (8, 1)).repeat(60, axis=0) * (1.6 if limited else 1)  # and beyond what it may be told
    asked = (gain * told + b0) / (-b1 * gear)
    if not limited:
        inside = np.clip(asked, *normal.actuator_ctrlrange[0])
        told, asked = (-b1 * gear * inside - b0) / gain, inside
    one, other = driven_by(written, told), driven_by(normal, asked)
    assert np.ptp(one[:, :4], axis=0).max() > 0.05
    np.testing.assert_allclose(other, one, atol=1e-11)
    if "forcerange" in more:
        torque = np.sort(gear * written.actuator_forcerange[0])
        np.testing.assert_allclose(normal.actuator_forcerange[0], torque)
        assert {*np.round(np.sort(one[:, 4:].ravel())[[0, -1]], 9)} & {
            *np.round(torque * (1.5 if "grip" in where else 1), 9)
        }
    kp = normal.actuator_gainprm[0, 0]
    assert kp == pytest.approx(-(gear**2) * b1) and normal.actuator_biasprm[0, 1] == -kp
    np.testing.assert_array_equal(normal.actuator_gear[0], [gear if way == "as it should be" else 1, 0, 0, 0, 0, 0])


def test_a_servo_in_normal_form_is_left_as_it_is() -> None:
    text = robot('<position joint="shoulder" kp="20" kv="1" ctrlrange="-1 1.2" forcerange="-3 4"/>')
    left, model = compiled(text), compiled(text)
    servos(model, "m")
    for field in ("ctrlrange", "forcerange", "gear", "gainprm", "biasprm", "ctrllimited", "forcelimited"):
        np.testing.assert_array_equal(getattr(model, f"actuator_{field}"), getattr(left, f"actuator_{field}"))
    assert model.opt.integrator == left.opt.integrator


def test_commands_without_limits_reach_as_far_as_the_joints() -> None:
    model = compiled(robot('<position joint="shoulder" kp="9"/><position tendon="grip" kp="2" gear="3"/>'))
    servos(model, "m")
    np.testing.assert_allclose(model.actuator_ctrlrange, [[-1.2, 1.5], [-1, 2]])
    assert model.actuator_ctrllimited.all()


# ------------------------------------------------------------------ servos that are given

FREE = """<mujoco><compiler autolimits="true" angle="radian"/><option timestep="{step}" gravity="0 0 0"/><worldbody>
  <body><joint name="j" {joint} damping="{damping}" armature="{armature}"/><geom size=".05" mass=".8" pos=".1 0 0"/>
  </body></worldbody><actuator>{actuator}</actuator></mujoco>"""
MOTORS = {
    "hinge": ('range="-3 3"', 0.01, 0.02, '<motor joint="j"/>'),
    "damped": ('axis="0 1 0"', 0.4, 0.0, '<motor joint="j" gear="-50"/>'),
    "slide": ('type="slide" range="-2 2"', 1.0, 0.1, '<velocity joint="j" kv="3" gear="2"/>'),
}


def answers(model: Model, commands: np.ndarray) -> np.ndarray:
    return driven_by(model, commands[:, None])[:, 0]


@pytest.mark.parametrize("motor", MOTORS)
def test_a_given_servo_is_down_by_3_db_at_its_bandwidth_and_hardly_overshoots(motor: str) -> None:
    joint, damping, armature, actuator = MOTORS[motor]
    step = 2e-4
    how = {"joint": joint, "damping": damping, "armature": armature, "actuator": actuator}
    model = compiled(FREE.format(step=step, **how))
    found = servos(model, "m", give=True)["j"]
    time = np.arange(0, 1.5, step)
    late = time > 0.75
    wave = 2 * np.pi * BANDWIDTH_HZ * time
    swing = answers(model, 0.1 * np.sin(wave))[late]
    both = np.stack([np.sin(wave), np.cos(wave)], 1)[late]
    assert np.hypot(*np.linalg.lstsq(both, swing, rcond=None)[0]) == pytest.approx(0.1 / np.sqrt(2), rel=0.01)
    went = answers(model, np.full(len(time), 0.5))
    overshoot = np.exp(-np.pi * DAMPING_RATIO / np.sqrt(1 - DAMPING_RATIO**2))  # of any second-order system
    assert went.max() / 0.5 - 1 == pytest.approx(overshoot, abs=4e-4) and overshoot < 2e-3
    assert went[-1] == pytest.approx(0.5, rel=1e-3)
    inertia = 0.8 + armature if motor == "slide" else 0.4 * 0.8 * 0.05**2 + 0.8 * 0.01 + armature
    if motor == "damped":
        assert found.kv > 0
    assert found.inertia == pytest.approx(inertia) and found[1:] == gains(found.inertia, damping)[1:]


def test_a_joint_that_is_damped_enough_gets_no_more() -> None:
    assert gains(0.01, 1e3).kv == 0 < gains(0.01, 0.0).kv


def test_fingers_that_one_tendon_pulls_are_one_joint_to_its_servo() -> None:
    """Tied or not, the tendon's own length answers the command: down by 3 dB, all else held."""
    text = robot('<motor tendon="grip"/>', timestep=2e-4).replace('coef="1.5"', 'coef=".5"')
    model = compiled(text.replace('0 0 -9.81"', '0 0 0"').replace('type="slide"', 'type="slide" damping="1e9"'))
    found = servos(model, "m", give=True)
    assert [*found] == ["grip"]
    time = np.arange(0, 1.0, 2e-4)
    wave = 2 * np.pi * BANDWIDTH_HZ * time
    length = driven_by(model, 0.1 * np.sin(wave)[:, None])[:, [2, 3]] @ [0.5, 0.5]
    both = np.stack([np.sin(wave), np.cos(wave)], 1)[2500:]
    assert np.hypot(*np.linalg.lstsq(both, length[2500:], rcond=None)[0]) == pytest.approx(0.0707, rel=0.03)


@pytest.mark.parametrize(
    ("actuator", "low", "high"),
    [
        ('<motor joint="j" ctrlrange="-2 3" gear="4"/>', -8, 12),
        ('<motor joint="j" ctrlrange="-2 3" gear="-4"/>', -12, 8),
        ('<motor joint="j" ctrlrange="-2 3" forcerange="-1 9"/>', -1, 3),
        ('<motor joint="j" forcerange="-1 2" gear="2"/>', -2, 4),
        ('<general joint="j" gainprm="5" ctrlrange="-1 2"/>', -5, 10),
        ('<general joint="j" gainprm="5" biastype="affine" biasprm="1 0 0" ctrlrange="-1 2"/>', -4, 11),
        ('<velocity joint="j" kv="7" ctrlrange="-1 1" forcerange="-3 2"/>', -3, 2),
    ],
)
def test_a_given_servo_has_the_torque_of_its_motor_and_no_more(actuator: str, low: float, high: float) -> None:
    model = compiled(FREE.format(joint='range="-3 3"', damping=0.01, armature=0.5, step=0.002, actuator=actuator))
    servos(model, "m", give=True)
    commands = np.repeat([3.0, -3.0, 3.0], 150)[:, None]
    torque = driven_by(model, commands)[:, 1]
    assert (torque.min(), torque.max()) == (low, high)


def test_a_speed_servo_without_a_force_limit_keeps_none() -> None:
    """What it could be told is a speed, which says nothing of its strength."""
    actuator = '<velocity joint="j" kv="7" ctrlrange="-1 1"/>'
    model = compiled(FREE.format(joint='range="-3 3"', damping=0, armature=0.5, step=0.002, actuator=actuator))
    servos(model, "m", give=True)
    assert not model.actuator_forcelimited[0]
    np.testing.assert_allclose(model.actuator_ctrlrange[0], [-3, 3])
    assert model.opt.integrator == int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST)


# ------------------------------------------------------------------ keyframes

KEY = '<keyframe><key name="home" qpos="0.3 0.1 0.2 0.2" ctrl="{}"/></keyframe>'


def test_a_key_without_commands_holds_its_posture_whatever_its_motors_were() -> None:
    both = affine('joint="shoulder"', 4, "7 -20 -1", 'ctrlrange="-9 9"') + '<motor tendon="grip"/>'
    model = compiled(robot(both, KEY.format("0 0")))
    servos(model, "m", give=True)
    np.testing.assert_allclose(model.key_ctrl, [[0.3, 0.4]])


def test_commands_of_a_key_are_carried_over_and_torques_become_its_posture() -> None:
    both = affine('joint="shoulder"', 4, "7 -20 -1", 'ctrlrange="-9 9"') + '<motor tendon="grip"/>'
    model = compiled(robot(both, KEY.format("0.5 0.9")))
    servos(model, "m", give=True)
    np.testing.assert_allclose(model.key_ctrl, [[(4 * 0.5 + 7) / 20, 0.4]])


# ------------------------------------------------------------------ refusals

BALL = '<body><joint name="ball" type="ball"/><geom size=".1"/></body></worldbody>'
THROUGH = '</fixed><spatial name="through"><site site="a"/><site site="b"/></spatial>'
REFUSED = {
    '<motor name="m" joint="shoulder"/>': "torque motor; --servos gives each such motor one",
    '<velocity name="m" joint="shoulder"/>': "speed servo; --servos gives each such motor one",
    '<muscle name="m" joint="shoulder"/>': "dynamics of its own",
    '<cylinder name="m" joint="shoulder"/>': "dynamics of its own",
    '<intvelocity name="m" joint="shoulder" kp="1" actrange="-1 1"/>': "dynamics of its own",
    '<position name="m" joint="shoulder" timeconst=".1"/>': "dynamics of its own",
    '<adhesion name="m" body="arm" ctrlrange="0 1"/>': r"neither a joint nor a tendon of joints \(.*body\)",
    '<position name="m" site="a"/>': r"neither a joint nor a tendon of joints \(.*site\)",
    '<position name="m" tendon="through"/>': "pulls a tendon through space; only <fixed>",
    '<position name="m" tendon="mixed"/>': "no hinges alone and no slides alone",
    '<position name="m" joint="ball"/>': "no hinges alone and no slides alone",
    '<position name="m" joint="endless"/>': "drives slide 'endless', which has no range",
    '<position name="m" tendon="none"/>': "tendon 'none', whose coefficients are all 0",
    '<position name="m" joint="shoulder" gear="0"/>': "gear 0 and moves nothing",
    '<position joint="shoulder"/><position name="m" joint="shoulder"/>': "another one moves it too",
    '<position tendon="grip"/><position name="m" joint="left"/>': "another one moves it too",
    '<position joint="rail"/><position name="m" tendon="rail"/>': "two motors that move what is named 'rail'",
}


@pytest.mark.parametrize("actuators", REFUSED)
def test_what_is_no_position_servo_is_refused_in_one_line(actuators: str, tmp_path: Path) -> None:
    text = robot(actuators)
    text = text.replace("<geom", '<site name="a"/><geom', 1).replace("</worldbody>", '<site name="b"/></worldbody>')
    text = (
        text.replace("</worldbody>", BALL)
        .replace("</fixed>", THROUGH)
        .replace("</worldbody>", '<body><joint name="endless" type="slide"/><geom size=".1"/></body></worldbody>')
    )
    more = {"mixed": '<joint joint="shoulder" coef="1"/><joint joint="rail" coef="1"/>',
            "none": '<joint joint="shoulder" coef="0"/>', "rail": '<joint joint="left" coef="1"/>'}  # fmt: skip
    text = text.replace("</tendon>", "".join(f'<fixed name="{n}">{j}</fixed>' for n, j in more.items()) + "</tendon>")
    path = tmp_path / "robot.xml"
    path.write_text(text)
    with pytest.raises(BodyError, match=REFUSED[actuators]) as caught:
        load_body(path)
    said = str(caught.value)
    assert "\n" not in said and len(said.removeprefix(str(path))) < 330 and said.startswith(f"{path}: actuator 'm' ")


def test_dynamics_of_its_own_are_refused_even_where_servos_are_given() -> None:
    for actuator in ('<muscle name="m" joint="shoulder"/>', '<position name="m" joint="shoulder" timeconst=".1"/>'):
        with pytest.raises(BodyError, match="dynamics of its own"):
            servos(compiled(robot(actuator)), "m", give=True)


# ------------------------------------------------------------------ a body of such motors

HAND = (
    '<position joint="shoulder" kp="60" kv="2"/><position joint="rail" kp="900" kv="40"/>'
    '<position tendon="grip" kp="3" kv=".2"/>'
)


@pytest.fixture
def hand(tmp_path: Path) -> Path:
    path = tmp_path / "hand.xml"
    path.write_text(robot(HAND))
    return path


def test_a_tendon_moves_all_its_joints_and_is_felt_as_long_as_it_is(hand: Path) -> None:
    body = load_body(hand, copies=2)
    assert body.joints == ("shoulder", "rail", "grip") and body.units == ("rad", "m", "rad")
    assert body.shown_units == ("deg", "mm", "deg")
    np.testing.assert_allclose(body.shown_scale, [180 / np.pi, 1000, 180 / np.pi])
    np.testing.assert_allclose(body.joint_range, [[-1.2, 1.5], [0, 0.3], [-1, 2]])
    # encoders read rad or m; a slide's tachometer two ranges a second
    np.testing.assert_allclose(body.sense_high, [1.5, 0.3, 2, 5, 0.6, 5])
    assert [body.senses[name].unit for name in ("angle", "speed")] == ["rad or m", "rad/s or m/s"]
    body.reset()
    data = mujoco.MjData(body.model)
    for _ in range(60):
        felt = body.act(np.array([[0.2, 0.5, 0.6], [0.0, 0.2, -0.6]]))
        for copy in range(2):
            data.qpos[:], data.qvel[:] = body.batch.qpos[copy], body.batch.qvel[copy]
            mujoco.mj_forward(body.model, data)
            assert felt[copy, 2] == pytest.approx(data.ten_length[0], abs=1e-12)
            assert felt[copy, 5] == pytest.approx(data.ten_velocity[0], abs=1e-12)
    left, right = body.batch.qpos[:, 2:].T
    assert (np.sign([left, right]) == [1, -1]).all() and (np.abs([left, right]) > 0.1).all()


def test_without_a_key_every_motor_holds_what_it_moves(hand: Path) -> None:
    """Also one whose tendon has the number of another joint."""
    hand.write_text(hand.read_text().replace('name="shoulder"', 'name="shoulder" ref="0.4"', 1))
    body = load_body(hand)
    body.reset()
    np.testing.assert_allclose(body.batch.ctrl[0], [0.4, 0, 0])


def test_configurations_have_the_positions_asked_for_and_followers_follow(hand: Path) -> None:
    hand.write_text(
        hand.read_text()
        .replace('tendon="grip"', 'joint="right"')
        .replace('joint2="right"', 'joint2="right" polycoef=".1 -.5 2 1 0"')
    )
    body = load_body(hand)
    told = np.random.default_rng(0).uniform(*body.joint_range.T, (9, 3))
    drawn = body.configurations(told)
    np.testing.assert_allclose(np.stack([position(body.model, one, drawn) for one in body.moved], 1), told)
    q = told[:, 2]
    np.testing.assert_allclose(drawn[:, 2], 0.1 - 0.5 * q + 2 * q**2 + q**3)


def test_a_tendons_joints_share_its_way(hand: Path) -> None:
    """The shortest way to a length L = sum share q is along the shares."""
    body = load_body(hand)
    drawn = body.configurations(np.array([[0.0, 0.0, 0.5]]))
    np.testing.assert_allclose(drawn[0, 2:], 0.5 * np.array([0.5, 1.5]) / (0.5**2 + 1.5**2))
    np.testing.assert_allclose(reach(body.model, body.moved[2]), [-1, 2])
    back = compiled(robot('<position tendon="grip"/>').replace('coef="1.5"', 'coef="-1.5"'))
    np.testing.assert_allclose(reach(back, driven(back, 0, "m")), [-0.25 - 1.5, 0.5 + 0.75])
    np.testing.assert_allclose(posed(body.model, body.moved, np.zeros(4), np.zeros((3, 3))), 0)


def test_a_jammed_tendon_is_jammed_in_all_its_joints(hand: Path) -> None:
    body = load_body(hand)
    body.reset()
    body.jam("grip")
    damping = body.batch.expand("dof_damping")[0]
    assert (damping[2:] == JAMMED).all() and (damping[:2] < 1).all()
    for _ in range(20):
        body.act(np.array([[0.0, 0.0, 1.0]]))
    assert np.abs(body.batch.qpos[0, 2:]).max() < 1e-6


def test_other_shares_or_ties_are_another_body(hand: Path) -> None:
    text, prints = hand.read_text().replace('kp="3"', 'kp="3" ctrlrange="-1 1"'), []  # the same commands
    for old, new in (("", ""), ('coef=".5"', 'coef=".6"'), ('joint2="right"', 'joint2="right" polycoef="0 .9 0 0 0"')):
        hand.write_text(text.replace(old, new, 1) if old else text)
        prints.append(load_body(hand).fingerprint)
    assert len({*prints}) == 3
