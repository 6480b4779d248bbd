import numpy as np
import pytest

from babbling import kalman
from babbling.errors import BabblingError
from babbling.kalman import Belief, System, constant_velocity, predict, smooth, update
from imitation.errors import ImitationError
from imitation.filters import particles
from imitation.seeing import tracking


def _random_system(rng: np.random.Generator, n: int = 3, m: int = 2) -> tuple[System, Belief]:
    def covariance(size: int) -> np.ndarray:
        root = rng.standard_normal((size, size))
        return root @ root.T + 0.2 * np.eye(size)

    transition = rng.standard_normal((n, n)) / np.sqrt(n)
    system = System(transition, 0.3 * covariance(n), rng.standard_normal((m, n)), covariance(m))
    return system, Belief(rng.standard_normal(n), covariance(n))


def run_filter(system: System, prior: Belief, measured: np.ndarray, observed: np.ndarray) -> tuple[Belief, Belief]:
    """All steps of (T, ..., m): beliefs after and before each."""
    belief, beliefs, predictions = prior, [], []
    for step in range(len(measured)):
        belief = predict(system, belief) if step else belief
        predictions.append(belief)
        belief, _ = update(system, belief, measured[step], observed[step])
        beliefs.append(belief)
    return Belief.stacked(beliefs), Belief.stacked(predictions)


