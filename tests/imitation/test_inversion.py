"""Turning the body image round: the analytic optimum, inside the ranges, along the most probable path."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.body_image import COMFORT
from imitation.correspondence.inversion import JUMP, NEAR, _library, _path, choose
from tests.imitation.planar import image, pointing, view

WEIGHTS = np.array([[1.0, 0.05]])


def turned(vector: np.ndarray, angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ vector


def optimum(wanted: np.ndarray, weights: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[float, np.ndarray]:
    """Least cost and (2,) angles of the arm for (2, 3) wanted directions, in closed form.

    Inside, each link points at its own target. With the elbow at a stop both targets pull at the shoulder; with the
    shoulder at a stop the elbow is free to follow its own.
    """
    first, second = wanted[:, :2]
    ways = []
    for b in (None, low[1], high[1]):
        pull = first if b is None else weights[0] * first + weights[1] * turned(second, -b)
        for a in (np.arctan2(*pull[::-1]), low[0], high[0]):
            elbow = np.arctan2(*turned(second, -a)[::-1]) if b is None else b
            if low[0] <= a <= high[0] and low[1] <= elbow <= high[1]:
                angles = np.array([a, elbow])
                ways.append((float(weights @ ((pointing(angles[None])[0] - wanted) ** 2).sum(-1)), angles))
    return min(ways, key=lambda way: way[0])


def chosen(wanted: np.ndarray, **of: tuple[float, float]) -> np.ndarray:
    """For frames that have nothing to do with each other, one at a time, what is chosen of the first."""
    return choose(view(image(**of), 1), wanted[None], WEIGHTS, np.zeros(2))


@given(st.integers(0, 2**31))
@settings(max_examples=40, deadline=None)
def test_the_optimum_of_a_planar_arm_is_found(seed: int) -> None:
    """Targets off the plane, and a little beyond the stops: it is the closed form's, inside the range."""
    rng = np.random.default_rng(seed)
    low, high = np.array([-1.5, 0.2]), np.array([1.5, 1.8])
    wanted = pointing(rng.uniform(low - 0.4, high + 0.4)[None])[0]
    wanted[:, 2] = rng.uniform(-0.5, 0.5, 2)
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    found = chosen(wanted, low=(-1.5, 0.2), high=(1.5, 1.8))[0]
    least, best = optimum(wanted, WEIGHTS[0], low, high)
    assert (found >= low).all() and (found <= high).all()
    np.testing.assert_allclose(found, best, atol=2e-3)
    assert WEIGHTS[0] @ ((pointing(found[None])[0] - wanted) ** 2).sum(-1) == pytest.approx(least, abs=1e-6)


def test_an_elbow_at_its_stop_leaves_the_rest_to_the_shoulder() -> None:
    """The forearm should bend to -0.5, its elbow stops at 0.2: the shoulder gives a little, by the weights."""
    wanted = pointing(np.array([[0.4, -0.5]]))[0]
    _, best = optimum(wanted, WEIGHTS[0], np.array([-1.5, 0.2]), np.array([1.5, 1.8]))
    assert best[1] == 0.2 and 0.3 < best[0] < 0.39
    np.testing.assert_allclose(chosen(wanted, low=(-1.5, 0.2), high=(1.5, 1.8))[0], best, atol=1e-4)


def test_slopes_are_tangential_and_those_of_unit_vectors() -> None:
    """A learned image is not quite of unit length; what is followed is its direction alone."""
    rng, exact = np.random.default_rng(1), image()
    rough = {part: replace(one, weights=1.3 * one.weights + 0.2 * rng.normal(size=one.weights.shape))
             for part, one in exact.images.items()}  # fmt: skip
    seen, rows = view(replace(exact, images=rough), 30), np.arange(30)
    angles = rng.uniform(-2, 2, (30, 2))
    unit, slope = seen.directions(angles, rows)
    np.testing.assert_allclose(np.linalg.norm(unit, axis=-1), 1)
    np.testing.assert_allclose(np.einsum("tsi,tsij->tsj", unit, slope), 0, atol=1e-12)
    for joint in range(2):
        step = 1e-6 * np.eye(2)[joint]
        change = (seen.directions(angles + step, rows)[0] - seen.directions(angles - step, rows)[0]) / 2e-6
        np.testing.assert_allclose(slope[..., joint], change, atol=1e-7)


