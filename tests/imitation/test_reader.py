"""Reading gaze: two eyes' geometry, Eq. (2) against Bayes by hand, what one look can say at most, lore about eyes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imitation.errors import ImitationError
from imitation.gaze.reader import ANYWHERE, LAPSE, EyeLore, GazeReader, Preferences, facing
from imitation.seeing.stereo import Geometry


class LikeMe(GazeReader):
    """A reader whose own head is pure geometry: pan and tilt are the angles of a place."""

    def imagined(self, places: np.ndarray, head: np.ndarray, origin: np.ndarray | None = None) -> np.ndarray:
        mine = facing(places, head) - (self.origin if origin is None else origin)
        level = np.hypot(mine[..., 0], mine[..., 1])
        return np.stack([np.arctan2(mine[..., 1], mine[..., 0]), -np.arctan2(mine[..., 2], level)], -1)


PLACES = np.array([[5.0, 2.0, -2.0], [5.0, -2.0, -2.0], [6.0, 0.3, -1.8]])
HEAD = np.array([10.0, 0.0, 0.0])


def reader() -> LikeMe:
    return LikeMe((None, None), Geometry(138.6), 0.1, covariance=np.diag([0.05, 0.05]) ** 2)  # type: ignore[arg-type]


def test_facing_is_an_involution_and_the_other_sees_our_left_on_its_right() -> None:
    np.testing.assert_allclose(facing(np.array([4.0, 1.0, -2.0]), HEAD), [6.0, -1.0, -2.0])
    other = np.array([9.0, 0.7, -0.4])
    ours = facing(np.zeros(3), other)  # where we are to the other, who takes us as we take it
    np.testing.assert_allclose(facing(facing(PLACES, other), ours), PLACES, atol=1e-12)


def test_like_me_is_a_density_that_peaks_at_the_looked_at_thing() -> None:
    gaze = replace(reader(), bias=np.array([0.02, -0.03]), covariance=np.array([[0.004, 0.001], [0.001, 0.002]]))
    expected = gaze.expected(PLACES, HEAD)
    for k, pose in enumerate(expected):
        density = gaze.like_me(pose, expected)
        assert density.argmax() == k
        assert density[k] == pytest.approx(1 / (2 * np.pi * np.sqrt(np.linalg.det(gaze.covariance))))
        for step in 0.02 * np.array([(1, 0), (-1, 0), (0, 1), (0, -1)]):
            assert gaze.like_me(pose + step, expected)[k] < density[k]
    side = np.linspace(-0.5, 0.5, 201)
    grid = np.stack(np.meshgrid(side, side), -1).reshape(-1, 2) + expected[0]
    mass = np.array([gaze.like_me(pose, expected[:1])[0] for pose in grid[::7]]).sum() * 7 * (side[1] - side[0]) ** 2
    assert mass == pytest.approx(1.0, abs=0.01)


@settings(max_examples=60, deadline=None)
@given(st.floats(-1.5, 1.5), st.floats(-1.0, 1.0), st.floats(0.0, 1.0), st.integers(0, 2**32 - 1))
def test_a_lapse_bounds_what_one_look_can_say(pan: float, tilt: float, sees: float, seed: int) -> None:
    """No pose makes a goal more than peak / floor as likely as another, beside their priors."""
    gaze, prior = reader(), np.random.default_rng(seed).dirichlet(np.ones(3)) + 1e-3
    prior /= prior.sum()
    odds = gaze.read(np.array([pan, tilt]), gaze.expected(PLACES, HEAD), prior, sees).probability / prior
    peak = (1 - LAPSE) / (2 * np.pi * 0.05**2) + LAPSE * ANYWHERE
    assert odds.max() / odds.min() <= peak / (LAPSE * ANYWHERE) * (1 + 1e-9)
    more = gaze.read(np.array([pan, tilt]), gaze.expected(PLACES, HEAD), prior, 1.0).probability / prior
    assert odds.max() / odds.min() <= more.max() / more.min() * (1 + 1e-9)  # doubt about the eyes says less, never more


def test_equation_two_agrees_with_bayes_by_hand() -> None:
    gaze, prior, pose = reader(), np.array([0.2, 0.5, 0.3]), np.array([-0.3, 0.35])
    expected = gaze.imagined(PLACES, HEAD)
    density = np.exp(-0.5 * ((pose - expected) ** 2).sum(1) / 0.05**2) / (2 * np.pi * 0.05**2)
    by_hand = ((1 - LAPSE) * density + LAPSE * ANYWHERE) * prior
    np.testing.assert_allclose(gaze.read(pose, expected, prior).probability, by_hand / by_hand.sum(), rtol=1e-9)


def test_who_cannot_see_tells_nothing_and_a_resting_head_hardly_anything() -> None:
    gaze, prior = reader(), np.array([0.2, 0.5, 0.3])
    expected = gaze.expected(PLACES, HEAD)
    np.testing.assert_allclose(gaze.read(np.array([-0.3, 0.35]), expected, prior, sees=0.0).probability, prior)
    np.testing.assert_allclose(gaze.read(np.zeros(2), expected, prior).probability, prior, atol=0.02)


def test_where_gaze_comes_from_and_how_surely_is_learned_from_shown_goals() -> None:
    rng = np.random.default_rng(1)
    origin = np.array([-0.5, 0.1, -0.3])
    places = rng.uniform((3, -3, -2.2), (7, 3, -1.8), (120, 3))
    pose = reader().imagined(places, HEAD, origin) + 0.05 * rng.standard_normal((120, 2))
    learned = reader().learned(places, pose, HEAD)
    np.testing.assert_allclose(learned.origin, origin, atol=0.3)
    np.testing.assert_allclose(np.sqrt(np.diag(learned.covariance)), 0.05, rtol=0.25)
    with pytest.raises(ImitationError, match="12 are needed"):
        reader().learned(places[:5], pose[:5], HEAD)


def test_preferences_are_counts_over_salience() -> None:
    likes = Preferences(strength=4.0)
    salience = np.array([3.0, 1.0])
    np.testing.assert_allclose(likes.prior(("a", "b"), salience), [0.75, 0.25])
    for _ in range(20):
        likes.observe(("a", "b"), np.array([0.2, 0.8]))
    np.testing.assert_allclose(likes.prior(("a", "b"), salience), [(4 + 3) / 24, (16 + 1) / 24])
    np.testing.assert_allclose(likes.prior(("b", "c"), salience), [(16 + 3) / 20, 1 / 20])  # nothing is known of c


def test_lore_of_covered_eyes_comes_from_own_eyes_alone() -> None:
    lore = EyeLore()
    with pytest.raises(ImitationError, match="never looked"):
        lore.sees(True)
    lore.experience(covered=False, saw=True, times=100)
    assert lore.sees(False)[0] == pytest.approx((100 + 100.5 / 101) / 101)  # by hand
    naive, tried = lore.sees(True)
    assert naive == pytest.approx(100.5 / 101)
    assert naive > 0.95 and not tried  # whoever never had covered eyes takes them for eyes
    lore.experience(covered=True, saw=False, times=12)
    opaque, tried = lore.sees(True)
    assert opaque < 0.15 and tried
    lore.experience(covered=True, saw=True, times=12)
    assert opaque + 0.2 < lore.sees(True)[0] < 0.7
    assert lore.sees(False)[0] > 0.95
