"""What a head looks like, as polynomials of its posture: known heads are recovered, whatever is missing or wrong."""

import numpy as np
import pytest

from imitation.errors import ImitationError
from imitation.seeing.pose import Appearance, frame_pose

GROUP = np.arange(6) // 2


def looks(postures: np.ndarray) -> np.ndarray:
    """(N, 6) numbers of a head that turns and nods: polynomials of degree 4, which is what can be learned exactly."""
    pan, tilt = postures[..., 0], postures[..., 1]
    return np.stack(
        [
            80 + 90 * pan, 60 - 70 * tilt, 40 + 30 * pan - 20 * pan**2,
            50 + 10 * pan * tilt + 8 * tilt**3, 30 - 25 * pan**2 * tilt, 20 + 15 * pan**4 - 5 * tilt**2,
        ],
        axis=-1,
    )  # fmt: skip


def steepness(pan: float, tilt: float) -> np.ndarray:
    """(6, 2) derivatives of `looks`."""
    return np.array(
        [
            [90, 0], [0, -70], [30 - 40 * pan, 0],
            [10 * tilt, 10 * pan + 24 * tilt**2], [-50 * pan * tilt, -25 * pan**2], [60 * pan**3, -10 * tilt],
        ]
    )  # fmt: skip


@pytest.fixture
def postures() -> np.ndarray:
    return np.random.default_rng(0).uniform((-0.6, -0.4), (0.6, 0.4), (400, 2))


def test_a_polynomial_head_is_recovered_where_each_number_was_seen(postures: np.ndarray) -> None:
    numbers = looks(postures)
    numbers[np.random.default_rng(1).random(numbers.shape) < 0.5] = np.nan
    found = Appearance.learned(postures, numbers, GROUP)
    grid = np.random.default_rng(2).uniform((-0.6, -0.4), (0.6, 0.4), (50, 2))
    np.testing.assert_allclose(found.expect(grid), looks(grid), atol=1e-4)
    np.testing.assert_array_equal(found.noise, 1e-3)


def test_slopes_are_the_derivatives(postures: np.ndarray) -> None:
    found = Appearance.learned(postures, looks(postures), GROUP)
    for pan, tilt in ((0.0, 0.0), (0.3, -0.2), (-0.5, 0.3)):
        np.testing.assert_allclose(found.slope(np.array([pan, tilt])), steepness(pan, tilt), atol=2e-3)


def test_outliers_change_neither_the_head_nor_its_noise(postures: np.ndarray) -> None:
    rng = np.random.default_rng(3)
    clean = looks(postures) + 0.2 * rng.standard_normal((400, 6))
    wrong = np.where(rng.random(clean.shape) < 0.03, clean + rng.choice([-40, 40], clean.shape), clean)
    one, other = (Appearance.learned(postures, numbers, GROUP) for numbers in (clean, wrong))
    np.testing.assert_allclose(other.noise, one.noise, rtol=0.1)
    assert np.abs(other.expect(postures) - looks(postures)).max() < 0.3
    assert (np.abs(one.noise - 0.2) < 0.03).all()


def test_numbers_hardly_ever_seen_say_nothing(postures: np.ndarray) -> None:
    numbers = looks(postures)
    numbers[40:, 4] = np.nan  # 40 sightings for 15 terms
    found = Appearance.learned(postures, numbers, GROUP)
    assert np.isinf(found.noise).tolist() == [False, False, False, False, True, False]
    assert not found.coefficients[4].any()
    assert frame_pose(found, looks(np.array([0.2, 0.1]))) == pytest.approx([0.2, 0.1], abs=1e-3)
    with pytest.raises(ImitationError, match="too few showed a feature"):
        Appearance.learned(postures[:30], numbers[:30], GROUP)
