"""Faces with a tongue: stable under bang-bang commands, stopped by their lips, the same at any size, true to their
relations; worn ones by the laws of their wear; files that hold no face are refused."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from models.body import SimulatedBody
from models.errors import BodyError
from models.face import ADULT_SIZE, FACE, FACES, JOINTS, SITES, TOUCH, WORN, Face, Proportions, face_of, find
from models.face.body import NOISE, face_body, face_model
from models.face.looks import APART_M, FOCAL_PX, Onlooker, View
from models.face.relations import RELATIONS, Truth
from models.servos import resting
from models.wear import Wear

Array = NDArray[np.float64]
QUIET = np.zeros(len(JOINTS))
MM = 1e-3
HINGE, LIP, TONGUE = (0.005, -0.018), (0.048, -0.0323), 0.0145
"""x and z of the newborn's jaw and of its lower lip; tongue from its hinge to its tip, m."""
SHAPED = ("adult-long", "adult-round")


def quiet(name: str, copies: int = 1, tick_s: float = 0.3, pacifier: bool = False) -> SimulatedBody:
    body = face_body(FACES[name], copies=copies, threads=1, noise=QUIET, tick_s=tick_s, pacifier=pacifier)
    body.reset()
    return body


def posture(name: str, count: int = 1, **joints: float | Array) -> Array:
    """(count, 8) joints; what slides in mm of a newborn's face, what turns in degrees."""
    angles = np.zeros((count, len(JOINTS)))
    for joint, amount in joints.items():
        slides = joint in ("tongue", "upper_lip_left", "brows")
        unit = MM * FACES[name].proportions.size if slides else np.deg2rad(1)
        angles[:, JOINTS.index(joint)] = unit * np.asarray(amount)
    return angles


def held(name: str, angles: Array, pacifier: bool = False) -> SimulatedBody:
    """As many copies, each told to go there for two acts."""
    body = quiet(name, len(angles), pacifier=pacifier)
    for _ in range(2):
        body.act(body.command_angles(angles))
    return body


def tongue_mm(body: SimulatedBody, name: str) -> Array:
    return body.joint_angles[:, 1] / FACES[name].proportions.size / MM


def told(model: mujoco.MjModel, **joints: float) -> Array:
    """(nq,) configuration at rest but for these joints, rad or m."""
    configuration = resting(model)
    for joint, amount in joints.items():
        configuration[model.joint(joint).qposadr[0]] = amount
    return configuration


def related(model: mujoco.MjModel, **joints: float) -> dict[str, float]:
    return dict(zip(RELATIONS, Truth(model).of(told(model, **joints)).tolist(), strict=True))


def chord(jaw: float, parted: float) -> float:
    lever = float(np.hypot(LIP[0] - HINGE[0], LIP[1] - HINGE[1]))
    return 2 * lever * np.sin((jaw - parted) / 2) / 0.026


# ------------------------------------------------------------------------------------------------ bodies


@pytest.mark.parametrize("name", FACES)
def test_every_face_stands_sixteen_seconds_of_extremes(name: str) -> None:
    """No warning of the physics (`act` would raise), and parts that touch stay apart as far as newborns' lips let."""
    body, rng, size = quiet(name, 8, 0.02), np.random.default_rng(0), FACES[name].proportions.size
    data, overlaps, lines = mujoco.MjData(body.model), list[float](), np.zeros((8, 8))
    for tick in range(100):
        if tick % 10 == 0:
            lines = rng.choice([-1.0, 1.0], lines.shape)
        body.act(lines)
        for configuration in np.array(body.batch.qpos):
            data.qpos[:] = configuration
            mujoco.mj_fwdPosition(body.model, data)
            overlaps.append(-data.contact.dist.min() / size if data.ncon else 0.0)
    assert np.quantile(overlaps, 0.99) < 1 * MM and max(overlaps) < 1.5 * MM
    assert 0 < np.mean(np.array(overlaps) > 0) < 1, "parts touch, but not always"
    beyond = np.maximum(body.joint_angles - body.joint_range[:, 1], body.joint_range[:, 0] - body.joint_angles)
    assert (beyond < 0.05 * np.ptp(body.joint_range, axis=1)).all()
    assert body.batch.warning[..., 1].sum() == 0


