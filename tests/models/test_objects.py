"""Objects on the table: every one lies still, is its specimen whoever draws it, holds and yields as mechanics says."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from models.errors import BodyError
from models.objects import TOYS
from models.objects.playing import CLEAR, PLACED, PlayBody, Specimens
from models.objects.scene import EVERYTHING, GRIP_N, PREFIX, THING, read, seated
from models.objects.states import MOVED_M, STATES, Watched
from models.robots import ROBOTS, Seat

ROBOT = ROBOTS["hoap2-seated"]
assert ROBOT.seat is not None
SEAT: Seat = ROBOT.seat
PULLED = [name for name, toy in TOYS.items() if toy.stiction != (1.0, 1.0)]
SWITCHED = [name for name, toy in TOYS.items() if any(joint.name == "switch" for joint in read(toy).joints)]


def at_table(toy: str | None, copies: int = 1, **how: Any) -> PlayBody:
    how = {"name": "hoap2-seated", "threads": 1} | how
    return PlayBody(ROBOT, SEAT, TOYS[toy] if toy else None, copies=copies, **how)


def kept_still(body: PlayBody, ticks: int, watch: Callable[[np.ndarray], Any] = lambda felt: None) -> list[Any]:
    hold = body.command_angles(body.joint_angles)
    return [watch(body.act(hold)) for _ in range(ticks)]


def specimen(body: PlayBody, copy: int) -> dict[str, np.ndarray]:
    fields = ("body_mass", "body_inertia", "geom_friction", "dof_frictionloss", "body_pos", "body_quat")
    found = {name: body.batch.expand(name)[copy].copy() for name in (*fields, "actuator_gainprm")}
    return found | {"places": body.places[copy], "configuration": body.configuration[copy]}


# --- what an object is ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("toy", TOYS)
def test_an_object_is_two_sites_and_a_state(toy: str) -> None:
    """Its sites lie on the table's side of the world; its state function answers for the whole batch."""
    one, model = TOYS[toy], seated(ROBOT, SEAT, TOYS[toy]).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    for site in ("a", "b"):
        place = data.site(PREFIX + site).xpos - (0, 0, SEAT.table)
        assert place[2] > 0 and 0.08 < place[0] < 0.3 and abs(place[1]) < 0.2, "in reach, on the table"
    assert one.about and one.kind in {other.kind for other in TOYS.values()} and one.on > 0
    assert one.stiction[0] <= one.stiction[1] and len(one.half) == 3 and min(one.half) > 0
    still = Watched(np.zeros((3, 4, 2, 3)), np.zeros((3, 4, 3, 3)), np.zeros((3, 4), bool))
    assert one.state(still).shape == (4,) and set(one.state(still)) <= set(range(len(STATES)))


@pytest.mark.parametrize("toy", TOYS)
def test_what_eyes_measure_is_what_it_is(toy: str) -> None:
    """`half` against the shapes named a, b: a's half width and height, b's half height, to 2 mm."""
    model = mujoco.MjModel.from_xml_path(str(TOYS[toy].path))
    data, found = mujoco.MjData(model), {}
    mujoco.mj_kinematics(model, data)
    for part in ("a", "b"):
        geoms = [i for i in range(model.ngeom) if re.fullmatch(rf"{part}\d*", model.geom(i).name)]
        found[part] = np.ptp([corner for geom in geoms for corner in _corners(model, data, geom)] or [[0, 0, 0]], 0) / 2
    assert TOYS[toy].half[:2] == pytest.approx(found["a"][1:], abs=2e-3)
    assert toy == "panel" or TOYS[toy].half[2] == pytest.approx(found["b"][2], abs=2e-3)  # b is no shape of its own


