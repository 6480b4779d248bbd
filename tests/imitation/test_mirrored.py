"""What a mirror teaches: a map of one's own face, its errors told without looking at what it learned from."""

import numpy as np
import pytest

from imitation.errors import ImitationError
from imitation.seeing.face_marks import NUMBERS
from imitation.seeing.mirrored import Mirrored, _kernel, features

NEUTRAL = np.tile(np.linspace(0, 60, NUMBERS), (2, 1))
NEUTRAL[:, 0], NEUTRAL[:, 2] = 20.0, -20.0


def looks(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Relations move numbers along lines of their own; the tongue is seen in some."""
    rng = np.random.default_rng(seed)
    felt = rng.uniform(-0.3, 0.3, (count, 8))
    slope = np.random.default_rng(7).normal(0, 20, (8, 2 * NUMBERS))
    seen = NEUTRAL + (felt @ slope).reshape(count, 2, NUMBERS) + rng.normal(0, 0.05, (count, 2, NUMBERS))
    seen[::3, :, 18:] = np.nan
    return seen, felt


def test_one_s_own_face_is_understood() -> None:
    mirror, (seen, felt) = Mirrored.learned(*looks(200, 0), NEUTRAL), looks(20, 1)
    found = [mirror.see(look, NEUTRAL) for look in seen]
    off = np.stack([one.relations for one in found]) - felt
    assert np.sqrt((off**2).mean()) < 0.05 < felt.std() / 3
    told = np.sqrt(np.diag(np.linalg.inv(found[0].information)))
    assert (np.sqrt((off**2).mean(0)) < 3 * told).all() and (told < 0.2).all()
    assert [one.tongue for one in found] == [k % 3 > 0 for k in range(20)]


def test_each_look_s_error_is_as_if_it_had_been_left_out() -> None:
    seen, felt = looks(40, 3)
    mirror = Mirrored.learned(seen, felt, NEUTRAL)
    x = features(seen, NEUTRAL) / mirror.scale
    best = []
    for ridge in (1e-4, 1e-3, 1e-2, 1e-1):
        kernel = _kernel(x, x, mirror.width) + ridge * np.eye(40)
        if np.allclose(np.linalg.solve(kernel, felt - mirror.middle), mirror.weights, rtol=1e-4, atol=1e-8):
            off = []
            for k in range(40):
                rest = np.delete(np.arange(40), k)
                weights = np.linalg.solve(kernel[np.ix_(rest, rest)], (felt - mirror.middle)[rest])
                off.append((felt - mirror.middle)[k] - _kernel(x[k : k + 1], x[rest], mirror.width)[0] @ weights)
            best.append(np.cov(np.array(off).T))
    assert len(best) == 1
    np.testing.assert_allclose(best[0], mirror.covariance, rtol=1e-5, atol=1e-12)


def test_a_face_twice_as_large_looks_the_same() -> None:
    seen, _ = looks(5, 4)
    np.testing.assert_allclose(features(2 * seen, 2 * NEUTRAL), features(seen, NEUTRAL), atol=1e-12)


def test_a_glance_is_too_little() -> None:
    with pytest.raises(ImitationError, match="5 looks into the mirror; at least 20"):
        Mirrored.learned(*looks(5, 0), NEUTRAL)