@pytest.mark.parametrize("name", FACES)
def test_shut_lips_stop_the_tongue_and_an_open_mouth_frees_it(name: str) -> None:
    body = held(name, posture(name, 2, jaw=np.array([0.0, 20.0]), tongue=25.0))
    shut, free = tongue_mm(body, name)
    assert 6 < shut < 8 and free > 23
    touch = body.senses.read(body.act(body.command_angles(body.joint_angles)), "touch")
    assert body.senses["touch"].labels == TOUCH and (touch[1] == 0).all()
    pressed = body.senses.read(body.act(body.command_angles(posture(name, 2, tongue=25.0))), "touch")[0]
    assert pressed[-1] > 0.05 and pressed[:4].max() > 0.05, "tongue and lips feel each other"
    truth = Truth(face_model(FACES[name])).of(np.array(held(name, posture(name)).batch.qpos))[0]
    assert truth[0] == pytest.approx(0, abs=2e-3), "told to shut its mouth, its lips just touch"


def test_size_alone_changes_no_movement() -> None:
    """An adult of the newborn's proportions does the very same in its own measure, all through its movements."""
    rng, found = np.random.default_rng(1), dict[str, list[Array]]()
    lines = np.repeat(rng.uniform(-0.5, 0.5, (4, 8, 8)), 6, axis=0)
    for name in ("newborn", "adult"):
        body, truth = quiet(name, 8, 0.05), Truth(face_model(FACES[name]))
        found[name] = [truth.of(np.array(body.batch.qpos)) for one in lines if body.act(one) is not None]
    newborn, adult = np.array(found["newborn"]), np.array(found["adult"])
    assert np.ptp(newborn, axis=(0, 1)).min() > 0.1, "everything moves"
    assert np.abs(newborn - adult).max() < 0.02 and np.abs(newborn - adult).mean() < 2e-4


def test_an_adult_of_the_newborn_s_proportions_is_it_enlarged() -> None:
    newborn, adult = (face_model(FACES[name]) for name in ("newborn", "adult"))
    for lengths in ("geom_pos", "geom_size", "body_pos", "body_ipos", "jnt_pos", "site_pos"):
        np.testing.assert_allclose(getattr(adult, lengths), ADULT_SIZE * getattr(newborn, lengths), atol=1e-9)
    np.testing.assert_allclose(adult.body_mass, ADULT_SIZE**3 * newborn.body_mass, rtol=1e-9)
    np.testing.assert_allclose(adult.body_inertia, ADULT_SIZE**5 * newborn.body_inertia, rtol=1e-6)
    slides = newborn.jnt_type == int(mujoco.mjtJoint.mjJNT_SLIDE)
    np.testing.assert_allclose(adult.jnt_range, np.where(slides, ADULT_SIZE, 1)[:, None] * newborn.jnt_range)
    assert Truth(adult).mouth == pytest.approx(0.05)


@pytest.mark.parametrize("name", SHAPED)
def test_other_proportions_look_different_and_open_the_mouth_alike(name: str) -> None:
    shaped, plain = face_model(FACES[name]), face_model(FACES["adult"])
    moved = np.abs(shaped.geom_pos - plain.geom_pos).max(1) / ADULT_SIZE
    assert (moved > 2 * MM).sum() > 5 and np.abs(shaped.geom_size - plain.geom_size).max() > 2 * MM
    assert np.abs(Truth(shaped).mouth / 0.05 - 1) > 0.02
    angles = [held(one, posture(one, 15, jaw=np.arange(2.0, 31.0, 2.0))).joint_angles for one in (name, "adult")]
    np.testing.assert_allclose(angles[0], angles[1], atol=1e-3)
    assert np.ptp(angles[0][:, 0]) > np.deg2rad(25)


