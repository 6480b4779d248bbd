"""Where HOAP-2's parts point: Pinocchio, MuJoCo and the teachers' anatomy say the same."""

import mujoco
import numpy as np

from models.hoap2 import ROBOT
from models.hoap2.facts import JOINTS, RANGES_DEG
from models.hoap2.kinematics import directions, ranges, robot
from models.hoap2.limbs import SEGMENTS
from models.motion import JointTrajectory
from models.teachers.performance import PARTS
from models.teachers.performing import perform_motion

LOW, HIGH = np.deg2rad([RANGES_DEG[joint] for joint in JOINTS]).T


def postures(count: int, seed: int) -> np.ndarray:
    """(count, 25) angles drawn at random from every joint's range."""
    return np.random.default_rng(seed).uniform(LOW, HIGH, (count, len(JOINTS)))


def test_body_is_the_declared_one() -> None:
    assert tuple(robot().names)[1:] == JOINTS
    np.testing.assert_allclose(ranges(), [LOW, HIGH], atol=1e-9)
    assert tuple(SEGMENTS) == PARTS


def test_directions_agree_with_mujoco() -> None:
    model = mujoco.MjModel.from_xml_path(str(ROBOT))
    data = mujoco.MjData(model)
    angles = postures(30, seed=1)
    found = directions(angles)
    for frame, posture in enumerate(angles):
        for joint, angle in zip(JOINTS, posture, strict=True):
            data.joint(joint).qpos[0] = angle
        mujoco.mj_kinematics(model, data)
        torso = data.body("torso").xmat.reshape(3, 3)
        for number, segment in enumerate(SEGMENTS.values()):
            body = data.xmat[model.joint(segment.joint).bodyid[0]].reshape(3, 3)
            np.testing.assert_allclose(found[frame, number], torso.T @ body @ segment.axis, atol=1e-9)


def test_hoap2_as_teacher_is_seen_as_its_kinematics_say() -> None:
    """The anatomical frames found from shoulders, hips and ankles are the ones HOAP-2 is drawn in."""
    angles = postures(20, seed=4)
    seen = perform_motion("hoap2", JointTrajectory("postures", np.arange(20.0), JOINTS, angles))
    for number, part in enumerate(PARTS):
        np.testing.assert_allclose(seen.directions[part], directions(angles)[:, number], atol=1e-9)
