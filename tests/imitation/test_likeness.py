"""Whose part is that? Shuffled parts are recognised by one's own body image, as brute force over assignments says."""

from dataclasses import replace
from functools import cache
from itertools import permutations

import numpy as np
import pytest

from babbling.body_image import Image
from experiments.shared.oracle import known_image
from imitation.correspondence import likeness
from imitation.correspondence.likeness import recognised
from imitation.errors import ImitationError
from models.teachers.performance import PARTS as PERSON
from models.teachers.performance import touching
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


def guess(seen: np.ndarray, hang: np.ndarray | None = None, seed: int = 0) -> dict[int, int]:
    return recognised(lopsided(), seen, 0.02, np.random.default_rng(seed), hang)


@pytest.mark.parametrize("seed", range(4))
def test_shuffled_parts_are_recognised_and_names_play_no_part(seed: int) -> None:
    order = np.random.default_rng(seed).permutation(len(PARTS))
    found = guess(shown(seed)[:, order], TOUCHING[np.ix_(order, order)])
    assert [order[found[part]] for part in range(len(PARTS))] == [0, 1, 2, 3, 4]


def strange(seed: int, parts: int = 5, frames: int = 30) -> np.ndarray:
    """(T, P, 3) directions that nobody shows, the odd seeds' all about forward."""
    ways = np.random.default_rng(seed).standard_normal((frames, parts, 3)) + np.array([3 * (seed % 2), 0, 0])
    return ways / np.linalg.norm(ways, axis=-1, keepdims=True)


@pytest.mark.parametrize("seed", range(6))
def test_as_brute_force_over_all_assignments(seed: int) -> None:
    """The product over looks and limbs of the mean over imagined postures of von Mises-Fisher densities."""
    seen, own, rng = strange(seed), lopsided(), np.random.default_rng(seed)
    far = rng.uniform(own.low, own.high, (likeness.IMAGINED, 5))
    at = own.expected(own.rest + rng.random((likeness.IMAGINED, 1)) * (far - own.rest))
    kappa, share = likeness.COARSE**-2, likeness.FORGIVING

    def value(order: tuple[int, ...]) -> float:
        total = 0.0
        for look in seen[::12]:  # every quarter of a second
            for limb in ((0,), (1, 2), (3, 4)):
                dense = np.ones(likeness.IMAGINED)
                for part in limb:
                    dense *= kappa / (2 * np.pi) * np.exp(kappa * (at[:, part] @ look[order[part]] - 1))
                total += np.log((1 - share) * dense.mean() + share * (4 * np.pi) ** -len(limb))
        return total

    every = [*permutations(range(5))]
    held = [one for one in every if TOUCHING[one[1], one[2]] and TOUCHING[one[3], one[4]]]
    for ways, hang in ((every, None), (held, TOUCHING)):
        found = guess(seen, hang, seed)
        chosen = found[0], found[1], found[2], found[3], found[4]
        assert chosen in ways and value(chosen) == pytest.approx(max(map(value, ways)), abs=1e-4)  # of nearly even ones


@pytest.mark.parametrize("seed", range(4))
def test_what_touches_stays_together_in_its_order_however_strange_the_movement(seed: int) -> None:
    own, order = known_image(), np.random.default_rng(seed).permutation(12)
    seen, hang = strange(seed, 12), touching([PERSON[number] for number in order])
    found = recognised(own, seen, 0.02, np.random.default_rng(0), hang)
    theirs = {own.parts[part]: PERSON[order[number]] for part, number in found.items()}
    assert len({*theirs.values()}) == 12
    for side in ("left", "right"):
        assert theirs[f"{side}_shank"].endswith("shank"), "what lies between two stays between them"
        for inner, outer in (("upper_arm", "forearm"), ("thigh", "shank"), ("shank", "foot")):
            assert touching([theirs[f"{side}_{inner}"], theirs[f"{side}_{outer}"]]).any()


def test_of_somebody_with_one_arm_that_arm_is_found() -> None:
    here = [4, 3]  # the right forearm, then its upper arm
    assert guess(shown(2)[:, here], TOUCHING[np.ix_(here, here)]) == {3: 1, 4: 0}


def test_a_part_that_is_never_seen_goes_where_nothing_else_fits() -> None:
    order = [4, 2, 0, 1, 3]
    seen = shown(3)
    seen[:, 2] = np.nan
    found = guess(seen[:, order], TOUCHING[np.ix_(order, order)])
    assert [order[found[part]] for part in range(5)] == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("count", [6, 5])
def test_parts_that_are_not_like_ones_own(count: int) -> None:
    seen, every = np.repeat(shown(0, 3)[:, :1], count, 1), np.ones((count, count), bool)
    with pytest.raises(ImitationError, match=f"^{count} parts are seen that do not hang together as one's own"):
        guess(seen, every)
