"""Looks by pixels: eyes that know their own geometry see things where they lie, and what is hidden is remembered."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from babbling.body_image import PartImage
from babbling.own_eyes import OwnEyes, learn_own_eyes
from experiments.shared.pixels import Watching, film, pixels
from experiments.shared.playing import BESIDE, SEATED, USUAL, at_table, remembered
from models.loading import load_body
from models.objects import TOYS
from models.objects.playing import MIDDLE
from models.objects.retinas import EYES, Room

HANDS, A, B = 2, 3, 4
MOVERS = ("body_joint_1", "head_joint_1", "head_joint_2")


@pytest.fixture(scope="module")
def eyes() -> OwnEyes:
    """Learned from pinholes where the robot's are, shown points instead of hands."""
    body, rng = load_body(SEATED), np.random.default_rng(0)
    joints = np.sort([body.joints.index(name) for name in MOVERS])
    rest = body.reset()[0, : len(body.joints)]
    postures = np.tile(rest, (500, 1))
    postures[:, joints] += rng.uniform(-0.2, 0.2, (500, 3))
    places = rng.uniform((0.1, -0.1, 0.2), (0.25, 0.1, 0.3), (500, 2, 3))
    seen, data = np.empty((2, 500, 2, 2)), mujoco.MjData(body.model)
    for n, configuration in enumerate(body.configurations(postures)):
        data.qpos[:] = configuration
        mujoco.mj_kinematics(body.model, data)
        mujoco.mj_camlight(body.model, data)
        for eye, name in enumerate(EYES):
            camera = body.model.camera(name).id
            x, y, z = ((places[n] - data.cam_xpos[camera]) @ data.cam_xmat[camera].reshape(3, 3)).T
            seen[eye, n] = np.stack([x / -z, y / z], -1)
    return learn_own_eyes(seen, postures, places - MIDDLE, PartImage(joints, rest[joints], np.zeros((27, 3)), 0.0), "x")


def image() -> SimpleNamespace:
    """Knows nothing of its parts, which are not what is asked for here."""
    nothing = PartImage(np.array([0]), np.zeros(1), np.zeros((3, 3)), 0.0)
    return SimpleNamespace(images=dict.fromkeys(("left", "right", "head"), nothing))


@pytest.mark.parametrize("toy", TOYS)
def test_things_lie_where_ones_eyes_see_them(eyes: OwnEyes, toy: str) -> None:
    """To what shows of them: not farther than a thing is large."""
    body = at_table(toy, 2)
    body.set_out(0)
    felt = body.joint_angles
    look = pixels(eyes, image(), every=2)
    seen = look(body, felt, True, np.random.default_rng(0))
    away = np.linalg.norm(seen[:, A:] - body.places[:, A:], axis=-1)
    assert (away[:, 0] < {"box": 0.05}.get(toy, 0.035)).all()
    assert np.isnan(away[:, 1]).all() if toy == "panel" else (away[~np.isnan(away[:, 1]), 1] < 0.035).all()
    body.act(np.zeros((2, len(body.joints))))
    assert np.isnan(look(body, felt, False, np.random.default_rng(0))[:, A:]).all()


def test_what_is_hidden_is_remembered() -> None:
    rng, foot = np.random.default_rng(0), 0.02
    looks = rng.uniform(-0.1, 0.1, (6, 5, 5, 3))
    looks[:, :, B] = looks[:1, :, B] + (0.5, 0, 0)
    filled = remembered(looks, foot)
    np.testing.assert_array_equal(filled, looks)
    looks[3:, 0, A] = np.nan  # last seen far from b
    looks[4:, 1, A], looks[3, 1, A] = np.nan, looks[3, 1, B] + (BESIDE / 2, 0, 0.1)  # vanished over b
    looks[:, 2, B] = np.nan
    looks[:, 3, A:] = np.nan
    filled = remembered(looks, foot)
    np.testing.assert_array_equal(filled[3:, 0, A], looks[[2, 2, 2], 0, A])
    np.testing.assert_array_equal(filled[-1, 1, A], looks[-1, 1, B] - (0, 0, foot))
    np.testing.assert_array_equal(filled[:, 2, B], looks[[0] * 6, 2, A])
    np.testing.assert_array_equal(filled[:, 3, A:], np.broadcast_to(USUAL, (6, 2, 3)))
    np.testing.assert_array_equal(filled[:, 4], looks[:, 4])


def test_hands_are_watched_now_and_then_and_the_same_again() -> None:
    def watched() -> np.ndarray:
        body = load_body(SEATED)
        body.reset()
        watching = Watching(body, 0, every=3)
        return np.array([watching.look() for _ in range(4)])

    seen = watched()
    assert (~np.isnan(seen[[0, 3]])).all() and np.isnan(seen[1:3]).all()
    np.testing.assert_array_equal(seen, watched())
    left, right = np.moveaxis(seen[0, 0], 0, 0)
    assert (left[:, 0] > right[:, 0]).all()  # nearer than infinity
    np.testing.assert_allclose(left[:, 1], right[:, 1], atol=0.02)


@pytest.mark.parametrize(("apart", "coordinates"), [(0.045, 3), (0.0, 2)])
def test_a_film_tells_places_of_two_eyes_and_positions_of_one(apart: float, coordinates: int) -> None:
    body = at_table("dumbbell", 1)
    still = np.repeat(body.configuration, 2, 0)
    tracks = film(body, still, body.laid[0], Room(apart=apart), np.random.default_rng(0))
    assert tracks.shape == (2, 5, coordinates) and not np.isnan(tracks).any()
    np.testing.assert_allclose(tracks[0], tracks[1], atol=0.03)
    if apart:
        true, found = body.places[0], tracks.mean(0)
        between = [np.linalg.norm(places[:, None] - places[None], axis=-1) for places in (true, found)]
        np.testing.assert_allclose(between[1], between[0], atol=0.03)
