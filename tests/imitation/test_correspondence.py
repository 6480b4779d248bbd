"""Correspondence: Eq. (1) turns the body image round, with noise, hidden parts, speed limits; organs are told apart."""

from functools import cache

import numpy as np
import pytest

from babbling.body_image import BodyImage, learn_image
from babbling.mirroring import mirror_babble
from babbling.organs import find_organs
from imitation.correspondence.correspondence import correspond
from imitation.correspondence.limbs import own_limbs
from imitation.correspondence.organ import identify, owners, pattern_likelihood
from imitation.correspondence.steadying import steady
from imitation.correspondence.tries import try_again
from imitation.errors import ImitationError
from tests.babbling.creature import MOVES, PARTS, Creature, directions, motors, schema

SPEED = np.full(5, 5.0)


@cache
def image(noise_deg: float = 0.0, wiring: tuple[int, ...] = (0, 1, 2, 3, 4)) -> BodyImage:
    body = Creature(noise=np.deg2rad(noise_deg), wiring=wiring)
    experience = mirror_babble(body, body, schema(), motors(), 8.0, 0)
    end = np.full(5, 1.5)
    return learn_image(experience, find_organs(experience), -end, end, 0 * end, 0, "creature")


def movement(frames: int = 150, seed: int = 1) -> np.ndarray:
    """(T, 5) slow sines inside the range."""
    rng = np.random.default_rng(seed)
    time = np.arange(frames)[:, None] * 0.02
    return 0.9 * np.sin(2 * np.pi * rng.uniform(0.2, 0.7, 5) * time + rng.uniform(0, 6, 5))


def seen(q: np.ndarray, noise_deg: float = 0.0, seed: int = 2) -> dict[str, np.ndarray]:
    true = directions(q)
    blurred = true + np.deg2rad(noise_deg) * np.random.default_rng(seed).standard_normal(true.shape)
    blurred /= np.linalg.norm(blurred, axis=-1, keepdims=True)
    return {part: blurred[:, number] for number, part in enumerate(PARTS)}


def degrees(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.rad2deg(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=-1) / 2, 0, 1)))


def test_limbs_are_read_off_the_structure() -> None:
    trunk, left, right = own_limbs(MOVES)
    assert (trunk.parts, trunk.factors.tolist()) == ((0,), [0])
    assert (left.parts, left.factors.tolist()) == ((1, 2), [1, 2])
    assert (right.parts, right.factors.tolist()) == ((3, 4), [3, 4])
    assert left.tolerances[0] < left.tolerances[1], "what lies nearer the torso counts more"
    assert owners(MOVES).tolist() == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("wiring", [(0, 1, 2, 3, 4), (3, 0, 4, 1, 2)])
def test_own_movements_come_back(wiring: tuple[int, ...]) -> None:
    q = movement()
    goals = correspond(image(0.0, wiring), "own", seen(q), 0.02, SPEED)
    np.testing.assert_allclose(goals.postures, q[:, wiring], atol=np.deg2rad(0.5))
    assert degrees(image(0.0, wiring).expected(goals.postures), directions(q)).mean() < 0.1


def test_noise_is_found_and_smoothed_away() -> None:
    q = movement()
    goals = correspond(image(3.0), "noisy", seen(q, 3.0), 0.02, SPEED)
    found = directions(goals.postures)
    assert degrees(found, directions(q)).mean() < 2.5
    assert np.rad2deg(goals.noise.mean()) == pytest.approx(3 * np.sqrt(2 / 3), rel=0.15)
    assert np.abs(np.diff(goals.postures, axis=0)).max() <= 5.0 * 0.02 + 1e-9


def test_hidden_part_degrades_and_does_not_jump() -> None:
    q = movement()
    shown, away = seen(q, 3.0), np.zeros(len(q), bool)
    away[60:110] = True
    shown["left_fore"] = np.where(away[:, None], np.nan, shown["left_fore"])
    goals = correspond(image(3.0), "hidden", shown, 0.02, SPEED, {"left_fore": ~away})
    assert np.isfinite(goals.postures).all()
    assert np.abs(np.diff(goals.postures, axis=0)).max() <= 5.0 * 0.02 + 1e-9
    error = degrees(directions(goals.postures), directions(q))
    assert error[:, [0, 1, 3, 4]].mean() < 2.5, "other parts do not mind"
    assert error[~away, 2].mean() < 4


def test_speed_limit_is_kept_where_a_teacher_is_too_fast() -> None:
    q = movement()
    q[75:] = q[75] + 1.0 * (np.arange(5) == 1)
    goals = correspond(image(), "jump", seen(np.clip(q, -1.4, 1.4)), 0.02, np.full(5, 2.0))
    assert np.abs(np.diff(goals.postures, axis=0)).max() <= goals.slowed * 2.0 * 0.02 + 1e-9


def test_out_of_reach_stays_in_range() -> None:
    q = movement() * 2.5
    goals = correspond(image(), "far", seen(q), 0.02, SPEED)
    assert (np.abs(goals.postures) <= 1.5).all()


