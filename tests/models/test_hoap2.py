"""The compiled HOAP-2 is the declared one, mirrors itself, agrees with Pinocchio, and stands."""

import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from models.errors import BodyError
from models.hoap2 import ROBOT, SCENE, derive_gains, facts
from models.loading import hung
from models.robots import ROBOTS

GRAVITY = 9.81
MIRROR = np.diag([1.0, -1.0, 1.0])
LOADS = [f"{side}_sole_{end}_{edge}" for side in facts.SIDES for end in ("front", "rear") for edge in facts.SIDES]


STAND = Path("stand")  # where it hangs and babbles


def spec_of(path: Path) -> mujoco.MjSpec:
    return hung(ROBOTS["hoap2"]) if path == STAND else mujoco.MjSpec.from_file(str(path))


@cache
def compiled(path: Path) -> mujoco.MjModel:
    return spec_of(path).compile()


def at(path: Path, key: str | None = "zero", **degrees: float) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Model and forwarded data at a key, with some joints (degrees) changed."""
    model = compiled(path)
    data = mujoco.MjData(model)
    if key:
        mujoco.mj_resetDataKeyframe(model, data, model.key(key).id)
    for joint, angle in degrees.items():
        data.joint(joint).qpos[0] = np.deg2rad(angle)
    mujoco.mj_forward(model, data)
    return model, data


def contacts(model: mujoco.MjModel, data: mujoco.MjData) -> set[tuple[str, str]]:
    """Pairs of bodies that touch."""
    bodies = model.geom_bodyid
    return {tuple(sorted(model.body(bodies[g]).name for g in c.geom)) for c in data.contact}  # type: ignore[misc]


def fullinertia(model: mujoco.MjModel, body: str) -> np.ndarray:
    """Inertia about the CoM along the body's own axes."""
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body(body).iquat)
    turn = turn.reshape(3, 3)
    return turn @ np.diag(model.body(body).inertia) @ turn.T