def _corners(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> np.ndarray:
    size, kind = model.geom_size[geom], model.geom_type[geom]
    half = size if kind == mujoco.mjtGeom.mjGEOM_BOX else np.array([size[0], size[0], size[1] + size[0]])
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    return np.asarray(data.geom_xpos[geom] + signs * half @ data.geom_xmat[geom].reshape(3, 3).T)


def test_every_object_is_entered_and_has_its_papers() -> None:
    folder = next(iter(TOYS.values())).folder.parent
    papers = (folder / "README.md").read_text()
    assert {path.parent.name for path in folder.rglob("object.xml")} == {toy.folder.name for toy in TOYS.values()}
    assert [name for name in TOYS if f"`{name}`" not in papers] == []


BARE = '<mujoco><worldbody><body><geom size="0.01"/><site name="b"/></body></worldbody></mujoco>'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (BARE, r"it has no site 'a'; an object is known by two parts, <site name=\"a\"/> and <site name=\"b\"/>$"),
        (BARE.replace('"b"', '"a"'), "it has no site 'b'"),
        ("<mujoco><worldbody>", "MuJoCo cannot compile it"),
        ('<mujoco><worldbody><body><freejoint/><site name="a"/></body></worldbody></mujoco>', "cannot compile it"),
        (None, "no such file"),
    ],
    ids=["no a", "no b", "cut", "no mass", "missing"],
)
def test_an_object_that_cannot_be_is_one_line(text: str | None, said: str, tmp_path: Path) -> None:
    if text is not None:
        (tmp_path / "object.xml").write_text(text)
    with pytest.raises(BodyError, match=said) as caught:
        seated(ROBOT, SEAT, replace(TOYS["cup"], folder=tmp_path))
    assert str(tmp_path / "object.xml") in str(caught.value) and "\n" not in str(caught.value)


# --- specimens --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("toy", TOYS)
def test_a_specimen_is_itself_whoever_draws_it(toy: str) -> None:
    """By its number: alone or among others, on one thread or two, drawn again or later."""
    many, one = at_table(toy, copies=5, threads=2), at_table(toy)
    many.set_out(10)
    for number in (12, 14):
        one.set_out(number)
        ours, theirs = specimen(one, 0), specimen(many, number - 10)
        for name, value in ours.items():
            np.testing.assert_array_equal(value, theirs[name], err_msg=name)
    assert one.grip_n[0] == many.grip_n[4] and one.stiction[0] == many.stiction[4]
    before = specimen(many, 2)
    other = (many.set_out(0), specimen(many, 2))[1]
    assert (before["places"] != other["places"]).any()
    kept_still(many, 5)
    again = (many.set_out(10), specimen(many, 2))[1]
    for name, value in before.items():
        np.testing.assert_array_equal(value, again[name], err_msg=name)


@pytest.mark.parametrize("toy", TOYS)
def test_specimens_differ_within_what_is_said(toy: str) -> None:
    """Masses, friction, grip, dry friction: within their bounds, over most of them, and the robot is never touched."""
    body, bounds = at_table(toy, copies=200), Specimens()
    model = body.model
    ours = np.array([model.body(i).name.startswith(PREFIX) for i in range(model.nbody)])
    share = body.batch.expand("body_mass")[:, ours & (model.body_mass > 0)]
    share = share / model.body_mass[ours & (model.body_mass > 0)]
    things = ours[model.geom_bodyid]
    slides = (body.batch.expand("geom_friction") / model.geom_friction)[:, things, 0]
    for drawn, low, high in (
        (share, 1 - bounds.masses, 1 + bounds.masses),
        (slides, *bounds.friction),
        (body.grip_n, *bounds.grip),
        (np.log(body.stiction), *np.log(TOYS[toy].stiction)),
    ):
        assert drawn.min() >= low - 1e-12 and drawn.max() <= high + 1e-12
        assert drawn.max() - drawn.min() >= 0.9 * (high - low)
    for name, kept in (("body_mass", ~ours), ("body_inertia", ~ours), ("geom_friction", ~things)):
        born = getattr(model, name)
        np.testing.assert_array_equal(body.batch.expand(name)[:, kept], np.tile(born[kept], (200, *[1] * born.ndim)))
    joints = [model.joint(i).name for i in range(model.njnt)]
    if f"{PREFIX}stiction" in joints:
        dof = int(model.joint(f"{PREFIX}stiction").dofadr[0])
        np.testing.assert_array_equal(body.batch.expand("dof_frictionloss")[:, dof], body.stiction)


