"""Two eyes' geometry: places, and how the eyes stand in the head, on heads of pure geometry that squint."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from babbling.axes import FloatArray
from babbling.looking import LookingMind, Reach, pilot_looking
from babbling.loop import babble
from imitation.seeing.stereo import Geometry
from tests.babbling.test_looking import FOCAL, HALF, REACH, CrossedHead, GeometricHead

STAND = np.deg2rad([[0.7, -0.9, -2.6], [-0.4, 0.6, 1.3]])
HALF_BASELINE, ABOVE = 0.05, 0.048
"""m: the eyes stand to the sides of where the hinges cross, and above."""


class SquintingHead(GeometricHead):
    """Eyes off the hinges, each turned its own way; things hang about a metre off."""

    stand = STAND

    def __init__(self, copies: int = 24, toys: int = 12, seed: int = 0, noise: float = 0.03) -> None:
        super().__init__(copies, toys, seed, noise)
        self.ways *= np.random.default_rng([seed, 1]).uniform(0.9, 1.1, (copies, toys, 1))

    def carried(self) -> np.ndarray:
        """(B, K, 3) m where things are in the head's frame, from the middle between the eyes."""
        neck = Rotation.from_euler("ZY", self.posture)
        places = [turn.inv().apply(ways) for turn, ways in zip(neck, self.ways, strict=True)]
        return np.array(places) - (0.0, 0.0, ABOVE)

    def _see(self) -> np.ndarray:
        place = []
        for turned, side in zip(self.stand, (HALF_BASELINE, -HALF_BASELINE), strict=True):
            x, y, z = np.moveaxis(
                (self.carried() - (0, side, 0)) @ Rotation.from_rotvec(turned).as_matrix(), -1, 0
            )  # rows times E is E^T times columns
            place += [np.where(x > 0, -FOCAL * y / x, np.nan), np.where(x > 0, -FOCAL * z / x, np.nan)]
        seen = np.stack(place, -1) + self.noise * self.rng.standard_normal((*place[0].shape, 4))
        half = np.tile(HALF, 2)
        inside = (np.abs(seen) < half).reshape(*seen.shape[:-1], 2, 2).all(-1).repeat(2, -1)
        return np.concatenate([self.posture, np.where(inside, seen + half, np.nan).reshape(self.copies, -1)], 1)


class CrossedSquintingHead(CrossedHead, SquintingHead):
    """The same with crossed wires: its first motor tilts."""


@cache
def learned(head: type[GeometricHead]) -> LookingMind:
    reach = Reach(REACH.low[::-1], REACH.high[::-1], REACH.largest[::-1]) if issubclass(head, CrossedHead) else REACH
    found = pilot_looking(head(), reach, 0)
    return LookingMind(found, babble(head(), found, (20,) * 6, 0), 2.0)


angles = st.floats(-0.1, 0.1)
numbers = st.floats(-3.0, 3.0)


@settings(max_examples=60, deadline=None)
@given(
    st.tuples(st.floats(3.0, 20.0), numbers, numbers),
    st.floats(-0.5, 0.5),
    st.floats(50.0, 500.0),
    st.lists(angles, min_size=6, max_size=6),
)
def test_locating_and_appearing_undo_each_other(
    place: tuple[float, ...], tilt: float, focal: float, stand: list[float]
) -> None:
    places = np.array([place, (6.0, 0.0, 0.0)])
    geometry = Geometry(focal, np.reshape(stand, (2, 3)))
    things = geometry.appear(places, tilt)
    np.testing.assert_allclose(geometry.locate(things, tilt), places, atol=1e-7)
    np.testing.assert_allclose(geometry.project(geometry.ways(things)), things, atol=1e-8 * focal)
    level = Geometry(focal).appear(places, tilt)
    np.testing.assert_array_equal(level[:, 1], level[:, 3])
    assert (level[:, 0] > level[:, 2]).all()


