"""Pictures by rays: a pixel shows what a single ray meets, all is in the picture, a ghost shows what differs."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from models.film import AMBIENT, Filmed, view_of
from models.loading import load_body

GROUND, GHOST = (30, 34, 40), (120, 170, 255)
THING = """
<mujoco><asset>
  <mesh name="tent" vertex="0 0 .3  .2 .2 0  -.2 .2 0  0 -.2 0" face="{faces}"/>
  <material name="red" rgba="1 0 0 1"/>
</asset><worldbody>
  <geom name="floor" type="plane" size="1 1 1"/>
  <geom name="hidden" group="3" size=".5"/>
  <geom name="glass" size=".5" rgba="1 1 1 0"/>
  <body name="thing" pos="{place}"><joint name="turn" axis="0 0 1"/>
    <geom name="tent" type="mesh" mesh="tent" material="red"/>
    <geom name="ball" size=".1" pos=".1 .25 .1" rgba="0 1 0 1"/>
  </body></worldbody></mujoco>
"""
FACES = "1 2 0 2 3 0 3 1 0 3 2 1"
AWAY = np.array([7.0, -4.0, 2.0])


def thing(place: np.ndarray | None = None, faces: str = FACES) -> mujoco.MjModel:
    where = " ".join(map(str, np.zeros(3) if place is None else place))
    return mujoco.MjModel.from_xml_string(THING.format(place=where, faces=faces))


def picture(model: mujoco.MjModel, turn: float = 0.0, ghost: float | None = None) -> np.ndarray:
    film = Filmed(model, GROUND, GHOST)
    view = view_of(film.corners(np.zeros(1)).reshape(-1, 3), 80, 60)
    return film.picture(view, np.array([turn]), None if ghost is None else np.array([ghost]))


def test_every_pixel_shows_what_a_single_ray_meets(arm: Path) -> None:
    body = load_body(arm)
    film, posture = Filmed(body.model, GROUND, GHOST), body.configurations(np.array([[0.4, 0.8, 0.2]]))[0]
    view = view_of(film.corners(posture).reshape(-1, 3), 64, 48)
    shown, data = film.picture(view, posture).astype(int), mujoco.MjData(body.model)
    data.qpos[:] = posture
    mujoco.mj_forward(body.model, data)
    met = np.zeros((48, 64), bool)
    for row, column in np.ndindex(48, 64):
        ray = view.axes @ [(column - 31.5) / view.focal_px, (23.5 - row) / view.focal_px, -1]
        met[row, column] = mujoco.mj_ray(body.model, data, view.place, ray, None, 1, -1, np.zeros(1, np.int32)) >= 0
    inner = np.ones_like(met)  # not beside an edge, where a pixel is the mean of several rays
    for shift, axis in ((1, 0), (-1, 0), (1, 1), (-1, 1)):
        inner &= np.roll(met, shift, axis) == met
    assert met.mean() > 0.03 and inner.mean() > 0.8
    np.testing.assert_array_equal((shown != GROUND).any(-1)[inner], met[inner])


@pytest.mark.parametrize("size", [(80, 60), (60, 80), (200, 50)])
def test_everything_is_in_the_picture_and_fills_it(size: tuple[int, int]) -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        points = rng.normal(size=(50, 3)) * rng.uniform(0.01, 3, 3) + rng.normal(size=3)
        places = view_of(points, *size).pixels(points) / (np.array(size) - 1)
        assert places.min() > -0.02 and places.max() < 1.02
        assert np.ptp(places, axis=0).max() > 0.85
    assert (view_of(np.zeros((0, 3)), *size).place != 0).any()  # nothing to see


def test_a_body_where_its_ghost_is_looks_like_itself_and_elsewhere_both_are_seen() -> None:
    alone, same, other = picture(thing()), picture(thing(), 0.0, 0.0), picture(thing(), 0.0, 1.5)
    np.testing.assert_array_equal(alone, same)
    assert (picture(thing(), 0.0, 0.004) != alone).any(-1).mean() < 0.02  # as good as there
    beside = (alone == GROUND).all(-1) & (other != GROUND).any(-1)
    assert beside.sum() > 20
    bluish = other[beside].astype(int) - GROUND
    assert (bluish[:, 2] >= bluish[:, 0]).all() and bluish[:, 2].max() > 60


def test_where_it_stands_and_how_its_meshes_are_wound_changes_nothing() -> None:
    here = picture(thing(), 0.2, 0.5).astype(int)
    far = picture(thing(AWAY), 0.2, 0.5).astype(int)
    assert np.abs(here - far).mean() < 0.5
    wound = " ".join(face for three in zip(*[iter(FACES.split())] * 3, strict=True) for face in reversed(three))
    np.testing.assert_array_equal(picture(thing(faces=FACES)), picture(thing(faces=wound)))


def test_planes_hidden_and_transparent_shapes_are_left_out_and_materials_colour() -> None:
    film = Filmed(thing(), GROUND, GHOST)
    assert film.corners(np.zeros(1)).shape == (2, 8, 3)
    colours = {tuple(one) for one in picture(thing()).reshape(-1, 3)}
    red, green = (max(one for one in colours if one[k] > 0 and sum(one) == one[k]) for k in (0, 1))
    assert 255 * AMBIENT < red[0] <= 255 and 255 * AMBIENT < green[1] <= 255
    assert (picture(thing())[0] == GROUND).all()