@pytest.mark.parametrize("toy", TOYS)
def test_pieces_are_set_down_near_their_places_and_clear_of_each_other(toy: str) -> None:
    """What belongs together keeps its shape, turned and shifted as one."""
    body = at_table(toy, copies=200)
    born = body.model.body_pos[body._pieces]
    where = np.array([[place for place, _ in one] for one in body._where])
    away, forward, aside = where - born, PLACED[0], PLACED[1]
    moved = away[:, :1] if body._together else away
    assert (np.abs(moved[..., 0]) <= forward).all() and (np.abs(moved[..., 1]) <= aside).all()
    assert (away[..., 2] == 0).all() and np.ptp(moved[..., 0]) > 1.5 * forward
    turns = np.array([[2 * np.arctan2(turn[3], turn[0]) for _, turn in one] for one in body._where])
    assert np.abs(turns).max() <= PLACED[2] and np.ptp(turns) > 1.5 * PLACED[2]
    for i in range(len(born)):
        for j in range(i):
            between, apart = where[:, i] - where[:, j], born[i] - born[j]
            if body._together:
                cosine, sine = np.cos(turns[:, i]), np.sin(turns[:, i])
                turned = np.stack([cosine * apart[0] - sine * apart[1], sine * apart[0] + cosine * apart[1]], 1)
                np.testing.assert_allclose(between[:, :2], turned, atol=1e-9)
            else:
                assert (np.linalg.norm(between[:, :2], axis=1) > CLEAR).all()


def test_pieces_that_have_no_room_are_refused() -> None:
    """Two pieces born closer than they are to be apart, never set down anywhere else."""
    with pytest.raises(BodyError, match=r"^cup: its pieces cannot be set down 0\.06 m apart$"):
        crowded = at_table("cup", specimens=Specimens(placed=(0.0, 0.0, 0.0)))
        crowded.model.body_pos[crowded._pieces] = crowded.model.body_pos[crowded._pieces[0]]
        crowded.set_out(0)


# --- what becomes of it -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("toy", TOYS)
def test_it_lies_still_when_nothing_is_done(toy: str) -> None:
    """Within a millimetre; where resting hands lean on it (the largest one), within a quarter of what is called moved.
    No switch is pressed."""
    body = at_table(toy, copies=40)
    born = body.places[:, 3:]
    body.reset()
    np.testing.assert_array_equal(body.places[:, 3:], born)
    seen = kept_still(body, 50, lambda felt: (body.places[:, 3:], body.signal, body.senses.read(felt, "touch")))
    drift = np.linalg.norm([places - born for places, _, _ in seen], axis=-1).max((0, 2))
    leant_on = (np.array([touch for _, _, touch in seen]) > 0).any((0, 2))
    assert not any(lit.any() for _, lit, _ in seen)
    assert drift[~leant_on].max() < 1e-3 and drift.max() < MOVED_M / 4
    assert toy == "outsized" or not leant_on.any()


@pytest.mark.parametrize("toy", SWITCHED)
def test_it_signals_when_its_switch_is_pressed_in_and_only_then(toy: str) -> None:
    body = at_table(toy, copies=3)
    joint = body.model.joint(f"{PREFIX}switch")
    pressed = int(joint.qposadr[0])
    body.batch.qpos[:, pressed] = TOYS[toy].on * np.array([0.0, 0.99, 1.01])
    assert body.signal.tolist() == [False, False, True]
    assert TOYS[toy].on < joint.range[1], "it can be pressed in so far"
    body.reset()
    assert not body.signal.any()
    stiffness = body.model.jnt_stiffness[joint.id]
    assert 0.2 < stiffness * TOYS[toy].on < 2, "N: a finger can, its own weight cannot"
    assert at_table("loop").signal.tolist() == [False]