def test_only_corresponding_parts_are_imitated() -> None:
    q = movement()
    some = {"left_upper": seen(q)["left_upper"], "tail": seen(q)["trunk"]}
    goals = correspond(image(), "some", some, 0.02, SPEED)
    assert goals.parts == ("left_upper",)
    assert (goals.postures[:, 3:] == 0).all(), "what was not seen rests"
    with pytest.raises(ImitationError, match=r"none of the parts seen \(tail\)"):
        correspond(image(), "tail", {"tail": some["tail"]}, 0.02, SPEED)
    with pytest.raises(ImitationError, match="all must have as many"):
        correspond(image(), "uneven", {"trunk": seen(q)["trunk"], "left_upper": seen(q)["left_upper"][:9]}, 0.02, SPEED)


@pytest.mark.parametrize("noise_deg", [0.0, 3.0])
def test_organ_is_identified(noise_deg: float) -> None:
    rng, right = np.random.default_rng(7), 0
    for number in range(60):
        part = number % 5
        start = rng.uniform(-1, 1, 5)
        end = start.copy()
        end[part] += rng.choice([-1, 1]) * rng.uniform(0.4, 1.0)
        way = np.clip((np.arange(50) - 9) / 30, 0, 1)[:, None]
        shown = np.stack(list(seen(start + way * (end - start), noise_deg, number).values()), 1)
        organ = identify(image(noise_deg).organs, shown, 0.02)
        assert organ.probability.sum() == pytest.approx(1)
        right += organ.part == part
    assert right >= 57
    still = np.stack(list(seen(np.zeros((50, 5)), noise_deg).values()), 1)
    assert identify(image(noise_deg).organs, still, 0.02).part == -1


def test_the_part_is_that_of_bayes_with_size_and_noise_integrated_out() -> None:
    """By brute force: offset, size and noise on grids, against the acts' closed form; only proportions matter."""
    amounts = np.array([0.05, 0.4, 0.35, 0.1, 0.0])
    padded = np.append(amounts, 0.0)  # the torso never turns
    sigma = np.exp(np.linspace(-5, 1.5, 40))[:, None, None]
    offset, size = np.linspace(-1.5, 1.5, 201)[:, None], np.linspace(-1.5, 1.5, 201)
    levels = []
    for moves in MOVES.T:
        x = np.append(moves, 0.0)
        spread = sigma * np.sqrt(len(x) / ((x - x.mean()) ** 2).sum())  # the unit-information prior
        rest = ((padded - offset[..., None] - size[:, None] * x) ** 2).sum(-1)
        log = -6 * np.log(sigma) - rest / (2 * sigma**2) - size**2 / (2 * spread**2) - np.log(spread)
        levels.append(np.exp(log).sum())  # d log sigma: the noise's prior is 1 / sigma
    found = pattern_likelihood(amounts, MOVES)
    up = found > found.min() * 1.0001
    np.testing.assert_allclose(found[up] / found[up][0], np.array(levels)[up] / np.array(levels)[up][0], rtol=0.03)
    np.testing.assert_allclose(pattern_likelihood(7 * amounts, MOVES), found)  # size tells nothing


def test_tries_converge_on_the_right_part_alone() -> None:
    wanted = directions(np.array([[0.0, 0.8, 0, 0, 0]]))[0, 1]
    rng = np.random.default_rng(8)
    tried = try_again(image(), 1, wanted, np.zeros(5), lambda q: directions(q[None])[0, 1], 8, rng)
    assert tried.shape == (9, 5) and (tried[:, [0, 2, 3, 4]] == 0).all()
    error = degrees(directions(tried)[:, 1], wanted)
    assert error[0] > 40 and error[-1] < 0.5 and error[-1] < error[1]


def test_steady_seeing() -> None:
    time = np.linspace(0, 3, 200)
    true = np.stack([np.cos(time), np.sin(time), 0 * time], 1)
    everywhere = np.ones(200, bool)
    np.testing.assert_allclose(steady("clean", true, everywhere).directions, true, atol=1e-4)
    noisy = true + 0.05 * np.random.default_rng(9).standard_normal(true.shape)
    calm = steady("noisy", noisy, everywhere)
    assert calm.noise == pytest.approx(0.05, rel=0.15)
    assert np.linalg.norm(calm.directions - true, axis=1).mean() < 0.4 * np.linalg.norm(noisy - true, axis=1).mean()
    still = steady("still", np.tile(true[:1], (50, 1)), np.ones(50, bool))
    np.testing.assert_allclose(still.directions, np.tile(true[:1], (50, 1)), atol=1e-9)
    with pytest.raises(ImitationError, match="seen in 3 frames only"):
        steady("hidden", true, np.arange(200) < 3)


def test_a_direction_that_turned_round_while_it_was_hidden_cannot_be_bridged() -> None:
    seen, visible = np.zeros((41, 3)), np.ones(41, bool)
    seen[:20, 0], seen[20:, 0], visible[10:31] = 1.0, -1.0, False
    with pytest.raises(ImitationError, match="arm: hidden too long, or its direction turned round"):
        steady("arm", seen, visible)
    seen[20:, 0] = 1.0
    np.testing.assert_allclose(steady("arm", seen, visible).directions, seen, atol=1e-6)
