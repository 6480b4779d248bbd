"""Like me or not: by a body image of a made-up body, whose places are known exactly."""

import numpy as np
import pytest

from babbling.body_image import Image, PartImage
from imitation.seeing.somebody import MISSING_MINE, MISSING_THING, TEMPER, like_me, residuals

RNG = np.random.default_rng(0)
TRUNK, ARM = 0.2, 0.15


def made_up() -> Image:
    """Two arms, each of one joint about the upright, and a head that does not move: exact harmonics of what they do."""
    images = {}
    for n, side in enumerate((1.0, -1.0)):
        weights = np.array([[ARM, side * TRUNK, 0.0], [0.0, ARM, 0.0], [-ARM, 0.0, 0.0]])
        images[f"hand{n}"] = PartImage(np.array([n]), np.zeros(1), weights, 0.003)
    still = np.array([[0.0, 0.0, 0.25], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    images["head"] = PartImage(np.array([0]), np.zeros(1), still, 0.003)
    low, high = np.full(2, -1.5), np.full(2, 1.5)
    library = RNG.uniform(-1.2, 1.2, (40, 2))
    return Image(images, low, high, np.zeros(2), library, np.full((40, 3), 1e-5))


IMAGE = made_up()


def moving(looks: int = 8) -> np.ndarray:
    """(L, 3, 3) where its parts are while both arms swing."""
    angles = np.stack([np.linspace(-1, 1, looks), np.linspace(0.8, -0.5, looks)], 1)
    return np.stack([part.expected(angles) for part in IMAGE.images.values()], 1)


def elsewhere(places: np.ndarray, size: float, yaw: float) -> np.ndarray:
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1.0]])
    return size * places @ turn.T + np.array([0.8, -0.2, 0.1])


@pytest.mark.parametrize("size", [0.6, 1.0, 1.7])
@pytest.mark.parametrize("yaw", [0.0, 1.2, np.pi])
def test_a_body_like_mine_is_met_wherever_it_stands_and_of_any_size(size: float, yaw: float) -> None:
    missed = residuals(IMAGE, elsewhere(moving(), size, yaw))
    assert np.median(missed) < 0.006 and like_me(missed) > 2


def test_the_less_like_mine_the_less_it_is_believed() -> None:
    places = moving()
    stretched = []
    for by in (1.0, 1.5, 2.0, 3.0):
        other = places.copy()
        for hand, side in ((0, 1.0), (1, -1.0)):
            shoulder = np.array([0.0, side * TRUNK, 0.0])
            other[:, hand] = shoulder + by * (places[:, hand] - shoulder)
        stretched.append(like_me(residuals(IMAGE, elsewhere(other, 1.0, np.pi))))
    assert stretched == sorted(stretched, reverse=True) and stretched[0] > stretched[-1] + 1


def test_parts_that_are_missing_count_against_it_and_one_part_alone_says_nothing_else() -> None:
    places = elsewhere(moving(), 1.0, 0.0)
    headless, hand = places.copy(), places.copy()
    headless[:, 2] = np.nan
    hand[:, 1:] = np.nan
    whole, less, least = (like_me(residuals(IMAGE, seen)) for seen in (places, headless, hand))
    assert whole > less > least
    assert least == pytest.approx(2 * TEMPER * np.log(MISSING_MINE / MISSING_THING))


def test_how_often_one_looks_is_no_evidence() -> None:
    few, many = (like_me(residuals(IMAGE, elsewhere(moving(looks), 1.0, 0.3))) for looks in (8, 32))
    assert few == pytest.approx(many, abs=0.6)
