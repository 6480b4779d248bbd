import mujoco
import numpy as np
import pytest

from models.biclops import ROBOT, facts
from models.biclops.profile import profile
from models.biclops.room import FACE_PREFIX, FEATURES, TEACHER, Ball, wear_cloth
from models.heads import stage


@pytest.fixture(scope="module")
def robot() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(ROBOT))


def test_the_compiled_head_is_what_the_facts_say(robot: mujoco.MjModel) -> None:
    hard = np.deg2rad([facts.PAN_RANGE_DEG, facts.TILT_RANGE_DEG])
    soft = hard - np.deg2rad(facts.SOFT_MARGIN_DEG)
    np.testing.assert_allclose(robot.jnt_range, np.stack([-hard, hard], 1))
    np.testing.assert_allclose(robot.actuator_ctrlrange, np.stack([-soft, soft], 1))
    np.testing.assert_allclose(robot.actuator_forcerange, [[-facts.TORQUE_LIMIT, facts.TORQUE_LIMIT]] * 2)
    assert {name: robot.body(name).mass[0] for name in facts.MASSES} == pytest.approx(facts.MASSES)
    for name, (radius, length) in (("pan", facts.PAN_CYLINDER), ("tilt", facts.TILT_CYLINDER)):
        np.testing.assert_allclose(robot.geom(name).size[:2], [radius, length / 2])
    assert robot.numeric("encoder_pulses_per_degree").data[0] * 360 == pytest.approx(facts.ENCODER_COUNTS)
    assert robot.numeric("speed_limit").data[0] == pytest.approx(np.deg2rad(max(facts.MAX_SPEED_DEG_S)))


def test_axes_intersect_and_cameras_sit_where_they_should(robot: mujoco.MjModel) -> None:
    data = mujoco.MjData(robot)
    mujoco.mj_forward(robot, data)
    axes = np.array([0.0, 0.0, facts.PAN_HEIGHT])
    np.testing.assert_allclose(data.xanchor, [axes, axes], atol=1e-12)
    left, right = data.cam("left_eye").xpos, data.cam("right_eye").xpos
    np.testing.assert_allclose(left - right, [0, facts.BASELINE, 0], atol=1e-12)
    np.testing.assert_allclose((left + right) / 2 - axes, [0, 0, facts.CAMERA_HEIGHT], atol=1e-12)
    data.qpos[:] = 0.3, 0.4  # positive pan looks left, positive tilt looks down
    mujoco.mj_forward(robot, data)
    gaze = -data.cam("left_eye").xmat.reshape(3, 3)[:, 2]
    np.testing.assert_allclose(gaze, [np.cos(0.3) * np.cos(0.4), np.sin(0.3) * np.cos(0.4), -np.sin(0.4)], atol=1e-12)


def test_everything_has_a_name_and_noise_raises_no_warning(robot: mujoco.MjModel) -> None:
    for count, element in ((robot.nbody, robot.body), (robot.ngeom, robot.geom), (robot.nsensor, robot.sensor)):
        assert all(element(i).name for i in range(count))
    data = mujoco.MjData(robot)
    mujoco.mj_resetDataKeyframe(robot, data, robot.key("home").id)
    rng = np.random.default_rng(0)
    for _ in range(500):
        data.ctrl[:] = rng.uniform(*robot.actuator_ctrlrange.T)
        mujoco.mj_step(robot, data)
    assert not data.warning.number.any()


def test_servos_follow_the_run_profile(robot: mujoco.MjModel) -> None:
    data = mujoco.MjData(robot)
    speed, acceleration = np.deg2rad(facts.MAX_SPEED_DEG_S), np.deg2rad(facts.MAX_ACCELERATION_DEG_S2)
    target, position, velocity = np.deg2rad([90.0, -40.0]), np.zeros(2), np.zeros(2)
    for _ in range(1200):
        position, velocity = profile(position, velocity, target, speed, acceleration, robot.opt.timestep)
        data.ctrl[:] = position
        mujoco.mj_step(robot, data)
    np.testing.assert_allclose(np.rad2deg(data.qpos - target), 0.0, atol=0.2)


def move_time(distance, speed, acceleration):
    """Seconds from rest to rest in continuous time: a trapezoid of speed, or a triangle."""
    trapezoid, triangle = distance / speed + speed / acceleration, 2 * np.sqrt(distance / acceleration)
    return np.where(distance >= speed**2 / acceleration, trapezoid, triangle)


def test_profile_moves_as_theory_says() -> None:
    rng = np.random.default_rng(2)
    distance, speed, acceleration = rng.uniform([0.01, 0.3, 1.0], [6.0, 4.0, 10.0], (400, 3)).T
    for dt in (0.002, 0.02):
        position, velocity = np.zeros(400), np.zeros(400)
        arrived, clock = np.full(400, np.inf), 0.0
        expected = move_time(distance, speed, acceleration)
        while clock < expected.max() + 10 * dt:
            before = velocity
            position, velocity = profile(position, velocity, distance, speed, acceleration, dt)
            clock += dt
            assert (np.abs(velocity) <= speed + 1e-12).all()
            assert (np.abs(velocity - before) <= acceleration * dt + 1e-9).all()
            assert (position <= distance + 1e-9).all()  # no overshoot
            arrived = np.where(np.abs(position - distance) < 1e-9, np.minimum(arrived, clock), arrived)
        assert (arrived >= expected - dt).all()
        assert (arrived <= expected + 2 * dt).all()


def test_published_example_ninety_degrees_of_pan_take_1_1_seconds() -> None:
    assert float(move_time(90.0, facts.MAX_SPEED_DEG_S[0], facts.MAX_ACCELERATION_DEG_S2[0])) == pytest.approx(1.1)


def test_profile_turns_round_when_the_target_changes() -> None:
    position, velocity = np.zeros(2), np.array([2.0, -2.0])
    for _ in range(3000):
        position, velocity = profile(position, velocity, [-1.0, 0.5], 2.5, 5.0, 0.002)
    np.testing.assert_allclose(position, [-1.0, 0.5], atol=1e-9)


def test_a_teacher_faces_us_and_wears_cloths() -> None:
    model = stage(
        "biclops", teacher=True, distance=0.7, balls=[Ball("plum", (0.4, 0.2, 0.02), (0.5, 0.0, 1.0))]
    ).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    ours, theirs = data.cam("left_eye"), data.cam(f"{TEACHER}left_eye")
    np.testing.assert_allclose(ours.xmat.reshape(3, 3)[:, 2], -theirs.xmat.reshape(3, 3)[:, 2], atol=1e-12)
    for name in FEATURES:
        assert 0.5 < data.geom(f"{TEACHER}{FACE_PREFIX}{name}").xpos[0] < 0.75
    np.testing.assert_allclose(data.geom("plum").xpos, [0.4, 0.2, 0.02])
    for cloth in ("blindfold", "headband", None):
        wear_cloth(model, cloth)
        for name in ("blindfold", "headband"):
            assert model.geom(f"{TEACHER}{FACE_PREFIX}{name}").rgba[3] == float(name == cloth)
