"""Whose part is that? Shuffled parts are recognised by one's own body image, as brute force over assignments says."""

from dataclasses import replace
from functools import cache
from itertools import permutations

import numpy as np
import pytest

from babbling.body_image import Image
from imitation.correspondence import likeness
from imitation.correspondence.likeness import recognised
from imitation.errors import ImitationError
from tests.babbling.creature import PARTS, directions
from tests.imitation.test_correspondence import image

TOUCHING = np.zeros((5, 5), bool)
TOUCHING[[1, 2, 3, 4], [2, 1, 4, 3]] = True
"""Upper arms and forearms; the trunk is not seen to touch them."""


@cache
def lopsided() -> Image:
    """Arms that go to their own side alone."""
    return replace(image(), low=np.array([-0.6, 0.2, 0.2, -1.5, -1.5]), high=np.array([0.6, 1.5, 1.5, -0.2, -0.2]))


def shown(seed: int, frames: int = 200) -> np.ndarray:
    """(T, 5, 3) what a creature with such arms shows."""
    rng = np.random.default_rng(seed)
    time = np.arange(frames)[:, None] * 0.02
    wave = (1 + np.sin(2 * np.pi * rng.uniform(0.2, 0.7, 5) * time + rng.uniform(0, 6, 5))) / 2
    return directions(lopsided().low + wave * (lopsided().high - lopsided().low))


def guess(seen: np.ndarray, touching: np.ndarray | None = None, seed: int = 0) -> dict[int, int]:
    return recognised(lopsided(), seen, 0.02, np.random.default_rng(seed), touching)


@pytest.mark.parametrize("seed", range(4))
def test_shuffled_parts_are_recognised_and_names_play_no_part(seed: int) -> None:
    order = np.random.default_rng(seed).permutation(len(PARTS))
    seen, touching = shown(seed)[:, order], TOUCHING[np.ix_(order, order)]
    found = guess(seen, touching)
    assert [order[found[part]] for part in range(len(PARTS))] == [0, 1, 2, 3, 4]


def test_as_brute_force_over_all_assignments() -> None:
    """On one look: the product over limbs of the mean over imagined postures of von Mises-Fisher densities."""
    seen, own, rng = shown(5, 1), lopsided(), np.random.default_rng(3)
    far = rng.uniform(own.low, own.high, (likeness.IMAGINED, 5))
    at = own.expected(own.rest + rng.random((likeness.IMAGINED, 1)) * (far - own.rest))
    kappa = likeness.COARSE**-2

    def value(order: tuple[int, ...]) -> float:
        total = 0.0
        for limb in ((0,), (1, 2), (3, 4)):
            dense = np.ones(likeness.IMAGINED)
            for part in limb:
                dense *= kappa / (2 * np.pi) * np.exp(kappa * (at[:, part] @ seen[0, order[part]] - 1))
            share = likeness.FORGIVING
            total += np.log((1 - share) * dense.mean() + share * (4 * np.pi) ** -len(limb))
        return total

    best = max(permutations(range(5)), key=value)
    assert guess(seen, seed=3) == dict(enumerate(best))
    held = [one for one in permutations(range(5)) if TOUCHING[one[1], one[2]] and TOUCHING[one[3], one[4]]]
    assert guess(seen, TOUCHING, seed=3) == dict(enumerate(max(held, key=value)))


def test_what_touches_stays_together_however_strange_the_movement() -> None:
    strange = np.random.default_rng(1).standard_normal((20, 5, 3))
    found = guess(strange / np.linalg.norm(strange, axis=-1, keepdims=True), TOUCHING)
    assert sorted(found.values()) == [0, 1, 2, 3, 4]
    assert TOUCHING[found[1], found[2]] and TOUCHING[found[3], found[4]] and found[0] == 0


def test_of_somebody_with_one_arm_that_arm_is_found() -> None:
    here = [4, 3]  # the right forearm, then its upper arm
    assert guess(shown(2)[:, here], TOUCHING[np.ix_(here, here)]) == {3: 1, 4: 0}


def test_a_part_that_is_never_seen_goes_where_nothing_else_fits() -> None:
    seen = shown(3)
    seen[:, 2] = np.nan
    assert guess(seen, TOUCHING) == dict(enumerate(range(5)))


@pytest.mark.parametrize("count", [6, 5])
def test_parts_that_are_not_like_ones_own(count: int) -> None:
    seen, touching = np.repeat(shown(0, 3)[:, :1], count, 1), np.ones((count, count), bool)
    with pytest.raises(ImitationError, match=f"^{count} parts are seen that do not hang together as one's own"):
        guess(seen, touching)