@given(st.integers(0, 2**31))
@settings(max_examples=20, deadline=None)
def test_the_path_is_the_best_of_all(seed: int) -> None:
    """Against every one of 3^5 paths through the candidates."""
    rng = np.random.default_rng(seed)
    found, costs = rng.normal(size=(3, 5, 2)), rng.exponential(1.0, (3, 5))

    def price(way: tuple[int, ...]) -> float:
        path = found[way, range(5)]
        return float(costs[way, range(5)].sum() + JUMP * (np.diff(path, axis=0) ** 2).sum())

    best = min(product(range(3), repeat=5), key=price)
    np.testing.assert_array_equal(_path(found, costs), found[best, range(5)])


def test_a_little_better_is_not_worth_a_jump_and_much_better_is() -> None:
    found = np.zeros((2, 6, 1))
    found[1] = 1.0
    turns = np.tile([0.0, 0.01], 3)
    assert np.ptp(_path(found, np.stack([turns, turns[::-1]]))) == 0
    late = np.repeat([0.0, 10.0], 3)
    np.testing.assert_array_equal(_path(found, np.stack([late, late[::-1]]))[:, 0], late / 10)


def test_one_wild_frame_is_alone_with_it() -> None:
    time = np.linspace(0, 3, 60)
    angles = np.stack([0.8 * np.sin(time), 0.5 + 0.4 * np.cos(2 * time)], 1)
    wanted, wild = pointing(angles), pointing(angles)
    wild[30] = [[-0.6, 0, 0.8], [0, 0.6, -0.8]]
    seen, weights = view(image(), 60), np.tile(WEIGHTS, (60, 1))
    calm, odd = (choose(seen, one, weights, np.zeros(2)) for one in (wanted, wild))
    np.testing.assert_allclose(calm, angles, atol=1e-4)
    others = np.arange(60) != 30
    np.testing.assert_allclose(odd[others], calm[others], atol=1e-9)


def test_what_is_met_does_not_depend_on_what_is_remembered() -> None:
    """The library chooses where to begin; the angles are as fine as the image."""
    angles = np.random.default_rng(2).uniform(-1.4, 1.4, (20, 2)).cumsum(0) * 0.1
    weights, doubt = np.tile(WEIGHTS, (20, 1)), np.zeros(2)
    few, many = (choose(view(image(remembered=n), 20), pointing(angles), weights, doubt) for n in (5, 200))
    np.testing.assert_allclose(few, many, atol=1e-6)


def test_the_posterior_prefers_postures_that_look_right() -> None:
    """Its mean posture of the library points more nearly there than the library does by chance."""
    of, angles = image(remembered=200), np.array([[1.0, 0.8], [-1.2, 0.3]])
    for posture in angles:
        wanted = pointing(posture[None])
        posterior, _ = _library(view(of, 1), wanted, WEIGHTS)
        assert posterior.sum() == pytest.approx(1)
        misses = np.linalg.norm(pointing(of.library) - wanted, axis=-1)[:, 0]
        assert posterior[0] @ misses < 0.5 * misses.mean()


def test_a_frame_in_which_nothing_is_seen_stays_near_the_one_before() -> None:
    """The prior is carried on: where one was, spread by how far one usually goes and how comfortable it is there."""
    of = image(remembered=60)
    seen = view(of, 3)
    weights = np.array([[1.0, 1.0], [1e-16, 1e-16], [1e-16, 1e-16]])
    posterior, cells = _library(seen, pointing(np.array([[1.0, 0.8], [-1.0, 0.3], [-1.0, 0.3]])), weights)
    carried = posterior[0]
    for t in (1, 2):
        wanted = np.zeros(len(cells))
        for before, share in zip(cells, carried, strict=True):
            ways = np.array(
                [
                    np.exp(-((there - before) ** 2).sum() / (2 * NEAR**2))
                    * np.exp(-((there - seen.rest) ** 2).sum() / (2 * COMFORT**2))
                    for there in cells
                ]
            )
            wanted += share * ways / ways.sum()
        np.testing.assert_allclose(posterior[t], wanted, atol=1e-6)
        carried = wanted