def test_places_appear_as_two_pinholes_see_them() -> None:
    geometry = Geometry(138.6)
    ahead = geometry.appear(np.array([5.0, 0.0, 0.0]), 0.0)
    np.testing.assert_allclose(ahead, [138.6 * 0.5 / 5.0, 0.0, -138.6 * 0.5 / 5.0, 0.0], atol=1e-12)
    left_up = geometry.appear(np.array([5.0, 1.0, 0.5]), 0.0)
    assert left_up[0] < 0 and left_up[1] < 0  # u grows to the right, v downwards
    nod = geometry.appear(np.array([5.0 * np.cos(0.2), 0.0, -5.0 * np.sin(0.2)]), 0.2)
    np.testing.assert_allclose(nod, ahead, atol=1e-12)  # what lies where the neck is tilted to stands in the middle


def test_an_eye_has_in_its_middle_what_it_is_turned_to() -> None:
    turned = np.array([[0.0, 0.0, -0.1], [0.0, 0.2, 0.0]])  # the left eye to the right, the right one down
    places = np.array([[5.0, 0.5 - 5 * np.tan(0.1), 0.0], [5.0, -0.5, -5 * np.tan(0.2)]])
    here = Geometry(FOCAL, turned).appear(places, 0.0)
    np.testing.assert_allclose([here[0, :2], here[1, 2:]], 0.0, atol=1e-9)
    rolled = Geometry(FOCAL, np.array([[0.1, 0, 0], [0, 0, 0]])).appear(np.array([5.0, 1.5, 0.0]), 0.0)
    np.testing.assert_allclose(rolled[:2], FOCAL / 5 * np.array([-np.cos(0.1), np.sin(0.1)]))


@pytest.mark.parametrize("head", [SquintingHead, CrossedSquintingHead])
def test_how_the_eyes_stand_is_found_by_looking_about(head: type[SquintingHead]) -> None:
    found = Geometry.of(learned(head))
    assert found.focal_px == pytest.approx(FOCAL, rel=0.015)
    np.testing.assert_allclose(np.rad2deg(found.stand), np.rad2deg(head.stand), atol=0.2)
    vergence = np.rad2deg(np.diff((found.stand - head.stand)[:, 2])).item()
    assert abs(vergence) < 0.08  # a fifth of a pixel of the fourteen that a thing a metre off has


class Exact(LookingMind):
    """One who expects of things a metre off just what happens."""

    def expect(self, things: FloatArray, posture: FloatArray, change: FloatArray, *, table: bool = True) -> FloatArray:
        was, now = (
            Rotation.from_rotvec(at[:, :1] * (0, 0, 1)) * Rotation.from_rotvec(at[:, 1:] * (0, 1, 0))
            for at in (posture, posture + change)
        )
        seen = []
        for stand, side, place in zip(STAND, (HALF_BASELINE, -HALF_BASELINE), np.hsplit(things, 2), strict=True):
            stands, eye = Rotation.from_rotvec(stand), np.array([0.0, side, ABOVE])
            sight = np.insert(-place, 0, FOCAL, axis=1)
            still = was.apply(stands.apply(sight / np.linalg.norm(sight, axis=1, keepdims=True)) + eye)
            x, y, z = stands.inv().apply(now.inv().apply(still) - eye).T
            seen += [-FOCAL * y / x, -FOCAL * z / x]
        return np.stack(seen, -1)


def test_expectations_that_are_exact_are_explained_exactly() -> None:
    mind = learned(SquintingHead)
    found = Geometry.of(Exact(mind.pilot, mind.forward_model, mind.minutes))
    assert found.focal_px == pytest.approx(FOCAL, rel=1e-6)
    np.testing.assert_allclose(found.stand, STAND, atol=1e-6)


def test_places_are_found_with_eyes_that_squint_and_not_by_taking_them_for_parallel() -> None:
    body = SquintingHead(seed=7, noise=0.0)
    mind = learned(SquintingHead)
    things, found = mind.pilot.retina.things(body.reset()), Geometry.of(mind)
    true = body.carried() / (2 * HALF_BASELINE)
    off = np.linalg.norm(found.locate(things, 0.0) - true, axis=-1) / np.linalg.norm(true, axis=-1)
    off = off[np.isfinite(off)]
    assert len(off) > 50 and np.median(off) < 0.02 and off.max() < 0.04
    parallel = Geometry(found.focal_px).locate(things, 0.0)
    far = np.linalg.norm(parallel - true, axis=-1) / np.linalg.norm(true, axis=-1)
    assert np.nanmin(far) > 0.4
