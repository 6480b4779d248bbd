"""HOAP-2 on its seat is HOAP-2: only what is fixed is another body, and palms and forehead feel."""

from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest

from models.hoap2 import ROBOT, SEAT, derive_seat, facts
from models.loading import load_body
from models.objects.scene import EVERYTHING, THING, seated
from models.robots import ROBOTS, Seat
from tests.models.test_hoap2 import fullinertia

LIMBS = [name for name in facts.MASSES if name not in ("torso", "pelvis")]


@cache
def compiled(path: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(path)


ROBOT_MODEL, SEAT_MODEL = (compiled(str(path)) for path in (ROBOT, SEAT))


def at_home(**radians: float) -> mujoco.MjData:
    data = mujoco.MjData(SEAT_MODEL)
    mujoco.mj_resetDataKeyframe(SEAT_MODEL, data, SEAT_MODEL.key("home").id)
    for joint, angle in radians.items():
        data.joint(joint).qpos[0] = angle
    mujoco.mj_forward(SEAT_MODEL, data)
    return data


def test_the_file_is_what_is_derived(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert SEAT.read_text() == derive_seat.derive(ROBOT.read_text())
    monkeypatch.setattr("sys.argv", ["derive_seat"])
    monkeypatch.setattr(derive_seat, "SEAT", tmp_path / "seat.xml")
    assert derive_seat.main() == 1 and "run with --write" in capsys.readouterr().out
    monkeypatch.setattr("sys.argv", ["derive_seat", "--write"])
    assert derive_seat.main() == 0 and (tmp_path / "seat.xml").read_text() == SEAT.read_text()


def test_it_is_the_same_body() -> None:
    """Masses, inertias, ranges, gears and servos, one by one; the pelvis does not hang from anything any more."""
    assert SEAT_MODEL.nbody == ROBOT_MODEL.nbody and SEAT_MODEL.nu == ROBOT_MODEL.nu == SEAT_MODEL.nv
    for name in facts.MASSES:
        assert SEAT_MODEL.body(name).mass[0] == ROBOT_MODEL.body(name).mass[0], name
        np.testing.assert_allclose(fullinertia(SEAT_MODEL, name), fullinertia(ROBOT_MODEL, name), atol=1e-12)
    for name in LIMBS:
        np.testing.assert_array_equal(SEAT_MODEL.body(name).pos, ROBOT_MODEL.body(name).pos)
    for name in facts.JOINTS:
        ours, theirs = SEAT_MODEL.joint(name), ROBOT_MODEL.joint(name)
        np.testing.assert_array_equal(ours.range, theirs.range)
        for field in ("dof_armature", "dof_damping", "dof_frictionloss"):
            assert getattr(SEAT_MODEL, field)[ours.dofadr[0]] == getattr(ROBOT_MODEL, field)[theirs.dofadr[0]], name
        for field in ("gainprm", "biasprm", "ctrlrange", "forcerange"):
            np.testing.assert_array_equal(
                getattr(SEAT_MODEL.actuator(name), field), getattr(ROBOT_MODEL.actuator(name), field), err_msg=name
            )
    assert [SEAT_MODEL.actuator(i).name for i in range(SEAT_MODEL.nu)] == list(facts.JOINTS)


def test_the_waist_moves_what_is_above_it_and_leans_forward_with_a_positive_angle() -> None:
    """The torso turns about the very line that the legs turned about: the same waist, seen from the other side."""
    upright, leaning = at_home(), at_home(body_joint_1=0.3)
    for name in facts.MASSES:
        moved = np.linalg.norm(leaning.body(name).xpos - upright.body(name).xpos)
        legs = "leg" in name or any(part in name for part in ("pelvis", "hip", "thigh", "shank", "ankle", "foot"))
        assert (moved < 1e-12) == (legs or name == "torso"), name  # the torso turns about its own frame's origin
    assert leaning.site("forehead").xpos[0] > upright.site("forehead").xpos[0] + 0.03
    assert leaning.site("forehead").xpos[2] < upright.site("forehead").xpos[2]
    arm = upright.site("forehead").xpos - upright.joint("body_joint_1").xanchor
    turned = [np.cos(0.3) * arm[0] + np.sin(0.3) * arm[2], arm[1], np.cos(0.3) * arm[2] - np.sin(0.3) * arm[0]]
    np.testing.assert_allclose(leaning.site("forehead").xpos - leaning.joint("body_joint_1").xanchor, turned, atol=1e-9)
    assert upright.joint("body_joint_1").xanchor[2] == pytest.approx(facts.WAIST_HEIGHT)


def test_relative_to_the_torso_limbs_are_where_they_were() -> None:
    """Any posture: what hangs from the waist, seen from the torso, is the same robot seated or not."""
    seated, free = mujoco.MjData(SEAT_MODEL), mujoco.MjData(ROBOT_MODEL)
    rng = np.random.default_rng(0)
    for _ in range(10):
        for joint in facts.JOINTS:
            angle = rng.uniform(*SEAT_MODEL.joint(joint).range)
            seated.joint(joint).qpos[0] = free.joint(joint).qpos[0] = angle
        mujoco.mj_forward(SEAT_MODEL, seated)
        mujoco.mj_forward(ROBOT_MODEL, free)
        for name in facts.MASSES:
            ours, theirs = (
                one.body("torso").xmat.reshape(3, 3).T @ (one.body(name).xpos - one.body("torso").xpos)
                for one in (seated, free)
            )
            np.testing.assert_allclose(ours, theirs, atol=1e-9, err_msg=name)


def test_it_rests_at_home() -> None:
    home = np.deg2rad([facts.SEATED_DEG.get(joint, 0.0) for joint in facts.JOINTS])
    np.testing.assert_allclose(SEAT_MODEL.key("home").ctrl, home, atol=1e-8)
    body = load_body("hoap2-seated", threads=1)
    body.reset()
    np.testing.assert_allclose(body.joint_angles[0], home, atol=1e-8)
    for _ in range(100):
        body.act(body.command_angles(home[None]))
    sag = np.abs(np.rad2deg(body.joint_angles[0] - home))
    assert sag.max() < 0.5, body.joints[sag.argmax()]
    assert np.abs(body.batch.qvel).max() < 1e-3
    data = at_home()
    for side, sign in (("left", 1), ("right", -1)):
        assert sign * data.site(f"{side}_palm").xpos[1] > 0.03, "each hand on its own side"
    np.testing.assert_allclose(data.site("left_palm").xpos * (1, -1, 1), data.site("right_palm").xpos, atol=1e-4)


@pytest.mark.parametrize("part", range(3), ids=Seat().parts)
def test_palms_and_forehead_feel_what_touches_them_and_nothing_else(part: int) -> None:
    """A ball on a rail that presses with 1 N is felt as 1 N, by the one that it touches."""
    seat = ROBOTS["hoap2-seated"].seat
    assert seat is not None
    spec, data = seated(ROBOTS["hoap2-seated"], seat, None), at_home()
    shape, here = SEAT_MODEL.geom(seat.touching[part]), data.geom(seat.touching[part])
    turn = here.xmat.reshape(3, 3)
    side = np.abs(turn.T @ ((0, 1, 0), (0, 1, 0), (1, 0, 0))[part]).argmax()
    out = turn[:, side] * np.sign(turn[:, side] @ ((0, 1, 0), (0, -1, 0), (1, 0, 0))[part])
    reach = shape.size[side] if shape.type[0] == mujoco.mjtGeom.mjGEOM_BOX else shape.size[0]
    ball = spec.worldbody.add_body(name="ball", pos=here.xpos + out * (reach + 0.0101))
    ball.add_joint(name="rail", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=-out, damping=5)
    ball.add_geom(size=(0.01, 0, 0), mass=0.02, contype=THING, conaffinity=EVERYTHING)
    spec.option.gravity = (0, 0, 0)
    for key in spec.keys:
        key.qpos = [*key.qpos, 0.0]
    model = spec.compile()
    now = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, now, model.key("home").id)
    now.qfrc_applied[model.joint("rail").dofadr[0]] = 1.0
    for _ in range(100):
        mujoco.mj_step(model, now)
    felt = [now.sensor(f"{one}_touch").data[0] for one in seat.parts]
    assert felt[part] == pytest.approx(1.0, abs=0.05)
    assert sum(felt) == felt[part]


def test_a_smaller_peer_is_as_heavy_and_shorter_in_every_direction() -> None:
    small, whole = (load_body(name, threads=1).model for name in ("hoap2-seated-small", "hoap2-seated"))
    np.testing.assert_array_equal(small.body_mass, whole.body_mass)
    np.testing.assert_array_equal(small.jnt_range, whole.jnt_range)
    rng, places = np.random.default_rng(0), []
    angles = rng.uniform(*whole.jnt_range.T)
    for model in (small, whole):
        data = mujoco.MjData(model)
        data.qpos[:] = angles
        mujoco.mj_forward(model, data)
        places.append([data.site_xpos, data.geom_xpos, data.xipos])
    for ours, theirs in zip(*places, strict=True):
        np.testing.assert_allclose(ours, facts.SMALL * theirs, atol=1e-9)