@pytest.mark.parametrize("has, what, parts", [
    (Proportions(eyes=1.2), 1, ("eye_left", "iris_right", "brow_left")),
    (Proportions(mouth=1.3), 1, ("upper_lip_left", "lower_lip_right_felt")),
    (Proportions(deep=1.1), 0, ("nose", "skull", "chin", "blade")),
    (Proportions(tall=0.8), 2, ("nose", "hair", "chin", "floor")),
    (Proportions(wide=1.4), 1, ("cheek_left", "ear_right", "eye_left")),
])  # fmt: skip
def test_each_proportion_moves_its_own_parts_along_its_own_axis(
    has: Proportions, what: int, parts: tuple[str, ...]
) -> None:
    shaped, plain = (face_model(Face("some", proportions=p)) for p in (has, Proportions()))
    [factor] = [one for one in vars(has).values() if one != 1]
    ratio = np.where(np.arange(3) == what, factor, 1.0)
    for part in parts:
        np.testing.assert_allclose(shaped.geom(part).pos, ratio * plain.geom(part).pos, atol=1e-9)
    others = [axis for axis in range(3) if axis != what]
    np.testing.assert_allclose(shaped.geom_pos[:, others], plain.geom_pos[:, others], atol=1e-9)
    mouth = factor if what == 1 and has.eyes == 1 else 1.0
    assert Truth(shaped).mouth == pytest.approx(0.026 * mouth)


def test_a_longer_nose_keeps_its_root() -> None:
    short, long = (face_model(Face("some", proportions=Proportions(nose=n))).geom("nose") for n in (1.0, 1.5))
    assert long.pos[0] - long.size[0] == pytest.approx(short.pos[0] - short.size[0])
    assert long.size[0] == pytest.approx(1.5 * short.size[0])
    np.testing.assert_allclose([*long.size[1:], *long.pos[1:]], [*short.size[1:], *short.pos[1:]])


@pytest.mark.parametrize("name", ["newborn", "adult"])
def test_a_pacifier_keeps_the_tongue_in_and_the_body_the_same(name: str) -> None:
    angles = posture(name, 7, jaw=np.arange(0.0, 12.5, 2.0), tongue=25.0)
    stopped, free = (tongue_mm(held(name, angles, pacifier), name) for pacifier in (True, False))
    assert (stopped < 8).all() and (free[3:] > 23).all()
    bodies = [face_body(FACES[name], pacifier=p, scramble=5, threads=1) for p in (True, False)]
    assert bodies[0].fingerprint == bodies[1].fingerprint
    assert face_body(FACES[name], threads=1).fingerprint != bodies[0].fingerprint, "wired otherwise"
    assert bodies[0].model.ngeom > bodies[1].model.ngeom


def test_a_pacifier_keeps_the_tongue_in_however_wide_the_mouth() -> None:
    stopped = held("newborn", posture("newborn", 15, jaw=np.arange(0.0, 29.0, 2.0), tongue=25.0), pacifier=True)
    assert (Truth(face_model(FACES["newborn"])).of(np.array(stopped.batch.qpos))[:, 1] < 0).all()


def test_motors_are_wired_anyhow_and_senses_never() -> None:
    straight, wired = (face_body(FACES["newborn"], noise=QUIET, threads=1, scramble=s) for s in (None, 11))
    assert wired.sense_labels == straight.sense_labels and wired.sense_labels[: len(JOINTS)] == JOINTS
    assert (wired.wiring.sense == np.arange(len(wired.senses))).all()
    assert sorted(wired.wiring.motor.tolist()) == list(range(8)) != wired.wiring.motor.tolist()
    assert np.ptp(np.sign(wired.wiring.gain)) == 2, "some backwards"
    angles = posture("newborn", jaw=15.0, tongue=9.0, tongue_yaw=-9.0, brows=2.0, neck_yaw=11.0)
    felt = [body.act(body.command_angles(angles)) for body in (straight, wired)]
    np.testing.assert_allclose(felt[0], felt[1], atol=1e-9)
    lines = np.zeros((1, 8))
    lines[0, 2] = 0.4
    assert not np.allclose(straight.act(lines), wired.act(lines), atol=1e-3)
    robot = SimulatedBody(face_model(FACES["newborn"]), name="f", tick_s=0.3, motors=JOINTS, scramble=11)
    assert (robot.wiring.sense != np.arange(len(robot.senses))).any(), "other bodies' senses are permuted too"


