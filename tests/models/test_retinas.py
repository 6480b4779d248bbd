"""Images of the play table: every mark is there in its colour where geometry says, and a light that is on looks on."""

import mujoco
import numpy as np
import pytest

from imitation.seeing.marks import MARKS, centred, glows, located, marks
from models.errors import BodyError
from models.objects import TOYS
from models.objects.playing import PlayBody
from models.objects.retinas import Retinas, Room
from models.objects.scene import PREFIX, seated
from models.retina import RetinaOptions
from models.robots import ROBOTS

ROBOT = ROBOTS["hoap2-seated"]
SEAT = ROBOT.seat
FRONT = Room()
QUIET = RetinaOptions(320, 240, fovy_deg=40.0)
HAND, FOREHEAD, A, B = 0, 2, 3, 4


def body(toy: str, copies: int = 1) -> PlayBody:
    assert SEAT is not None
    return PlayBody(ROBOT, SEAT, TOYS[toy], name="hoap2-seated", copies=copies, threads=1)


def watched(toy: str, room: Room = FRONT) -> tuple[np.ndarray, PlayBody]:
    """(cameras, 5, 2) marks from a room."""
    one = body(toy)
    retinas = Retinas.of(one, room=room, options=QUIET)
    images = retinas.see(one.configuration[0], np.random.default_rng(0), one.laid[0])
    both = zip(images, retinas.eyes, strict=True)
    return np.array([centred(marks(image), 320, 240, eye.focal_px) for image, eye in both]), one


@pytest.mark.parametrize("toy", TOYS)
def test_every_mark_is_seen_and_is_where_it_is(toy: str) -> None:
    """From three quarters of a metre: to a centimetre and a half across, for what shows is not a thing's middle."""
    room = FRONT
    seen, one = watched(toy, room)
    back = np.subtract(room.place, room.at) / np.linalg.norm(np.subtract(room.place, room.at))
    left = np.cross(-back, (0, 0, 1))
    left /= -np.linalg.norm(left)
    found = located(seen, room.apart) @ np.stack([-back, left, np.cross(-back, left)]) + room.place
    true = one.places[0] + (0.1, 0.0, 0.3)
    assert (~np.isnan(found[: A + 1])).all()
    assert np.isnan(found[B, 0]) == (toy in ("panel", "box"))  # no part of its own; in a hole, from behind
    across = found - true
    across -= (across @ back)[:, None] * back
    assert np.nanmax(np.linalg.norm(across, axis=1)) < 0.015
    assert abs((found[FOREHEAD] - true[FOREHEAD]) @ back) < 0.015


def test_one_camera_sees_what_either_of_two_sees() -> None:
    pair, _ = watched("dumbbell", Room(apart=1e-9))
    alone, _ = watched("dumbbell", Room(apart=0))
    np.testing.assert_allclose(pair[0], alone[0], atol=1e-6)


def test_what_stands_behind_is_not_seen() -> None:
    """A light panel before the hand of one who is watched from table height."""
    one = body("panel")
    retinas = Retinas.of(one, room=Room((0.6, 0.0, 0.21), (0.0, 0.0, 0.21), 0.0), options=QUIET)
    hidden = one.configuration[0].copy()
    there = marks(retinas.see(hidden, np.random.default_rng(0), one.laid[0])[0])
    lying = marks(retinas.see(hidden, np.random.default_rng(0), one.laid[0] + np.array([0, 0, 5.0, 0, 0, 0, 0]))[0])
    assert not np.isnan(there[A]).any() and np.isnan(lying[A]).all()


def test_pieces_are_seen_where_they_were_set_out() -> None:
    many = body("cup", 4)
    many.set_out(0)
    retinas = Retinas.of(many, room=Room(), options=QUIET)
    rng = np.random.default_rng(0)
    seen = np.array(
        [marks(retinas.see(q, rng, laid)[0]) for q, laid in zip(many.configuration, many.laid, strict=True)]
    )
    moved, shown = np.ptp(many.places[:, B, 1]), np.ptp(seen[:, B, 0])
    assert moved > 0.005
    focal, ahead = retinas.eyes[0].focal_px, 0.65
    np.testing.assert_allclose(shown, moved * focal / ahead, rtol=0.15)


def test_a_light_that_is_on_is_told_from_one_that_is_off() -> None:
    one = body("panel")
    switch = int(one.model.joint(f"{PREFIX}switch").qposadr[0])
    for retinas in (Retinas.of(one), Retinas.of(one, room=Room())):
        for pressed in (0.0, 0.003, 0.0):
            configuration = one.configuration[0].copy()
            configuration[switch] = pressed
            images = retinas.see(configuration, np.random.default_rng(1), one.laid[0])
            assert [glows(image) for image in images] == [pressed > 0] * 2
            assert not np.isnan([marks(image)[A] for image in images]).any()


def test_a_buzzing_box_is_not_seen_to_buzz() -> None:
    one = body("box")
    configuration = one.configuration[0].copy()
    configuration[int(one.model.joint(f"{PREFIX}switch").qposadr[0])] = 0.005
    [image] = Retinas.of(one, room=Room(apart=0)).see(configuration, np.random.default_rng(1), one.laid[0])
    assert not glows(image)


def test_marks_are_the_only_colours_and_change_no_physics() -> None:
    """Nothing answers to what is only seen; all but the marked is grey."""
    assert SEAT is not None
    model = seated(ROBOT, SEAT, TOYS["dumbbell"]).compile()
    colours = model.geom_rgba[:, :3][(model.geom_group < 3) & (np.ptp(model.geom_rgba[:, :3], axis=1) > 0.1)]
    assert len(np.unique(colours.round(2), axis=0)) == len(MARKS)
    felt = {*SEAT.touching, "table", f"{PREFIX}a", f"{PREFIX}b"}
    touching = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    assert {model.geom(g).name for g in np.flatnonzero(touching)} == felt
    assert model.body_mass.sum() == pytest.approx(mujoco_mass() + sum(model.body_mass[i] for i in toys(model)))


def toys(model: mujoco.MjModel) -> list[int]:
    return [i for i in range(model.nbody) if model.body(i).name.startswith(PREFIX)]


def mujoco_mass() -> float:
    return float(mujoco.MjModel.from_xml_path(str(ROBOT.path)).body_mass.sum())


def test_a_camera_looks_across() -> None:
    with pytest.raises(BodyError, match="not up or down"):
        Retinas.of(body("cup"), room=Room((0.1, 0, 1), (0.1, 0, 0.2)))
