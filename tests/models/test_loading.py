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


BASE = '<joint name="rootx" type="slide" axis="1 0 0"/><joint name="rootz" type="slide" axis="0 0 1"/>' \
    '<joint name="rooty" axis="0 1 0"/>'  # fmt: skip
LEG = """<mujoco><compiler autolimits="true" angle="radian"/><option timestep="{step}"/><worldbody><body name="trunk">
  {base}<geom size=".1"/><site name="s"/><body pos="0 0 -.3"><joint name="hip" axis="0 1 0" range="{hip}" damping="1"/>
  <geom size=".05"/><site name="t"/><body pos="0 0 -.3"><joint name="knee" axis="0 1 0" range="{knee}" damping="1"/>
  <geom size=".05"/></body></body></body></worldbody>{more}<actuator>{motors}</actuator></mujoco>"""
BOTH = '<position joint="hip" kp="5"/><position joint="knee" kp="5"/>'


def leg(tmp_path: Path, motors: str = BOTH, **how: str) -> Path:
    usual = {"base": BASE, "hip": "-1 1", "knee": "-1 1", "more": "", "step": "0.004"}
    return written(tmp_path, LEG.format(**(usual | how), motors=motors))


def joints(model: mujoco.MjModel) -> list[str]:
    return [model.joint(i).name for i in range(model.njnt)]


@pytest.mark.parametrize(
    "more",
    [
        "",
        '<sensor><jointpos joint="rootx"/><framepos objtype="site" objname="s"/></sensor>',
        '<keyframe><key name="home" qpos="9 8 7 0.3 -0.4" qvel="9 8 7 6 5"/></keyframe>',
        '<tendon><spatial stiffness="1"><site site="s"/><site site="t"/></spatial></tendon>',  # has sites 0 and 1
    ],
)
def test_a_planar_base_is_hung(tmp_path: Path, more: str) -> None:
    body = load_body(leg(tmp_path, more=more))
    assert joints(body.model) == ["hip", "knee"]
    rest = [0.3, -0.4] if "home" in more else [0, 0]
    np.testing.assert_array_equal(body.joint_angles, [rest])
    np.testing.assert_array_equal(body.batch.ctrl, [rest])


def test_a_planar_base_is_hung_too_where_tendons_are_pulled(tmp_path: Path) -> None:
    tendon = '<tendon><fixed name="f"><joint joint="hip" coef="1"/><joint joint="knee" coef="1"/></fixed></tendon>'
    body = load_body(leg(tmp_path, '<position tendon="f" kp="5"/>', more=tendon))
    assert joints(body.model) == ["hip", "knee"] and body.joints == ("f",)


@pytest.mark.parametrize(
    ("motors", "more", "kept"),
    [
        (BOTH + '<position joint="rootz" kp="9"/>', "", ["rootz"]),
        (BOTH, '<equality><joint joint1="rooty" joint2="hip"/></equality>', ["rooty"]),
        (BOTH, '<tendon><fixed stiffness="1"><joint joint="rootx" coef="1"/></fixed></tendon>', ["rootx"]),
    ],
)
def test_a_base_that_something_holds_stays(tmp_path: Path, motors: str, more: str, kept: list[str]) -> None:
    base = BASE.replace('"rootz"', '"rootz" range="-1 1"')
    assert joints(load_body(leg(tmp_path, motors, more=more, base=base)).model) == [*kept, "hip", "knee"]


def test_a_pole_on_a_cart_swings_and_what_has_no_motors_stays_as_it_is(tmp_path: Path) -> None:
    text = """<mujoco><worldbody><body><joint name="cart" type="slide" axis="1 0 0" range="-1 1" limited="true"/>
      <geom size=".1"/><body><joint name="pole"/><geom size=".1" pos="0 0 .5"/></body></body><body pos="3 0 0">
      <joint name="door"/><geom size=".1"/></body></worldbody><actuator><position joint="cart" kp="9"/></actuator>
      </mujoco>"""
    body = load_body(written(tmp_path, text))
    assert joints(body.model) == ["cart", "pole", "door"] and body.joints == ("cart",)


def test_a_key_of_another_name_is_home_where_there_is_none(tmp_path: Path) -> None:
    keys = '<keyframe><key name="{}" qpos="9 8 7 .3 -.4"/><key name="{}" qpos="1 1 1 .5 2"/></keyframe>'
    for names, rest in ((("stand", "sit"), [0.3, -0.4]), (("sit", "home"), [0.5, 2])):
        body = load_body(leg(tmp_path, more=keys.format(*names), knee="-1 3"))
        np.testing.assert_allclose(body.joint_angles, [rest])
        np.testing.assert_allclose(body.batch.ctrl, [rest])


def test_a_zero_posture_out_of_range_is_cut_to_it(tmp_path: Path) -> None:
    """At rest, and when torque motors get their servos, which hold it."""
    for motors in (BOTH, BOTH.replace("position", "motor").replace(' kp="5"', "")):
        body = load_body(leg(tmp_path, motors, hip="0.2 1", knee="-2 -0.5"), give_servos=True)
        np.testing.assert_allclose(body.joint_angles, [[0.2, -0.5]])
        np.testing.assert_allclose(body.batch.ctrl, [[0.2, -0.5]])
        assert set(body.given) == (set() if "position" in motors else {"hip", "knee"})


@pytest.mark.parametrize(
    ("asked", "steps"), [("0.003", 7), ("0.02", 1), ("1", 1), ("0.005", 4), ("0.0199999", 2), ("2e-5", 1000)]
)
def test_a_tick_is_whole_steps_none_longer_than_asked_for(tmp_path: Path, asked: str, steps: int) -> None:
    body = load_body(leg(tmp_path, step=asked))
    assert body.substeps == steps and body.model.opt.timestep == pytest.approx(0.02 / steps)
    assert body.model.opt.timestep <= float(asked) * (1 + 1e-6)
    body.reset()
    body.act(np.zeros((1, 2)))
    assert body.time == pytest.approx(0.02)


@pytest.mark.parametrize("step", ["1e-6", "1.99e-5", "0", "-1"])
def test_a_timestep_that_would_never_end_is_refused(tmp_path: Path, step: str) -> None:
    with pytest.raises(BodyError, match=r"its timestep of .* steps of every control tick .* 2e-05 s or more") as caught:
        load_body(leg(tmp_path, step=step))
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 400


def test_meshes_are_looked_at_before_they_are_read(tmp_path: Path) -> None:
    text = """<mujoco><asset><mesh name="m" file="m.stl"/></asset><worldbody><body><joint name="j" range="-1 1"
      limited="true"/><geom type="mesh" mesh="m"/></body></worldbody><actuator><position joint="j" kp="1"/></actuator>
      </mujoco>"""
    path, mesh = written(tmp_path, text), tmp_path / "m.stl"
    with pytest.raises(BodyError, match="MuJoCo cannot compile it"):
        load_body(path)
    os.mkfifo(mesh)
    with pytest.raises(BodyError, match="this is no regular file"):
        load_body(path)
    mesh.unlink()
    with open(mesh, "wb") as f:
        os.truncate(f.fileno(), 300 << 20)
    with pytest.raises(BodyError, match="has 300 MB where at most 128 MB are read"):
        load_body(path)