def test_noise_is_each_sense_s_own() -> None:
    bodies = [face_body(FACES["newborn"], copies=1000, threads=1, noise=noise, seed=3) for noise in (NOISE, QUIET)]
    noisy, clean = (body.reset() for body in bodies)
    np.testing.assert_allclose((noisy - clean)[:, :8].std(0), NOISE, rtol=0.1)
    np.testing.assert_allclose((noisy - clean)[:, 8:16].std(0), np.sqrt(2) * NOISE / 0.3, rtol=0.1)
    assert (noisy[:, 16:] == clean[:, 16:]).all()


def test_eyes_are_a_newborn_s_and_look_at_the_nose() -> None:
    onlooker = Onlooker(FACES["adult"], View(0.4))
    data, model = onlooker.data, onlooker.model
    mujoco.mj_kinematics(model, data)
    mujoco.mj_camlight(model, data)
    left, right = data.camera("left").xpos, data.camera("right").xpos
    np.testing.assert_allclose(left - right, [0, APART_M, 0], atol=1e-12)
    x, y, z = data.geom("nose").xpos
    assert (y, z) == pytest.approx((0.0, 0.0), abs=1e-9), "level with the eyes"
    assert 0.4 - 0.012 * ADULT_SIZE < x < 0.4, "its front is that far away"
    assert onlooker.eyes[0].focal_px == pytest.approx(FOCAL_PX)
    turned = Onlooker(FACES["adult"], View(0.4, yaw_deg=10)).model.body("head").quat
    assert 2 * np.arccos(abs(turned @ model.body("head").quat)) == pytest.approx(np.deg2rad(10))


# --------------------------------------------------------------------------------------------- relations


def test_at_rest_the_tongue_lies_behind_the_lip_and_nothing_else_is_anything() -> None:
    model = face_model(FACES["newborn"])
    rest, parted = related(model), 0.0004 / (LIP[0] - HINGE[0])  # lips 0.4 mm into each other
    assert rest["gap"] == pytest.approx(chord(0, parted), rel=1e-6) and rest["gap"] < 0
    assert rest["beyond"] == pytest.approx((0.026 + TONGUE - 0.052) / 0.026)
    assert [rest[name] for name in RELATIONS[2:]] == pytest.approx([0.0] * 6, abs=1e-12)


@settings(max_examples=25, deadline=None)
@given(st.floats(0, 0.4), st.floats(0, 0.025), st.floats(-0.6, 0.6), st.floats(-0.4, 0.4), st.sampled_from(list(FACES)))
def test_relations_of_known_joints(jaw: float, slide: float, yaw: float, pitch: float, name: str) -> None:
    """Slides and sines over the width of the mouth; whatever the tongue and the head do, the jaw's chord is its own."""
    model, size = face_model(FACES[name]), FACES[name].proportions.size
    truth, rest = Truth(model), related(model)
    joints = {"jaw": jaw, "tongue": size * slide, "tongue_yaw": yaw, "tongue_pitch": pitch}
    mouth, free = truth.mouth, TONGUE * size
    head = {"neck_yaw": yaw, "neck_pitch": pitch, "upper_lip_left": slide / 10, "brows": slide / 10}
    found = related(model, **joints, **head)
    assert found["beyond"] == pytest.approx(rest["beyond"] + size * slide / mouth)
    assert found["side"] == pytest.approx(free * np.sin(yaw) * np.cos(pitch) / mouth, abs=1e-9)
    assert found["up"] == pytest.approx(free * np.sin(pitch) / mouth, abs=1e-9)
    assert found["purse"] == pytest.approx(0.8 * slide / 10 / mouth)
    assert found["brow"] == pytest.approx(slide / 10 / mouth)
    assert found["turn"] == pytest.approx(np.arctan2(np.sin(yaw), np.cos(yaw)) / (np.pi / 2))
    assert found["nod"] == pytest.approx(pitch / (np.pi / 2))
    data, place = mujoco.MjData(model), dict[float, Array]()
    parted = -2 * np.arcsin(rest["gap"] * mouth / 2 / lever(model))
    for angle in (parted, jaw):
        data.qpos[:] = told(model, jaw=angle)
        mujoco.mj_kinematics(model, data)
        place[angle] = data.geom("lower_lip_left").xpos.copy()
    gone = np.linalg.norm(place[jaw] - place[parted]) / mouth
    assert found["gap"] == pytest.approx(np.sign(jaw - parted) * gone, abs=1e-6)


