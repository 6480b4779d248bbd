"""What is told of an image: one place for each colour, or none where that would be a guess."""

import numpy as np
import pytest

from imitation.seeing.features import COLOURS, Feature
from imitation.seeing.finding import EVEN_SHARE, Finder, alone, candidates

LABELS = ("red", "blue", "cyan", "lime")


def thing(label: str, area: float, whole: bool = True, u: float = 10.0) -> Feature:
    return Feature(label, u, 20.0, area, whole)


def test_candidates_are_listed_by_colour_and_size_and_what_is_cut_has_no_place() -> None:
    features = (thing("red", 30, False), thing("red", 8), thing("blue", 9), thing("blue", 7), thing("blue", 5))
    found = candidates(features, LABELS, 2)
    assert found.shape == (4, 2, 3)
    np.testing.assert_array_equal(found[0], [[np.nan, np.nan, 30], [10, 20, 8]])
    np.testing.assert_array_equal(found[1, :, 2], [9, 7])  # the smallest of three finds no room
    assert np.isnan(found[2:]).all()


@pytest.mark.parametrize(
    ("things", "told"),
    [
        ([], False),
        ([thing("red", 30)], True),
        ([thing("red", 30, False)], False),
        ([thing("red", 30), thing("red", EVEN_SHARE * 30)], False),
        ([thing("red", 30), thing("red", EVEN_SHARE * 30 - 0.1)], True),  # a speck beside it
        ([thing("red", 30), thing("red", 20, False)], False),  # a second one, though it is cut
        ([thing("red", 30, False), thing("red", 5)], False),  # a speck beside one that is cut is no thing
        ([thing("blue", 30)], False),
    ],
)
def test_several_none_or_a_cut_thing_have_no_place(things: list[Feature], told: bool) -> None:
    found = alone(candidates(things, ("red",)))
    assert np.isfinite(found).all() == told and np.isfinite(found).any() == told
    if told:
        np.testing.assert_array_equal(found[0], [10, 20, 30])


def drawn(squares: list[tuple[str, int, int, int]]) -> np.ndarray:
    image = np.full((60, 80, 3), 130, np.uint8)
    for label, u, v, side in squares:
        image[v : v + side, u : u + side] = 255 * np.array(COLOURS[label])
    return image


@pytest.mark.parametrize("areas", [False, True])
def test_images_to_numbers(areas: bool) -> None:
    image = drawn([("red", 10, 20, 7), ("blue", 30, 5, 5), ("blue", 50, 40, 5), ("cyan", 75, 30, 5)])
    found = Finder(LABELS, areas=areas)(image)
    np.testing.assert_allclose(found[0], [13, 23, 49][: found.shape[1]], atol=0.2)
    assert np.isnan(found[1:]).all()  # two blue ones, a cyan one at the border, nothing lime
    np.testing.assert_array_equal(
        found[[3, 0]], Finder(("lime", "red"), areas=areas)(image)
    )  # rows are in the labels' order


def test_specks_under_the_least_area_are_nothing() -> None:
    image = drawn([("red", 10, 20, 7), ("red", 40, 20, 5)])
    assert np.isnan(Finder(("red",))(image)).all()
    np.testing.assert_allclose(Finder(("red",), least_area=30.0)(image), [[13, 23]], atol=0.2)
