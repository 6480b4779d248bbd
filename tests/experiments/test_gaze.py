"""Gaze following: geometry, Eq. (2) against brute force, learned lore about eyes, refusals."""

import numpy as np
import pytest
from scipy.stats import binom

from babbling.errors import BabblingError
from experiments.errors import ExperimentError
from experiments.gaze.covered import own_experience
from experiments.gaze.run import Config, run
from experiments.gaze.trials import Scene
from experiments.shared.judging import calibration_error, interval_95
from imitation.errors import ImitationError
from imitation.gaze.reader import ANYWHERE, LAPSE, EyeLore, GazeReader, Geometry, Preferences, facing
from models.biclops.cloth import through_cloth
from models.biclops.gaze import lay_out, look_at, possible, separation
from models.errors import BodyError
from models.heads import stage
from models.onlooker import onlook


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


def test_places_appear_where_they_are_located() -> None:
    geometry = Geometry(138.6)
    np.testing.assert_allclose(geometry.locate(geometry.appear(PLACES, 0.14), 0.14), PLACES, atol=1e-9)
    assert geometry.appear(np.array([5.0, 0.0, 0.0]), 0.0)[0] == pytest.approx(138.6 * 0.5 / 5.0)


def test_the_other_sees_our_left_on_its_right() -> None:
    np.testing.assert_allclose(facing(np.array([4.0, 1.0, -2.0]), HEAD), [6.0, -1.0, -2.0])


def test_equation_two_agrees_with_bayes_by_hand() -> None:
    gaze, prior, pose = reader(), np.array([0.2, 0.5, 0.3]), np.array([-0.3, 0.35])
    expected = gaze.imagined(PLACES, np.tile(HEAD, (3, 1)))
    density = np.exp(-0.5 * ((pose - expected) ** 2).sum(1) / 0.05**2) / (2 * np.pi * 0.05**2)
    by_hand = ((1 - LAPSE) * density + LAPSE * ANYWHERE) * prior
    np.testing.assert_allclose(gaze.read(pose, PLACES, HEAD, prior).probability, by_hand / by_hand.sum(), rtol=1e-9)


def test_who_cannot_see_tells_nothing_and_a_resting_head_hardly_anything() -> None:
    gaze, prior = reader(), np.array([0.2, 0.5, 0.3])
    np.testing.assert_allclose(gaze.read(np.array([-0.3, 0.35]), PLACES, HEAD, prior, sees=0.0).probability, prior)
    np.testing.assert_allclose(gaze.read(np.zeros(2), PLACES, HEAD, prior).probability, prior, atol=0.02)


def test_where_gaze_comes_from_and_how_surely_is_learned_from_shown_goals() -> None:
    from imitation.gaze.reader import Shown

    rng = np.random.default_rng(1)
    origin = np.array([-0.5, 0.1, -0.3])
    places = rng.uniform((3, -3, -2.2), (7, 3, -1.8), (120, 3))
    pose = reader().imagined(places, HEAD, origin) + 0.05 * rng.standard_normal((120, 2))
    learned = reader().learned(Shown(places, np.tile(HEAD, (120, 1)), pose))
    np.testing.assert_allclose(learned.origin, origin, atol=0.3)
    np.testing.assert_allclose(np.sqrt(np.diag(learned.covariance)), 0.05, rtol=0.25)
    with pytest.raises(ImitationError, match="12 are needed"):
        reader().learned(Shown(places[:5], np.tile(HEAD, (5, 1)), pose[:5]))


def test_preferences_are_counts_over_salience() -> None:
    likes = Preferences(strength=4.0)
    salience = np.array([3.0, 1.0])
    np.testing.assert_allclose(likes.prior(("a", "b"), salience), [0.75, 0.25])
    for _ in range(20):
        likes.observe(("a", "b"), np.array([0.2, 0.8]))
    np.testing.assert_allclose(likes.prior(("a", "b"), salience), [(4 + 3) / 24, (16 + 1) / 24])