def lever(model: mujoco.MjModel) -> float:
    """From the jaw's hinge to the lower lip, m."""
    data = mujoco.MjData(model)
    data.qpos[:] = resting(model)
    mujoco.mj_kinematics(model, data)
    return float(np.linalg.norm((data.geom("lower_lip_left").xpos - data.joint("jaw").xanchor)[[0, 2]]))


def test_relations_keep_their_leading_axes() -> None:
    model = face_model(FACES["newborn"])
    several = np.stack([told(model, jaw=a) for a in (0.1, 0.2, 0.3, 0.1, 0.2, 0.3)]).reshape(2, 3, -1)
    found = Truth(model).of(several)
    assert found.shape == (2, 3, len(RELATIONS))
    np.testing.assert_array_equal(found[0], found[1])
    assert (np.diff(found[0, :, 0]) > 0.1).all()


# -------------------------------------------------------------------------------------------------- wear


def follows(wear: Wear, commands: Array, low: float = 0.0, high: float = 1.0, start: float = 0.5) -> Array:
    """What follows (T,) commands; plays begin at this share of the range."""
    played = np.full((len(wear.backlash), 1, 1), low + start * (high - low))
    return np.array([wear.follow(played, np.full((1, 1), one), [low], [high])[0, 0] for one in commands])


@settings(max_examples=30, deadline=None)
@given(st.floats(0.01, 20), st.floats(-2, 2), st.floats(0.1, 4))
def test_a_sigmoid_keeps_the_ends_and_the_order(steepness: float, low: float, span: float) -> None:
    x = np.linspace(0, 1, 21)
    found = (follows(Wear(steepness=steepness), low + span * x, low, low + span) - low) / span
    f = 1 / (1 + np.exp(-steepness * (x - 0.5)))
    np.testing.assert_allclose(found, (f - f[0]) / (f[-1] - f[0]), atol=1e-9)
    np.testing.assert_allclose(found[[0, 10, 20]], [0, 0.5, 1], atol=1e-9)
    assert (np.diff(found) > 0).all()


def test_a_sigmoid_without_steepness_is_no_sigmoid() -> None:
    commands = np.random.default_rng(0).uniform(-0.4, 1.1, 50)
    plain = follows(Wear(backlash=(0.2,)), commands, -0.4, 1.1)
    errors = [np.abs(follows(Wear(backlash=(0.2,), steepness=k), commands, -0.4, 1.1) - plain).max() for k in (1, 0.1)]
    assert errors[1] < errors[0] / 50 and errors[1] < 1e-3  # it goes with the square
    np.testing.assert_allclose(follows(Wear(backlash=(0.2,), steepness=1e-5), commands, -0.4, 1.1), plain, atol=1e-7)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(0, 1), min_size=2, max_size=8), st.floats(-2, 2), st.floats(0.1, 40))
def test_play_of_the_range_does_not_depend_on_the_range(commands: list[float], low: float, span: float) -> None:
    wear = Wear(backlash=(0.0, 0.1, 0.3), shares=(0.5, 0.3, 0.2), of_range=True, steepness=4.0)
    asked = np.array(commands)
    unit, wide = follows(wear, asked), follows(wear, low + span * asked, low, low + span)
    np.testing.assert_allclose((wide - low) / span, unit, atol=1e-9)
    np.testing.assert_allclose(follows(replace(wear, of_range=False), asked), unit, atol=1e-12)


