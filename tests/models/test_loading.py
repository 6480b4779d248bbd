"""Bodies from files: what a stranger's MJCF must be, and what is said when it is not."""

import os
from pathlib import Path

import mujoco
import numpy as np
import pytest

from models.errors import BodyError
from models.loading import load_body


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "robot.xml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("</worldbody>", "", "MuJoCo cannot compile it"),
        ('joint="elbow"/>', 'joint="elbo"/>', "MuJoCo cannot compile it"),
        ('mass="0.4"', 'mass="heavy"', "MuJoCo cannot compile it"),
        ("<actuator>", "<!--", "MuJoCo cannot compile it"),
        ('<position name="elbow" joint="elbow"/>', '<motor name="elbow" joint="elbow"/>', "actuator 'elbow' is not a"),
        ('<position name="elbow" joint="elbow"/>', '<position name="twice" joint="wrist"/>', "actuator 'wrist' is not"),
        ('<position name="elbow"', '<velocity name="elbow"', "actuator 'elbow' is not a position servo"),
    ],
)
def test_spoiled_robots(arm: Path, tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in arm.read_text()
    path = written(tmp_path, arm.read_text().replace(old, new))
    with pytest.raises(BodyError, match=message) as caught:
        load_body(path)
    assert "\n" not in str(caught.value) and str(path) in str(caught.value)


def test_no_actuators(tmp_path: Path) -> None:
    path = written(tmp_path, '<mujoco><worldbody><body><joint/><geom size="1"/></body></worldbody></mujoco>')
    with pytest.raises(BodyError, match=r"has no position actuators; add <position joint=... kp=...>"):
        load_body(path)


@pytest.mark.parametrize("content", [b"", b"\x00\xff\xfe garbage", b"<html></html>", b"not xml at all", b"<mujoco>"])
def test_files_that_are_no_mjcf(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "robot.xml"
    path.write_bytes(content)
    with pytest.raises(BodyError, match=r"robot\.xml: ") as caught:
        load_body(path)
    assert "\n" not in str(caught.value)


def test_missing_directories_huge_and_unknown(tmp_path: Path) -> None:
    with pytest.raises(BodyError, match="no such file"):
        load_body(tmp_path / "none.xml")
    with pytest.raises(BodyError, match="this is a directory; name one file in it"):
        load_body(tmp_path)
    with open(tmp_path / "huge.xml", "wb") as f:
        os.truncate(f.fileno(), 10 << 30)
    with pytest.raises(BodyError, match="has 10,240 MB where at most 64 MB are read"):
        load_body(tmp_path / "huge.xml")
    with pytest.raises(
        BodyError, match=r"unknown robot 'hoap3'; .*did you mean 'hoap2'\?.* or the path of an MJCF file"
    ):
        load_body("hoap3")


def test_a_free_robot_is_hung_by_its_root_and_touches_nothing(arm: Path, tmp_path: Path) -> None:
    text = arm.read_text().replace('<body name="upper" pos="0 0 1">', '<body name="base" pos="0 0 1"><freejoint/>'
                        '<geom name="base" size="0.05" mass="1"/><body name="upper">')  # fmt: skip
    text = text.replace(
        "</worldbody>", '</body><geom name="floor" type="plane" size="1 1 1" pos="0 0 0.9"/></worldbody>'
    )
    body = load_body(written(tmp_path, text), copies=2)
    assert body.joints == ("shoulder", "elbow", "wrist")
    assert body.model.nq == 3
    for _ in range(20):
        body.act(np.full((2, 3), 0.4))
    assert body.joint_angles.max() > 0.1
    data = mujoco.MjData(body.model)
    data.qpos[:] = body.batch.qpos[0]
    mujoco.mj_forward(body.model, data)
    assert data.ncon == 0


def test_a_hung_robot_keeps_its_keys_without_the_root(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        """<mujoco><worldbody><body><joint name="a" range="-1 1" limited="true"/><geom size="0.1"/></body>
        <body pos="1 0 1"><freejoint/><geom size="0.1"/><body><joint name="b" range="-1 1" limited="true"/>
        <geom size="0.1"/></body></body></worldbody><actuator><position joint="a" kp="1"/><position joint="b" kp="1"/>
        </actuator><keyframe><key name="home" qpos="0.3 1 2 3 1 0 0 0 -0.4" qvel="0 1 2 3 4 5 6 7"/></keyframe>
        </mujoco>""",
    )
    body = load_body(path)
    np.testing.assert_array_equal(body.joint_angles, [[0.3, -0.4]])


def test_joints_without_names_or_limits_get_some(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        '<mujoco><option timestep="0.005" integrator="implicitfast"/><worldbody><body><joint damping="1"/>'
        '<geom size="0.1"/></body></worldbody><actuator><position joint="j" kp="1"/></actuator></mujoco>'.replace(
            "<joint ", '<joint name="j" '
        ),
    )
    body = load_body(path)
    np.testing.assert_allclose(body.joint_range, [[-np.pi, np.pi]])
    assert body.act(np.array([[0.1]])).shape == (1, 2)