def _joint(system: System, prior: Belief, steps: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Mean and covariance of all states (T n) stacked, then of all measurements (T m): written out, no recursion."""
    n, m = system.observation.shape[1], system.observation.shape[0]
    powers = [np.linalg.matrix_power(system.transition, k) for k in range(steps)]
    mean = np.concatenate([power @ prior.mean for power in powers])
    covariance = np.zeros((steps * n, steps * n))
    for i in range(steps):
        for j in range(steps):
            block = powers[i] @ prior.covariance @ powers[j].T
            for k in range(1, min(i, j) + 1):  # the noise that entered at step k
                block = block + powers[i - k] @ system.process_noise @ powers[j - k].T
            covariance[i * n : (i + 1) * n, j * n : (j + 1) * n] = block
    sensor = np.kron(np.eye(steps), system.observation)
    noise = np.kron(np.eye(steps), system.observation_noise)
    assert sensor.shape == (steps * m, steps * n)
    return mean, covariance, sensor, noise


def _sample(rng: np.random.Generator, system: System, prior: Belief, steps: int) -> np.ndarray:
    mean, covariance, sensor, noise = _joint(system, prior, steps)
    flat = rng.multivariate_normal(sensor @ mean, sensor @ covariance @ sensor.T + noise)
    return flat.reshape(steps, -1)


@pytest.mark.parametrize("missing", ["none", "steps", "numbers"])
def test_kalman_filter_and_smoother_are_exact(missing: str) -> None:
    rng = np.random.default_rng(1)
    steps = 6
    system, prior = _random_system(rng)
    measured = _sample(rng, system, prior, steps)
    observed = np.ones_like(measured, bool)
    if missing == "steps":
        observed[[1, 2, 5]] = False
    elif missing == "numbers":
        observed = rng.random(measured.shape) < 0.6
    given = np.where(observed, measured, np.nan)  # what is missing is never looked at
    filtered, ahead = run_filter(system, prior, given, observed)
    smoothed = smooth(system, filtered, ahead)

    mean, covariance, sensor, noise = _joint(system, prior, steps)
    for step in range(steps):
        for known, result in ((slice(0, step + 1), filtered), (slice(0, steps), smoothed)):
            keep = np.zeros_like(observed)
            keep[known] = observed[known]
            index = np.flatnonzero(keep)
            spread = (sensor @ covariance @ sensor.T + noise)[np.ix_(index, index)]
            gain = np.linalg.solve(spread, sensor[index] @ covariance).T
            exact_mean = mean + gain @ (measured.ravel()[index] - sensor[index] @ mean)
            exact = covariance - gain @ sensor[index] @ covariance
            here = slice(3 * step, 3 * step + 3)
            np.testing.assert_allclose(result.mean[step], exact_mean[here], atol=1e-9)
            np.testing.assert_allclose(result.covariance[step], exact[here, here], atol=1e-9)


def test_batched_filters_are_the_same_as_one_by_one() -> None:
    rng = np.random.default_rng(2)
    systems = [_random_system(rng) for _ in range(4)]
    together = System(*(np.stack([s[0][i] for s in systems]) for i in range(4)))
    prior = Belief(*(np.stack([s[1][i] for s in systems]) for i in range(2)))
    measured = rng.standard_normal((5, 4, 2))
    observed = rng.random((5, 4, 1)) < 0.7
    batch, ahead = run_filter(together, prior, measured, observed)
    back = smooth(together, batch, ahead)
    for k, (system, start) in enumerate(systems):
        one, before = run_filter(system, start, measured[:, k], observed[:, k])
        np.testing.assert_allclose(batch.mean[:, k], one.mean)
        np.testing.assert_allclose(back.covariance[:, k], smooth(system, one, before).covariance)


def random_walk(diffusion: float, noise: float) -> System:
    one = np.eye(1)
    return System(one, one * diffusion**2, one, one * noise**2)


def test_limits_of_the_gain() -> None:
    belief = Belief(np.array([1.0]), np.array([[4.0]]))
    for noise, expected in ((1e-9, 3.0), (1e9, 1.0), (2.0, 2.0)):  # trust the eye, the belief, both
        system = random_walk(0.0, noise)
        assert kalman.update(system, belief, np.array([3.0]))[0].mean[0] == pytest.approx(expected, abs=1e-6)
    nothing, gain = kalman.update(random_walk(0.1, 1.0), belief, np.array([np.nan]), False)
    assert nothing.mean[0] == 1.0 and nothing.covariance[0, 0] == 4.0 and not gain.any()


def test_kalman_refuses_what_cannot_be() -> None:
    system = random_walk(0.0, 0.0)
    belief = Belief(np.zeros(1), np.zeros((1, 1)))
    with pytest.raises(BabblingError, match="not finite; mark what is missing"):
        kalman.update(system, belief, np.array([np.nan]))
    with pytest.raises(BabblingError, match="not positive definite"):
        kalman.update(system, belief, np.array([0.0]))


def test_constant_velocity_noise_is_that_of_a_held_acceleration() -> None:
    system = constant_velocity(0.5, acceleration=2.0, noise=0.1, axes=1)
    np.testing.assert_allclose(system.process_noise, 4.0 * np.outer([0.125, 0.5], [0.125, 0.5]))
    np.testing.assert_allclose(system.transition @ [1.0, 3.0], [2.5, 3.0])


def test_particle_filter_agrees_with_the_exact_answer_within_monte_carlo_error() -> None:
    rng = np.random.default_rng(4)
    system, prior = _random_system(rng, n=2, m=1)
    steps, count, runs = 8, 2000, 24
    measured = _sample(rng, system, prior, steps)
    observed = np.array([True, True, True, False, False, True, True, True])
    exact, _ = run_filter(system, prior, measured, observed[:, None])

    def move(rng: np.random.Generator, states: np.ndarray) -> np.ndarray:
        return states @ system.transition.T + rng.multivariate_normal(
            np.zeros(2), system.process_noise, states.shape[:-1]
        )

    means = np.zeros((steps, runs, 2))
    belief = particles.gather(
        rng.multivariate_normal(prior.mean, prior.covariance, (runs, count))
    )  # a batch of filters
    spread = 0.0
    for step in range(steps):
        z, variance = measured[step], system.observation_noise[0, 0]

        def weigh(states: np.ndarray, z: np.ndarray = z, variance: float = variance) -> np.ndarray:
            return -0.5 * ((states @ system.observation[0] - z) ** 2 / variance + np.log(2 * np.pi * variance))

        belief = particles.step(rng, belief, move if step else None, weigh if observed[step] else None)
        means[step] = belief.mean
        spread = belief.covariance.mean(axis=0)
    error = means.std(axis=1, ddof=1) / np.sqrt(runs)  # of the mean over the runs
    assert (np.abs(means.mean(axis=1) - exact.mean) < 4.5 * error + 1e-3).all()
    assert (error < 0.02).all()
    np.testing.assert_allclose(spread, exact.covariance[-1], rtol=0.08, atol=0.01)


def test_systematic_resampling_draws_floor_or_ceil() -> None:
    rng = np.random.default_rng(0)
    weights = rng.dirichlet(np.full(50, 0.3), size=(3, 4))
    counts = np.zeros_like(weights)
    for _ in range(300):
        chosen = particles.systematic(rng, weights)
        drawn = np.stack([np.bincount(row, minlength=50) for row in chosen.reshape(12, 50)]).reshape(weights.shape)
        assert (drawn >= np.floor(50 * weights - 1e-9)).all() and (drawn <= np.ceil(50 * weights + 1e-9)).all()
        counts += drawn / 300
    np.testing.assert_allclose(counts, 50 * weights, atol=0.15)


def test_particles_that_explain_nothing_are_refused() -> None:
    belief = particles.gather(np.zeros((10, 1)))
    with pytest.raises(ImitationError, match="no particle explains"):
        particles.step(np.random.default_rng(0), belief, None, lambda s: np.full(s.shape[:-1], -np.inf))


# ---- one thing among look-alikes, 30 frames a second, hidden for half a second ----

FRAMES, HIDDEN = 90, slice(40, 55)


def _path(rng: np.random.Generator) -> np.ndarray:
    phase = rng.uniform(0, 2 * np.pi, 2)
    t = np.arange(FRAMES) / 30.0
    return np.stack([80 + 15 * np.sin(2.5 * t + phase[0]), 60 + 8 * np.sin(2.5 * t + phase[1])], axis=1)


def _track(kind: str, distractor: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Errors (FRAMES - 1,) of the track, and whether each frame was reported as hidden."""
    rng = np.random.default_rng(seed)
    options = tracking.TrackOptions()
    truth = _path(rng)
    middle = truth[(HIDDEN.start + HIDDEN.stop) // 2]
    away = {"none": None, "static": [0.0, 14.0], "crossing": [4.0, 0.0]}[distractor]
    track = tracking.start(truth[0], options, rng, 1000 if kind == "particles" else 0)
    errors, hidden = [], []
    for k in range(1, FRAMES):
        seen = []
        if not HIDDEN.start <= k < HIDDEN.stop and rng.random() < 0.97:
            seen.append(truth[k] + 0.3 * rng.standard_normal(2))
        if away is not None:
            drift = 2.0 * (k - 47) if distractor == "crossing" else 0.0
            seen.append(middle + away + [0.0, drift] + 0.3 * rng.standard_normal(2))
        if rng.random() < 0.05:
            seen.append(rng.uniform([0, 0], [160, 120]))
        rng.shuffle(seen)
        track, share = tracking.follow(track, np.array(seen).reshape(-1, 2), options, rng)
        errors.append(np.hypot(*(track.position - truth[k])))
        hidden.append(share.sum() < 0.5)
    return np.array(errors), np.array(hidden)


@pytest.mark.parametrize("distractor", ["none", "static", "crossing"])
@pytest.mark.parametrize("kind", ["kalman", "particles"])
def test_tracks_survive_hiding_noise_and_a_look_alike(kind: str, distractor: str) -> None:
    for seed in range(4):
        errors, hidden = _track(kind, distractor, seed)
        assert np.sqrt((errors[5:38] ** 2).mean()) < 0.6  # raw detections have 0.42
        assert hidden[HIDDEN.start + 1 : HIDDEN.stop - 2].all()
        assert errors.max() < 25  # a guess meanwhile, not a fantasy
        assert np.sqrt((errors[60:] ** 2).mean()) < 0.6  # and found again within 0.2 s


def test_the_kalman_track_beats_raw_detections_of_a_slow_thing() -> None:
    rng = np.random.default_rng(0)
    options = tracking.TrackOptions(acceleration=20.0, noise=1.0, start_speed=10.0)
    t = np.arange(200) / 30.0
    truth = np.stack([80 + 5 * np.sin(t), 60 + 5 * np.cos(t)], axis=1)
    seen = truth + rng.standard_normal(truth.shape)
    track, errors = tracking.start(seen[0], options, rng), []
    for k in range(1, 200):
        track, _ = tracking.follow(track, seen[k], options, rng)
        errors.append(track.position - truth[k])
    assert np.std(errors[10:]) < 0.6 * np.std(seen - truth)