def test_a_worn_face_lags_behind_by_its_play_and_falls_short_of_its_ends() -> None:
    """Turned to and fro, its head is a tenth of the range late each way, and then follows the sigmoid."""
    body, span, end = quiet("newborn-worn"), np.deg2rad(60), np.tanh(WORN.steepness / 4)
    way = np.deg2rad([-30.0, -10.0, 10.0, 30.0, 10.0, -10.0, -30.0])
    for command, late in zip(way, [1, -1, -1, -1, 1, 1, 1], strict=True):
        body.act(body.command_angles(np.array([[0.0, 0, 0, 0, 0, 0, command, 0]])))
        share = (command + late * 0.1 * span) / span
        assert body.joint_angles[0, 6] == pytest.approx(
            span * np.tanh(WORN.steepness / 2 * share) / (2 * end), abs=0.01
        )
    assert WORN.of_range and WORN.backlash == (0.2,)
    assert len({face_body(replace(FACES["newborn"], wear=wear), threads=1).fingerprint for wear in (
        WORN, replace(WORN, steepness=4.0), replace(WORN, of_range=False), Wear()
    )}) == 4  # fmt: skip


@pytest.mark.parametrize("steepness", [-1.0, np.nan])
def test_a_sigmoid_that_is_none_is_refused(steepness: float) -> None:
    with pytest.raises(BodyError, match="nothing is below 0"):
        Wear(steepness=steepness)


# ---------------------------------------------------------------------------------------------- refusals


def one_line(error: pytest.ExceptionInfo[BodyError]) -> str:
    assert "\n" not in str(error.value)
    return str(error.value)


def test_faces_are_found_by_name_or_path(tmp_path: Path) -> None:
    assert find("adult") is FACES["adult"] and find("some.xml") is None
    with pytest.raises(BodyError, match=r"unknown face 'newbron'.*did you mean 'newborn'") as error:
        face_of("newbron")
    assert "or the path of an MJCF file" in one_line(error)
    copy = tmp_path / "copy.xml"
    copy.write_text(FACE.read_text())
    brought = face_of(str(copy))
    assert brought.path == copy and brought.about == str(copy)
    assert face_body(brought, threads=1).fingerprint == face_body(FACES["newborn"], threads=1).fingerprint


@pytest.mark.parametrize("gone, instead, what", [
    ('name="tongue" class="slide"', 'name="snake" class="slide"', "no joint 'tongue'"),
    ('<site name="tip"', '<site name="tap"', f"no site {SITES[0]!r}"),
    ('<touch name="tongue" site="tongue"/>', "", "no touch sensor 'tongue'"),
    ("<worldbody>", "<worldbody", "MuJoCo cannot read it"),
    ('type="slide" axis="1 0 0" armature="0.02"', 'type="slide" axis="0 0 0" armature="0.02"', "MuJoCo cannot"),
])  # fmt: skip
def test_a_file_that_holds_no_face_is_refused(gone: str, instead: str, what: str, tmp_path: Path) -> None:
    text = FACE.read_text()
    assert gone in text
    text = text.replace(gone, instead)
    if "snake" in instead:  # its servo too, or MuJoCo stumbles first
        text = text.replace('name="tongue" joint="tongue"', 'name="tongue" joint="snake"')
    path = tmp_path / "other.xml"
    path.write_text(text)
    with pytest.raises(BodyError, match=what) as error:
        face_body(Face("other", path), threads=1)
    assert one_line(error).startswith(str(path))


@pytest.mark.parametrize("content", ["", "not a model", "<mujoco/>"])
def test_what_is_no_model_is_refused(content: str, tmp_path: Path) -> None:
    path = tmp_path / "junk.xml"
    path.write_text(content)
    with pytest.raises(BodyError, match=str(path)) as error:
        face_body(face_of(str(path)), threads=1)
    one_line(error)
    with pytest.raises(BodyError, match="there is no such file"):
        face_body(face_of(str(tmp_path / "nowhere.xml")), threads=1)
