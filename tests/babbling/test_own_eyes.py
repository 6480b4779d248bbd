"""Places by one's own two eyes: the law is met exactly by any pinholes on any chain of hinges, seen without noise."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from babbling.body_image import PartImage
from babbling.errors import BabblingError
from babbling.own_eyes import OwnEyes, learn_own_eyes

RNG = np.random.default_rng(0)
AXES = RNG.standard_normal((3, 3))
AXES /= np.linalg.norm(AXES, axis=1, keepdims=True)
LIMBS = RNG.normal(0, 0.1, (3, 3))
JOINTS = np.array([0, 2, 3])
HEAD = PartImage(JOINTS, np.array([0.3, -0.2, 0.1]), np.zeros((27, 3)), 0.0)


def shown(places: np.ndarray, postures: np.ndarray, apart: float = 0.05, zoom: float = 1.0, off: float = 0.0):
    """(2, N, K, 2) what two pinholes at the end of three hinges see of (N, K, 3)."""
    seen = places
    for axis, limb, joint in zip(AXES, LIMBS, JOINTS, strict=True):
        turn = Rotation.from_rotvec(axis * postures[:, joint, None])
        seen = np.stack([turn.inv().apply(seen[:, k]) for k in range(seen.shape[1])], 1) - limb
    ahead = seen[..., 2]
    both = [np.stack([(seen[..., 0] - side * apart) / ahead, seen[..., 1] / ahead], -1) for side in (-0.5, 0.5)]
    return zoom * np.array(both) + off


def scene(count: int, things: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """(N, F) postures and (N, K, 3) places, before the eyes more or less whatever they do."""
    postures = RNG.uniform(-0.4, 0.4, (count, 5))
    return postures, RNG.uniform(-0.1, 0.1, (count, things, 3)) + np.array([0, 0, 0.5])


def learned(zoom: float = 1.0, off: float = 0.0, count: int = 600) -> OwnEyes:
    postures, hands = scene(count)
    return learn_own_eyes(shown(hands, postures, zoom=zoom, off=off), postures, hands, HEAD, "x")


@pytest.mark.parametrize(("zoom", "off"), [(1.0, 0.0), (1.4, -0.3)], ids=["focal lengths", "any unit from anywhere"])
def test_the_law_is_exact_for_pinholes_on_hinges(zoom: float, off: float) -> None:
    eyes, (postures, things) = learned(zoom, off), scene(50, 3)
    found = eyes.locate(shown(things, postures, zoom=zoom, off=off), postures)
    np.testing.assert_allclose(found, things, atol=1e-5)
    assert eyes.noise < 1e-5


def test_other_eyes_are_not_met() -> None:
    postures, things = scene(50)
    found = learned().locate(shown(things, postures, apart=0.06), postures)
    assert np.linalg.norm(found - things, axis=-1).min() > 0.01


def test_what_is_hidden_from_one_eye_or_beyond_sight_has_no_place() -> None:
    eyes, (postures, things) = learned(), scene(3)
    seen = shown(things, postures)
    seen[1, 0, 1] = np.nan
    seen[1, 1, 0] = seen[0, 1, 0]
    nowhere = np.isnan(eyes.locate(seen, postures))
    expected = np.zeros((3, 2, 3), bool)
    expected[0, 1] = expected[1, 0] = True
    np.testing.assert_array_equal(nowhere, expected)


def test_half_hidden_hands_do_not_spoil_the_law() -> None:
    postures, hands = scene(900)
    seen = shown(hands, postures)
    seen[:, ::20] += 0.05 * RNG.standard_normal(seen[:, ::20].shape)
    eyes, (others, things) = learn_own_eyes(seen, postures, hands, HEAD, "x"), scene(50)
    assert np.median(np.linalg.norm(eyes.locate(shown(things, others), others) - things, axis=-1)) < 1e-3


def test_too_few_sights_are_refused() -> None:
    with pytest.raises(BabblingError, match="seen 200 times; 216 at least"):
        learned(count=100)


def test_nothing_is_believed_in_postures_in_which_hands_were_never_watched() -> None:
    eyes, (postures, things) = learned(), scene(4)
    postures[1, JOINTS[1]], postures[2, 1] = 0.5, 2.0  # one moves the eyes, one does not
    found = eyes.locate(shown(things, postures), postures)
    np.testing.assert_array_equal(np.isnan(found).all((1, 2)), [False, True, False, False])
