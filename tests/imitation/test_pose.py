"""What a head looks like, as polynomials of its posture: known heads are recovered, whatever is missing or wrong."""

import numpy as np
import pytest

from babbling.kalman import Belief, predict
from imitation.errors import ImitationError
from imitation.seeing.pose import UNKNOWN, Appearance, LiveWatch, frame_pose, watch

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


def known(noise: float = 1.0) -> Appearance:
    """`looks`, learned from so many lessons that only the noise is left."""
    rng = np.random.default_rng(7)
    lessons = rng.uniform((-0.7, -0.5), (0.7, 0.5), (3000, 2))
    return Appearance.learned(lessons, looks(lessons) + noise * rng.standard_normal((3000, 6)), GROUP)


@pytest.mark.parametrize("spread", [0.01, 0.03])
def test_one_look_agrees_with_the_posterior_on_a_grid(spread: float) -> None:
    """p(pan, tilt | z) by brute force; the rates follow by the prior's own regression on the pose."""
    look, rng = known(), np.random.default_rng(1)
    mean, root = np.array([0.2, -0.1, 0.3, 0.1]), rng.standard_normal((4, 4))
    prior = Belief(mean, spread**2 * (root @ root.T / 4 + 0.3 * np.eye(4)))
    numbers = looks(np.array([0.2 + spread, -0.1 - spread])) + rng.standard_normal(6)
    watching = LiveWatch(look, 0.04)
    watching.belief = prior
    found = watching.see(numbers)
    assert watching.used == 6

    axes = [mean[i] + 6 * np.sqrt(prior.covariance[i, i]) * np.linspace(-1, 1, 301) for i in range(2)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 2)
    away = grid - mean[:2]
    log = -0.5 * np.einsum("ni,ij,nj->n", away, np.linalg.inv(prior.covariance[:2, :2]), away)
    log -= 0.5 * (((numbers - look.expect(grid)) / look.noise) ** 2).sum(1)
    weight = np.exp(log - log.max())
    weight /= weight.sum()
    exact = weight @ grid
    cov = np.einsum("n,ni,nj->ij", weight, grid - exact, grid - exact)
    np.testing.assert_allclose(found.mean[:2], exact, atol=0.05 * spread)
    np.testing.assert_allclose(found.covariance[:2, :2], cov, atol=0.03 * spread**2)
    onto = prior.covariance[2:, :2] @ np.linalg.inv(prior.covariance[:2, :2])
    np.testing.assert_allclose(found.mean[2:], mean[2:] + onto @ (exact - mean[:2]), atol=0.1 * spread)


def test_a_lying_feature_is_left_out_with_all_its_numbers() -> None:
    look = known()
    prior = Belief(np.array([0.1, 0.1, 0.0, 0.0]), np.diag([0.02, 0.02, 0.1, 0.1]) ** 2)
    honest = looks(np.array([0.11, 0.09]))
    liar, absent = honest.copy(), honest.copy()
    liar[2] += 30.0  # one number of the second feature; the other is right
    absent[2:4] = np.nan
    beliefs, used = [], []
    for numbers in (liar, absent):
        watching = LiveWatch(look, 0.04)
        watching.belief = prior
        beliefs.append(watching.see(numbers))
        used.append(watching.used)
    assert used == [4, 4]
    for one, other in zip(*beliefs, strict=True):
        np.testing.assert_array_equal(one, other)


def test_what_was_believed_is_carried_on_and_nothing_seen_changes_nothing() -> None:
    look, still = known(4.0), looks(np.zeros(2))
    watching, rng = LiveWatch(look, 0.04, acceleration=0.01), np.random.default_rng(0)
    first = watching.see(still)
    for _ in range(30):
        watching.ahead()
        last = watching.see(still + 4.0 * rng.standard_normal(6))
    assert np.sqrt(last.covariance[0, 0]) < 0.45 * np.sqrt(first.covariance[0, 0])  # many looks know more than one
    assert (np.abs(last.mean[:2]) < 4 * np.sqrt(np.diag(last.covariance)[:2])).all()
    ahead = watching.ahead()
    for one, other in zip(ahead, predict(watching.system, last), strict=True):
        np.testing.assert_array_equal(one, other)
    blind = watching.see(np.full(6, np.nan))
    np.testing.assert_array_equal(blind.covariance, ahead.covariance)
    assert watching.used == 0


def test_smoothing_beats_filtering_beats_each_frame_and_both_know_how_well() -> None:
    look, rng = known(2.0), np.random.default_rng(4)
    time = np.arange(200) * 0.04
    truth = np.stack([0.3 * np.sin(1.7 * time), 0.2 * np.cos(1.3 * time)], -1)
    numbers = looks(truth) + 2.0 * rng.standard_normal((200, 6))
    numbers[100:110] = np.nan
    seen = watch(look, numbers, 0.04, acceleration=0.8)
    error = [np.sqrt(np.mean((pose - truth) ** 2)) for pose in (seen.pose, seen.live, seen.raw)]
    assert error[0] < 0.8 * error[1] < 0.8 * 0.8 * error[2]
    surprise = ((seen.pose - truth) / seen.deviation) ** 2
    assert 0.6 < surprise.mean() < 1.6
    assert (seen.deviation[105] > 1.5 * seen.deviation[50]).all() and (seen.used[100:110] == 0).all()
    late = watch(look, np.concatenate([np.full((5, 6), np.nan), numbers]), 0.04, acceleration=0.8)
    np.testing.assert_array_equal(late.pose[5:], seen.pose)  # before the first pose there is nothing to know
    np.testing.assert_array_equal(late.pose[:5], np.tile(seen.pose[0], (5, 1)))


def test_before_the_first_face_nothing_is_known_and_lies_alone_change_nothing() -> None:
    watching = LiveWatch(known(), 0.04)
    assert watching.see(np.full(6, np.nan)) is UNKNOWN and watching.belief is None and watching.used == 0
    watching.belief = Belief(np.array([0.1, 0.1, 0.0, 0.0]), np.diag([0.02, 0.02, 0.1, 0.1]) ** 2)
    before = watching.belief
    assert watching.see(looks(np.array([0.1, 0.1])) + 300.0) is before and watching.used == 0