def joint_space_inertia(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


# --- the compiled body against the declared numbers ---------------------------------------------------------------


@pytest.mark.parametrize("path", [SCENE, STAND], ids=lambda p: p.stem)
def test_declared_numbers(path: Path) -> None:
    model = compiled(path)
    for name, mass in facts.MASSES.items():
        assert model.body(name).mass[0] == pytest.approx(mass, abs=1e-9), name
    for name in facts.JOINTS:
        joint, dof, servo = model.joint(name), model.joint(name).dofadr[0], model.actuator(name)
        kind = facts.joint_class(name)
        np.testing.assert_allclose(np.rad2deg(joint.range), facts.RANGES_DEG[name], atol=1e-9, err_msg=name)
        torque = facts.TORQUE_LIMIT[kind]
        np.testing.assert_array_equal(servo.forcerange, [-torque, torque], err_msg=name)
        assert model.dof_armature[dof] == facts.ARMATURE[kind], name
        assert model.dof_damping[dof] == facts.DAMPING[kind], name
        assert model.dof_frictionloss[dof] == pytest.approx(facts.FRICTION_SHARE * torque), name
        centre, half = joint.range.mean(), np.ptp(joint.range) / 2 * facts.CONTROL_RANGE_FACTOR
        np.testing.assert_allclose(servo.ctrlrange, [centre - half, centre + half], atol=1e-12, err_msg=name)
    assert model.numeric("encoder_pulses_per_degree").data[0] == facts.ENCODER_PULSES_PER_DEGREE
    assert model.numeric("speed_limit").data[0] == facts.SPEED_LIMIT["leg"]
    assert model.numeric("head_speed_limit").data[0] == facts.SPEED_LIMIT["head"]


def test_total_mass() -> None:
    assert compiled(ROBOT).body_mass.sum() == pytest.approx(facts.TOTAL_MASS, abs=1e-3)
    assert sum(facts.MASSES.values()) == pytest.approx(facts.TOTAL_MASS, abs=1e-3)


@pytest.mark.parametrize("path", [SCENE, STAND], ids=lambda p: p.stem)
def test_one_order_everywhere(path: Path) -> None:
    """Joint i, servo i, position sensor i and velocity sensor i are the same joint; qpos ends with the 25."""
    model, data = at(path, "home")
    assert [model.actuator(i).name for i in range(model.nu)] == list(facts.JOINTS)
    assert [model.joint(i).name for i in range(model.njnt)][-25:] == list(facts.JOINTS)
    assert [model.sensor(i).name for i in range(25)] == [f"{j}_position" for j in facts.JOINTS]
    assert [model.sensor(i).name for i in range(25, 50)] == [f"{j}_velocity" for j in facts.JOINTS]
    data.qvel[-25:] = np.arange(25.0)
    mujoco.mj_forward(model, data)
    np.testing.assert_array_equal(data.sensordata[:25], data.qpos[-25:])
    np.testing.assert_array_equal(data.sensordata[25:50], data.qvel[-25:])
    home = np.deg2rad([facts.HOME_DEG.get(joint, 0.0) for joint in facts.JOINTS])
    np.testing.assert_allclose(data.qpos[-25:], home, atol=1e-8)
    for name, posture in (("home", home), ("zero", np.zeros(25))):
        np.testing.assert_allclose(model.key(name).ctrl, posture, atol=1e-8)


@pytest.mark.parametrize(("key", "height"), [("zero", facts.HEIGHT_STRAIGHT), ("home", facts.HEIGHT_CROUCHED)])
def test_height_and_soles(key: str, height: float) -> None:
    model, data = at(SCENE, key)
    crown = data.geom("head_collision").xpos[2] + model.geom("head_collision").size[0]
    assert crown == pytest.approx(height, abs=2e-3)
    for load in LOADS:
        assert data.site(load).xpos[2] == pytest.approx(0.0, abs=2e-5), load
    assert data.body("left_ankle").xpos[2] == pytest.approx(facts.SOLE_BELOW_ANKLE, abs=2e-5)


@pytest.mark.parametrize(
    ("arms", "key", "above_sole", "before_ankle"),
    [(0.0, "zero", 0.277, 0.0188), (90.0, "zero", 0.264, 0.0036), (90.0, "home", 0.254, 0.0171)],
)
def test_centre_of_mass(arms: float, key: str, above_sole: float, before_ankle: float) -> None:
    """Against values computed independently from the same masses, before this file existed."""
    _, data = at(SCENE, key, left_arm_joint_1=arms, right_arm_joint_1=arms)
    com = data.subtree_com[1]
    assert com[2] == pytest.approx(above_sole, abs=1e-3)
    assert com[0] - data.body("left_ankle").xpos[0] == pytest.approx(before_ankle, abs=1e-3)


# --- geometry ------------------------------------------------------------------------------------------------------


def test_mirror_image() -> None:
    """A mirrored posture puts every limb, with its mass and inertia, where the other one was."""
    model, data = at(STAND)
    other = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    swap = {"left": "right", "right": "left"}
    for _ in range(20):
        data.qpos[:] = rng.uniform(*model.jnt_range.T)
        for joint in facts.JOINTS:
            image, sign = facts.mirror(joint)
            other.joint(image).qpos[0] = sign * data.joint(joint).qpos[0]
        assert np.all((other.qpos >= model.jnt_range[:, 0]) & (other.qpos <= model.jnt_range[:, 1]))
        mujoco.mj_forward(model, data)
        mujoco.mj_forward(model, other)
        for name in facts.MASSES:
            side, _, limb = name.partition("_")
            image = f"{swap[side]}_{limb}" if side in swap else name
            np.testing.assert_allclose(other.body(image).xpos, MIRROR @ data.body(name).xpos, atol=1e-12)
            turned = MIRROR @ data.body(name).xmat.reshape(3, 3) @ MIRROR
            np.testing.assert_allclose(other.body(image).xmat.reshape(3, 3), turned, atol=1e-12)
            if side in swap:
                np.testing.assert_allclose(other.body(image).xipos, MIRROR @ data.body(name).xipos, atol=1e-12)
                inertia = MIRROR @ fullinertia(model, name) @ MIRROR
                np.testing.assert_allclose(fullinertia(model, image), inertia, rtol=1e-9, atol=1e-12)
                assert model.body(image).mass == model.body(name).mass


@pytest.mark.parametrize(
    ("joint", "degrees", "site", "towards"),
    [
        ("left_arm_joint_1", 90.0, "left_hand", (0, 0, -1)),
        ("left_arm_joint_2", 90.0, "left_hand", (0, 1, 0)),
        ("right_arm_joint_2", -90.0, "right_hand", (0, -1, 0)),
        ("left_arm_joint_4", -90.0, "left_hand", (0, 0, 1)),
        ("left_leg_joint_3", -80.0, "left_foot", (1, 0, 0)),
        ("left_leg_joint_4", 90.0, "left_foot", (-1, 0, 0)),
        ("left_leg_joint_2", 30.0, "left_foot", (0, 1, 0)),
        ("body_joint_1", 90.0, "left_foot", (1, 0, 0)),
    ],
)
def test_directions(joint: str, degrees: float, site: str, towards: tuple[float, float, float]) -> None:
    """The sign conventions of the published tree: where a limb's end goes when one joint moves."""
    start = at(STAND)[1].body(site).xpos.copy()
    moved = at(STAND, **{joint: degrees})[1].body(site).xpos - start
    assert moved @ np.asarray(towards) > 0.04


def test_arms_forward_at_zero() -> None:
    _, data = at(STAND)
    for side in facts.SIDES:
        reach = data.body(f"{side}_hand").xpos - data.body(f"{side}_shoulder_bracket").xpos
        np.testing.assert_allclose(reach, [0.201, 0, 0], atol=1e-12)


def test_eyes() -> None:
    """Two eyes look forward, level, side by side; + pan turns them left, + tilt down."""

    def gaze(**degrees: float) -> list[np.ndarray]:
        data = at(STAND, **degrees)[1]
        return [-data.cam(f"{side}_eye").xmat.reshape(3, 3)[:, 2] for side in facts.SIDES]

    _, data = at(STAND)
    for eye in gaze():
        np.testing.assert_allclose(eye, [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(data.cam("left_eye").xmat.reshape(3, 3)[:, 1], [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(data.cam("left_eye").xpos - data.cam("right_eye").xpos, [0, 0.045, 0], atol=1e-12)
    assert all(eye[1] > 0.4 for eye in gaze(head_joint_1=30))
    assert all(eye[2] < -0.4 for eye in gaze(head_joint_2=30))


# --- Pinocchio -----------------------------------------------------------------------------------------------------


def test_pinocchio_agrees() -> None:
    """Mass, link poses (1e-9 m) and joint-space inertia with armature (1e-9) at 100 random postures, torso free."""
    model = compiled(ROBOT)
    data = mujoco.MjData(model)
    peer = pin.buildModelFromMJCF(str(ROBOT))
    peer_data = peer.createData()
    assert sum(body.mass for body in peer.inertias) == pytest.approx(model.body_mass.sum(), rel=1e-12)
    columns = [peer.joints[peer.getJointId(joint)].idx_v for joint in facts.JOINTS]
    frames = {name: peer.getFrameId(name) for name in facts.MASSES}
    assert max(frames.values()) < peer.nframes
    rng = np.random.default_rng(0)
    for _ in range(100):
        turn = rng.normal(size=4)
        turn /= np.linalg.norm(turn)
        data.qpos[:3], data.qpos[3:7] = rng.normal(size=3), turn
        data.qpos[7:] = rng.uniform(*model.jnt_range[1:].T)
        mujoco.mj_forward(model, data)
        q = pin.neutral(peer)
        q[:3], q[3:7] = data.qpos[:3], np.roll(turn, -1)  # Pinocchio writes the scalar of a quaternion last
        for joint in facts.JOINTS:
            q[peer.joints[peer.getJointId(joint)].idx_q] = data.joint(joint).qpos[0]
        pin.framesForwardKinematics(peer, peer_data, q)
        for name, frame in frames.items():
            pose = peer_data.oMf[frame]
            np.testing.assert_allclose(data.body(name).xpos, pose.translation, atol=1e-9, err_msg=name)
            np.testing.assert_allclose(data.body(name).xmat.reshape(3, 3), pose.rotation, atol=1e-9, err_msg=name)
        theirs = pin.crba(peer, peer_data, q)
        theirs = np.triu(theirs) + np.triu(theirs, 1).T
        to_theirs = np.zeros((peer.nv, model.nv))  # MuJoCo moves a free body in world axes, Pinocchio in its own
        to_theirs[:3, :3] = data.body("torso").xmat.reshape(3, 3).T
        to_theirs[3:6, 3:6] = np.eye(3)
        to_theirs[columns, np.arange(6, 31)] = 1
        ours = joint_space_inertia(model, data)
        scale = np.sqrt(np.outer(np.diag(ours), np.diag(ours)))
        assert np.max(np.abs(to_theirs.T @ theirs @ to_theirs - ours) / scale) < 1e-9


# --- servos --------------------------------------------------------------------------------------------------------


def test_gains_are_derived() -> None:
    """What stands in the file is what the script derives, and deriving again changes nothing."""
    robot = ROBOT.read_text()
    gains = derive_gains.derive(compiled(ROBOT))
    assert list(gains) == list(facts.JOINTS)
    assert derive_gains.with_gains(robot, gains) == robot
    spoilt = robot.replace(f'kp="{gains["body_joint_1"].kp:g}"', 'kp="1"')
    assert spoilt != robot
    assert derive_gains.with_gains(spoilt, gains) == robot
    for side in ("leg_joint_4", "arm_joint_1"):
        assert gains[f"left_{side}"][1:] == gains[f"right_{side}"][1:]
    with pytest.raises(BodyError, match='0 actuators <position name="body_joint_1"'):
        derive_gains.with_gains("<mujoco/>", gains)


def test_closed_loop_of_each_joint() -> None:
    """Compiled gains against the law: natural frequency and -3 dB frequency in 7..15 Hz, damping ratio in 0.7..1."""
    model, data = at(STAND, "home")
    inertia = np.diag(joint_space_inertia(model, data))
    stiffness, drag = model.actuator_gainprm[:, 0], model.dof_damping - model.actuator_biasprm[:, 2]
    natural = np.sqrt(stiffness / inertia) / (2 * np.pi)
    ratio = drag / (2 * np.sqrt(stiffness * inertia))
    np.testing.assert_allclose(natural, derive_gains.natural_frequency_hz(), rtol=1e-3)
    np.testing.assert_allclose(ratio, derive_gains.DAMPING_RATIO, rtol=1e-3)
    assert 7 <= derive_gains.BANDWIDTH_HZ <= derive_gains.natural_frequency_hz() <= 15
    assert 0.7 <= derive_gains.DAMPING_RATIO <= 1
    w = 2 * np.pi * derive_gains.BANDWIDTH_HZ
    answer = stiffness / (stiffness - inertia * w**2 + 1j * w * drag)
    np.testing.assert_allclose(np.abs(answer), np.sqrt(0.5), rtol=2e-3)


def test_closed_loop_of_the_whole_body() -> None:
    """Stepped physics linearised at `home`, all servos alive, dry friction off: each joint's -3 dB within 7..15 Hz."""
    model, data = at(STAND, "home")
    model = spec_of(STAND).compile()
    model.dof_frictionloss[:] = 0
    a, b = np.zeros((50, 50)), np.zeros((50, 25))
    mujoco.mjd_transitionFD(model, data, 1e-6, True, a, b, None, None)

    def gain(hz: float) -> np.ndarray:
        z = np.exp(2j * np.pi * hz * model.opt.timestep)
        return np.abs(np.diag(np.linalg.solve(z * np.eye(50) - a, b)[:25]))

    np.testing.assert_allclose(gain(1e-3), 1, atol=0.03)  # gravity bends the waist and hips by up to 1 %
    assert gain(7.0).min() > np.sqrt(0.5) > gain(15.0).max()
    assert max(gain(hz).max() for hz in range(1, 30)) < 1.01  # no resonance


@pytest.mark.parametrize("path", [SCENE, STAND], ids=lambda p: p.stem)
def test_control_noise_raises_no_warning(path: Path) -> None:
    model, data = at(path, "home")
    rng = np.random.default_rng(0)
    for _ in range(round(1 / model.opt.timestep)):
        data.ctrl[:] = rng.uniform(*model.actuator_ctrlrange.T)
        mujoco.mj_step(model, data)
    assert [warning.number for warning in data.warning] == [0] * len(data.warning)
    assert np.isfinite(data.qpos).all() and np.ptp(data.qpos) > 0.1


# --- touching ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("key", ["home", "zero"])
def test_no_self_contact(key: str) -> None:
    model, data = at(SCENE, key)
    data.qpos[2] += 1.0
    mujoco.mj_forward(model, data)
    assert contacts(model, data) == set()


@pytest.mark.parametrize(
    ("posture", "pair"),
    [
        ({"left_leg_joint_2": -20, "right_leg_joint_2": 20}, ("left_shank", "right_shank")),
        ({"left_leg_joint_1": -31}, ("left_foot", "right_foot")),
        ({"body_joint_1": 90, "left_leg_joint_3": -82}, ("left_thigh", "torso")),
        ({"left_arm_joint_2": 0, "left_arm_joint_3": 70, "left_arm_joint_4": -30}, ("left_hand", "left_thigh")),
    ],
)
def test_self_contact_is_felt(posture: dict[str, float], pair: tuple[str, str]) -> None:
    model, data = at(SCENE, "home", **posture)
    assert pair in contacts(model, data)


def test_legs_do_not_pass_through_each_other() -> None:
    """The servos press the shanks together; the contact holds them apart."""
    model, data = at(SCENE, "zero")
    data.qpos[2] = 1.0
    model = mujoco.MjModel.from_xml_path(str(SCENE))
    model.opt.gravity[:] = 0
    data.actuator("left_leg_joint_2").ctrl[0], data.actuator("right_leg_joint_2").ctrl[0] = np.deg2rad([-20, 20])
    for _ in range(300):
        mujoco.mj_step(model, data)
    gap = (data.body("left_ankle").xpos - data.body("right_ankle").xpos) @ data.body("pelvis").xmat.reshape(3, 3)[:, 1]
    assert gap > 0.055
    assert ("left_foot", "right_foot") in contacts(model, data)


def test_stands_on_its_own_servos() -> None:
    """Two seconds at home: still up, and the eight load cells carry the whole weight."""
    model, data = at(SCENE, "home")
    start = data.body("torso").xpos[2]
    for _ in range(round(2 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    assert data.body("torso").xpos[2] == pytest.approx(start, abs=3e-3)
    assert np.abs(data.qvel).max() < 0.01
    loads = np.array([data.sensor(f"{load}_load").data[0] for load in LOADS])
    assert np.all(loads > 1)
    assert loads.sum() == pytest.approx(GRAVITY * facts.TOTAL_MASS, rel=1e-2)
    assert loads[:4].sum() == pytest.approx(loads[4:].sum(), rel=0.05)
    np.testing.assert_allclose(np.linalg.norm(data.sensor("accelerometer").data), GRAVITY, rtol=1e-2)
    np.testing.assert_allclose(data.sensor("gyro").data, 0, atol=0.01)


# --- the stand -----------------------------------------------------------------------------------------------------


def test_it_hangs_in_the_postures_it_stands_in() -> None:
    """Keys are the scene's without the free joint's part; the torso hangs at its height."""
    stand, scene = compiled(STAND), compiled(SCENE)
    assert [stand.key(i).name for i in range(stand.nkey)] == ["home", "zero"]
    np.testing.assert_array_equal([stand.key_qpos, stand.key_ctrl], [scene.key_qpos[:, 7:], scene.key_ctrl])
    assert stand.body("torso").pos[2] == facts.TORSO_HEIGHT


def test_stand_reaches_nothing() -> None:
    """25 joints move, the torso does not, and no posture comes near the floor or makes contact."""
    model, data = at(STAND)
    assert (model.nq, model.nv, model.nu) == (25, 25, 25)
    rng = np.random.default_rng(0)
    solid = [g for g in range(model.ngeom) if model.geom_group[g] == 3]
    half = np.where((model.geom_type == mujoco.mjtGeom.mjGEOM_SPHERE)[:, None], 0, model.geom_size)
    round_ = np.where(model.geom_type == mujoco.mjtGeom.mjGEOM_SPHERE, model.geom_size[:, 0], 0)
    lowest = np.inf
    for _ in range(500):
        data.qpos[:] = np.where(rng.random(25) < 0.5, *model.jnt_range.T)
        mujoco.mj_forward(model, data)
        drop = np.abs(data.geom_xmat[:, 6:]) * half
        lowest = min(lowest, (data.geom_xpos[:, 2] - drop.sum(axis=1) - round_)[solid].min())
        assert data.ncon == 0
    assert lowest > 0.1


def test_stand_and_scene_are_the_same_body() -> None:
    """Joint-space inertia of the 25 joints with the torso fixed is one and the same."""
    free, fixed = (joint_space_inertia(*at(path, "home")) for path in (SCENE, STAND))
    np.testing.assert_allclose(free[6:, 6:], fixed, rtol=1e-6, atol=1e-9)


# --- manners -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", [ROBOT, SCENE, STAND], ids=lambda p: p.stem)
def test_every_element_is_named(path: Path) -> None:
    spec = spec_of(path)
    elements = [*spec.bodies, *spec.joints, *spec.geoms, *spec.sites, *spec.cameras, *spec.lights]
    elements += [*spec.actuators, *spec.sensors, *spec.excludes, *spec.keys]
    assert len(elements) > 200
    assert [element for element in elements if not element.name] == []


def test_robot_is_alone_and_attachable() -> None:
    """No floor, no light, one rooted default class; two of them live in one world."""
    root = ET.parse(ROBOT).getroot()
    assert [default.get("class") for default in root.findall("default/default")] == ["hoap2"]
    assert [body.get("name") for body in root.findall("worldbody/*")] == ["torso"]
    assert root.find(".//light") is None
    world = mujoco.MjSpec()
    for prefix, y in (("a/", 0.0), ("b/", 1.0)):
        world.attach(mujoco.MjSpec.from_file(str(ROBOT)), prefix=prefix, frame=world.worldbody.add_frame(pos=[0, y, 0]))
    both = world.compile()
    assert (both.nu, both.njnt) == (50, 52)
    assert both.body("b/torso").mass[0] == facts.MASSES["torso"]


def test_shapes_are_seen_or_felt() -> None:
    """Group 2 is seen and touches nothing, group 3 is felt; neither weighs anything beside the declared masses."""
    model = compiled(ROBOT)
    names = np.array([model.geom(g).name for g in range(model.ngeom)])
    felt = np.array([name.endswith("_collision") for name in names])
    np.testing.assert_array_equal(model.geom_group, np.where(felt, 3, 2))
    np.testing.assert_array_equal(model.geom_contype, felt)
    np.testing.assert_array_equal(model.geom_conaffinity, felt)


def test_motion_file_signs() -> None:
    """21 columns: two legs, two arms without hands, and the waist; each a sign."""
    order = [f"right_leg_joint_{i}" for i in range(1, 7)] + [f"right_arm_joint_{i}" for i in range(1, 5)]
    order += [f"left_leg_joint_{i}" for i in range(1, 7)] + [f"left_arm_joint_{i}" for i in range(1, 5)]
    assert list(facts.PULSE_SIGNS) == [*order, "body_joint_1"]
    assert set(facts.PULSE_SIGNS.values()) == {-1, 1}


def test_home_lies_within_the_ranges() -> None:
    for joint, angle in facts.HOME_DEG.items():
        low, high = facts.RANGES_DEG[joint]
        assert low < angle < high
        image, sign = facts.mirror(joint)
        assert facts.HOME_DEG[image] == sign * angle
    assert all(low < high for low, high in facts.RANGES_DEG.values())