def slid(toy: str, share: float, stiction: float, default: bool = False) -> tuple[float, float]:
    """m that ends come apart in a second, and their speed then, m/s, pulled by this share of their dry friction; in
    the scene, weightless."""
    spec = seated(ROBOT, SEAT, TOYS[toy])
    spec.option.gravity, spec.option.disableflags = (0, 0, 0), int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model = spec.compile()
    data, joint = mujoco.MjData(model), model.joint(f"{PREFIX}stiction")
    dof = int(joint.dofadr[0])
    model.dof_frictionloss[dof] = stiction
    if default:
        model.dof_solref[dof], model.dof_solimp[dof] = (0.02, 1), (0.9, 0.95, 0.001, 0.5, 2)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    data.qfrc_applied[dof] = share * stiction
    for _ in range(round(1 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    return float(data.qpos[joint.qposadr[0]]), float(data.qvel[dof])


@pytest.mark.parametrize("end", [0, 1], ids=["least", "most"])
@pytest.mark.parametrize("toy", PULLED)
def test_dry_friction_holds_what_is_pulled_less_and_yields_to_more(toy: str, end: int) -> None:
    """Coulomb's law: below it sticks (0.5 mm/s at most), above it slides. A solver's usual constraint creeps."""
    stiction = TOYS[toy].stiction[end]
    crept, speed = slid(toy, 0.9, stiction)
    assert 0 <= crept < 5e-4 and abs(speed) < 5e-4
    assert slid(toy, 1.1, stiction)[0] > 0.02
    assert slid(toy, 0.9, stiction, default=True)[0] > 2e-3, "what the numbers in the file are for"


def held(pull: float, effort: float, newtons: float) -> float:
    """m that a 2 cm cube comes off a palm of a robot whose joints are locked, pulled along the normal for 0.4 s."""
    spec = seated(ROBOT, SEAT, None)
    posed = at_table(None)
    data = mujoco.MjData(posed.model)
    data.qpos[:] = posed.configuration[0]
    mujoco.mj_kinematics(posed.model, data)
    hand = data.geom(SEAT.holding[0])
    turn, thick = hand.xmat.reshape(3, 3), posed.model.geom(SEAT.holding[0]).size[1]
    cube = spec.worldbody.add_body(name="cube", pos=hand.xpos + turn[:, 1] * (thick + 0.0099), quat=np.zeros(4))
    cube.quat = _quat(turn)
    cube.add_joint(name="rail", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=(0, 1, 0), damping=2)
    kind = mujoco.mjtGeom.mjGEOM_BOX
    cube.add_geom(type=kind, size=(0.01,) * 3, mass=0.015, contype=THING, conaffinity=EVERYTHING, condim=4)
    spec.option.gravity = (0, 0, 0)
    for key in spec.keys:
        key.qpos = [*key.qpos, 0.0]
    model = spec.compile()
    rail = model.joint("rail")
    model.dof_damping[: rail.dofadr[0]] = 1e9
    grip = model.actuator(f"{SEAT.hands[0]}_grip").id
    model.actuator_gainprm[grip, 0] = newtons
    now = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, now, model.key("home").id)
    now.ctrl[grip] = effort
    for _ in range(100):
        now.qfrc_applied[rail.dofadr[0]] = pull if now.time > 0.05 else 0.0
        mujoco.mj_step(model, now)
    return float(now.qpos[rail.qposadr[0]])


def _quat(turn: np.ndarray) -> np.ndarray:
    found = np.empty(4)
    mujoco.mju_mat2Quat(found, turn.ravel())
    return found


@pytest.mark.parametrize(("effort", "newtons"), [(1.0, GRIP_N), (0.5, GRIP_N), (1.0, 4.0), (1.0, 8.0)])
def test_a_palm_holds_with_its_strength_and_no_more(effort: float, newtons: float) -> None:
    strength = effort * newtons
    assert held(strength - 0.2, effort, newtons) < 1e-3 < 0.01 < held(strength + 0.2, effort, newtons)
    assert held(0.2, 0.0, newtons) > 0.01, "a palm that does not hold lets go of anything"


def test_a_grip_is_a_share_of_ones_own_strength() -> None:
    body = at_table("cup", copies=3)
    body.grip(np.array([[0.5, 0.0], [2.0, -1.0], [1.0, 1.0]]))
    np.testing.assert_array_equal(body.batch.ctrl[:, body._grips], [[0.5, 0], [1, 0], [1, 1]])
    gains = body.batch.expand("actuator_gainprm")[:, body._grips, 0]
    np.testing.assert_array_equal(gains, np.tile(body.grip_n[:, None], 2))
    body.reset()
    assert not body.batch.ctrl[:, body._grips].any()


def test_hands_that_are_busy_stay_at_the_chest_whatever_is_commanded() -> None:
    """Within a centimetre of where they are bound, while free ones wander."""
    rng = np.random.default_rng(0)
    motors = rng.uniform(-1, 1, (4, 8, 25)).repeat(25, 0)
    farthest = []
    for body in (at_table("panel", copies=8, busy=True), at_table("panel", copies=8)):
        points = body.batch.bind("site_xpos")
        pairs = [[body.model.site(one).id for one in (palm, f"{palm}_hold")] for palm in SEAT.parts[:2]]
        away = []
        for command in motors:
            body.act(command)
            away.append([np.linalg.norm(points[:, palm] - points[:, chest], axis=1) for palm, chest in pairs])
        farthest.append(np.max(away[10:]))
    assert farthest[0] < 0.01 < 0.1 < farthest[1]
