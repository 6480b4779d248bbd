"""Places from two parallel pinholes, and what becomes of looks at which something is hidden."""

import numpy as np
import pytest

from imitation.errors import ImitationError
from imitation.seeing.marks import bridged, located

RNG = np.random.default_rng(0)


def test_two_parallel_pinholes_tell_places_exactly() -> None:
    places, apart = RNG.uniform(-0.3, 0.3, (7, 5, 3)) + np.array([1.0, 0, 0]), 0.06
    eyes = [places - np.array([0, side * apart, 0]) for side in (0.5, -0.5)]  # the left one stands to the left
    seen = np.array([-eye[..., 1:] / eye[..., :1] for eye in eyes])
    np.testing.assert_allclose(located(seen, apart), places, atol=1e-9)


def test_hidden_from_one_eye_is_nowhere() -> None:
    seen = np.array([[[0.1, 0.0], [0.1, 0.0], [0.1, 0.1]], [[0.0, 0.0], [np.nan, np.nan], [0.0, 0.0]]])
    np.testing.assert_array_equal(np.isnan(located(seen, 0.05)).any(-1), [False, True, True])
    with pytest.raises(ImitationError, match="1 eye"):
        located(seen[:1], 0.05)


def test_short_gaps_are_straight_ends_are_held_and_long_gaps_stay() -> None:
    track = np.arange(10.0)[:, None, None] * np.ones((1, 3, 2))
    track[[0, 4, 9], 0] = np.nan
    track[2:8, 1] = np.nan
    track[:, 2] = np.nan
    filled = bridged(track, gap=2)
    np.testing.assert_allclose(filled[:, 0, 0], [1, 1, 2, 3, 4, 5, 6, 7, 8, 8])
    assert np.isnan(filled[2:8, 1]).all() and not np.isnan(filled[[0, 1, 8, 9], 1]).any()
    assert np.isnan(filled[:, 2]).all()