def test_lore_of_covered_eyes_comes_from_own_eyes_alone() -> None:
    lore = EyeLore()
    with pytest.raises(ImitationError, match="never looked"):
        lore.sees(True)
    lore.experience(covered=False, saw=True, times=100)
    naive, tried = lore.sees(True)
    assert naive > 0.95 and not tried  # whoever never had covered eyes takes them for eyes
    lore.experience(covered=True, saw=False, times=12)
    opaque, tried = lore.sees(True)
    assert opaque < 0.15 and tried
    lore.experience(covered=True, saw=True, times=12)
    assert opaque + 0.2 < lore.sees(True)[0] < 0.7
    assert lore.sees(False)[0] > 0.95


def test_whether_a_cloth_lets_one_see_is_seen() -> None:
    rng = np.random.default_rng(0)
    image = np.full((60, 80, 3), 150, np.uint8)
    for column, rgb in ((20, (255, 115, 0)), (60, (0, 230, 230))):
        image[25:35, column - 5 : column + 5] = rgb
    belief = {}
    for kind in ("opaque", "see_through"):
        lore = EyeLore()
        own_experience(lore, None, [image], 0.02, rng)
        own_experience(lore, kind, [image], 0.02, rng)
        belief[kind] = lore.sees(True)[0]
    assert belief["opaque"] < 0.15 and belief["see_through"] > 0.85
    with pytest.raises(BodyError, match="unknown cloth 'silk'"):
        through_cloth(image, "silk", 0.0, rng)


def test_calibration_error_of_known_tables() -> None:
    rng = np.random.default_rng(3)
    sure = rng.uniform(0.3, 1.0, 20_000)
    assert calibration_error(sure, rng.random(20_000) < sure)[0] < 0.02
    error, bins = calibration_error(np.full(100, 0.95), np.arange(100) < 50)
    assert error == pytest.approx(0.45)
    assert bins[:, 2].sum() == 100


@pytest.mark.parametrize(("hits", "count"), [(0, 7), (3, 20), (20, 20)])
def test_an_exact_interval_leaves_a_fortieth_on_either_side(hits: int, count: int) -> None:
    low, high = interval_95(hits, count)
    assert low == 0.0 if hits == 0 else binom.sf(hits - 1, count, low) == pytest.approx(0.025)
    assert high == 1.0 if hits == count else binom.cdf(hits, count, high) == pytest.approx(0.025)


def test_a_teacher_that_looks_at_a_toy_has_it_in_the_middle_of_its_view() -> None:
    model = stage("biclops", teacher=True, distance=0.95).compile()
    targets = np.array([[0.4, 0.2, 0.022], [0.6, -0.15, 0.022]])
    seen = onlook(model, "biclops", np.zeros((2, 2)), look_at(targets, 0.95), {})
    assert seen.teacher_gaze is not None
    start, way = seen.teacher_gaze
    off = np.linalg.norm(np.cross(targets - start, way), axis=-1)
    np.testing.assert_allclose(off, 0.0, atol=1e-6)


def test_toys_lie_as_far_apart_as_asked_and_in_view() -> None:
    view = Scene(Config(), 0.95, 3.0).view()
    rng = np.random.default_rng(0)
    four = lay_out(rng, 4, 0.95, view, (15.0, 180.0))
    first, second = np.triu_indices(4, 1)
    assert np.rad2deg(separation(four[first], four[second], 0.95)).min() >= 15.0
    pair = lay_out(rng, 2, 0.95, view, (5.7, 6.3))
    assert np.rad2deg(separation(pair[0], pair[1], 0.95)) == pytest.approx(6.0, abs=0.3)
    assert not possible(np.array([[0.2, 0.6, 0.022]]), 0.95, view, (0.0, 180.0))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"objects": "0.5,0.1;0.5,0.9"}, "object 2 at 0.5,0.9 m is outside every direction"),
        ({"objects": "here"}, "give x,y;x,y in metres"),
        ({"objects": "0.5,0.1"}, "2 to 4 are possible"),
        ({"objects": "0.5,0.1;0.5,-0.1", "target": 3}, "there are 2 objects"),
        ({"aim_deg": 0.0}, "at most 20 degrees"),
        ({"distance": 3.0}, "between 0.7 and 1.2 m"),
        ({"width": 0}, "a retina width of 0 pixels"),
        ({"robot": "maze"}, "unknown robot with eyes 'maze'"),
    ],
)
def test_options_that_cannot_be_meant_are_refused_in_one_line(options: dict[str, object], text: str) -> None:
    with pytest.raises((ExperimentError, BabblingError, BodyError), match=text) as caught:
        run(Config(**options))  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
