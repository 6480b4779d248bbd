"""Reaching: parts come where they should, inside the ranges; what cannot be reached is told; the rest is left alone."""

import numpy as np
import pytest

from imitation.acting.reaching import MARGIN, STIFF, places, reach
from tests.imitation.arms import FORE, HIGH, JOINTS, LOW, MIRROR, REST, SHOULDER, UPPER, image, where

EXACT = image()


def postures(seed: int, count: int = 60) -> np.ndarray:
    return np.random.default_rng(seed).uniform(LOW + 2 * MARGIN, HIGH - 2 * MARGIN, (count, len(LOW)))


def resting(count: int) -> np.ndarray:
    return np.tile(REST, (count, 1))


def test_the_image_is_the_closed_form() -> None:
    angles = postures(0, 200)
    np.testing.assert_allclose(places(EXACT, angles), where(angles), atol=1e-12)


def worth(reached: np.ndarray) -> np.ndarray:
    """(N,) m^2 that comfort may cost: what is found is no worse than the posture that meets the target exactly."""
    return STIFF * ((reached - EXACT.rest) ** 2).sum(1) + 1e-9


def test_what_can_be_reached_is_met_but_for_what_comfort_is_worth() -> None:
    meant = postures(1)
    found, miss = reach(EXACT, where(meant), resting(60))
    away = ((where(found) - where(meant)) ** 2).sum((-1, -2))
    assert (away + worth(found) <= worth(meant) + 1e-8).all()
    assert miss.max() < 0.01 and np.median(miss) < 2e-3
    assert (found >= LOW + MARGIN - 1e-12).all() and (found <= HIGH - MARGIN + 1e-12).all()


def test_the_miss_is_the_true_one_of_the_worst_part() -> None:
    """A target beyond a stretched arm, and one within the reach of no lean: as far as geometry says, at least."""
    wanted = where(postures(2))
    far = np.arange(60) % 3
    wanted[far == 0, 0] = (0.6, 0.3, 0.1)
    wanted[far == 1, 2] = (0.2, 0.2, 0.0)
    found, miss = reach(EXACT, wanted, resting(60))
    true = np.linalg.norm(where(found) - wanted, axis=-1)
    np.testing.assert_allclose(miss, true.max(1), atol=1e-9)
    away = np.linalg.norm((0.6, 0.3, 0.1) - SHOULDER)
    assert (miss[far == 0] >= away - UPPER - FORE).all()
    np.testing.assert_allclose(miss[far == 0], away - UPPER - FORE, atol=2e-3)  # it stretches there, but for its stop
    assert (miss[far == 1] >= 0.2).all() and (miss[far == 2] < 0.01).all()
    assert true[far == 0, 1:].max() < 0.01, "the others go on, if to coarser steps: what is left is judged by the whole"
    assert (found >= LOW + MARGIN - 1e-12).all() and (found <= HIGH - MARGIN + 1e-12).all()


@pytest.mark.parametrize("part", range(3), ids=JOINTS)
def test_a_part_without_a_target_is_left_alone(part: int) -> None:
    wanted, base = where(postures(3)), postures(4)
    wanted[:, part] = np.nan
    wanted[0] = np.nan
    found, miss = reach(EXACT, wanted, base)
    own = list(JOINTS.values())[part]
    np.testing.assert_array_equal(found[:, own], base[:, own])
    np.testing.assert_array_equal(found[0], base[0])
    assert miss[0] == 0 and miss.max() < 0.01
    others = [one for one in range(3) if one != part]
    assert np.linalg.norm(where(found)[1:, others] - wanted[1:, others], axis=-1).max() < 0.01


def test_everyone_reaches_as_if_alone() -> None:
    wanted, base = where(postures(5, 6)), postures(6, 6)
    wanted[::2, 0] = np.nan
    together, miss = reach(EXACT, wanted, base)
    for copy in range(6):
        alone, missed = reach(EXACT, wanted[[copy]], base[[copy]])
        np.testing.assert_allclose(alone[0], together[copy], atol=1e-9)
        assert missed[0] == pytest.approx(miss[copy], abs=1e-9)
    kept = base.copy()
    reach(EXACT, wanted, base)
    np.testing.assert_array_equal(base, kept)


def test_a_mirrored_target_is_reached_by_the_mirrored_posture() -> None:
    """Both arms are free to choose between ways to bend; from rest each takes the one that is nearer to comfort."""
    wanted = where(REST + 0.3 * np.random.default_rng(7).uniform(-1, 1, (40, len(REST))))
    other = wanted[:, [1, 0, 2]] * MIRROR
    one, two = (reach(EXACT, target, resting(40))[0] for target in (wanted, other))
    mirrored = two[:, [3, 4, 5, 0, 1, 2, 6]] * (-1, 1, 1, -1, 1, 1, 1)
    np.testing.assert_allclose(one, mirrored, atol=1e-3)
