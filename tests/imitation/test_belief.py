"""Belief: the filter is exact conditioning of a joint Gaussian; its limits are perfect senses and none."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.belief import Belief, StateEstimate
from babbling.dynamics import LinearDynamics
from babbling.schema import BodySchema


def schema(noise: float, rate_noise: float, factors: int = 1) -> BodySchema:
    one = np.ones(factors)
    lines = np.arange(factors)
    return BodySchema(lines, lines + factors, 0 * one, one, noise * one, rate_noise * one, np.zeros((factors, 1)))


def dynamics(rng: np.random.Generator, factors: int = 1) -> LinearDynamics:
    transition = np.tile([[0.8, 0.01, 1.0], [-5.0, 0.4, 20.0], [0, 0, 0.98]], (factors, 1, 1))
    transition = transition + 0.01 * rng.standard_normal(transition.shape)
    root = rng.standard_normal((factors, 3, 3)) * np.array([0.01, 0.3, 0.002])[:, None]
    return LinearDynamics(
        transition,
        np.tile([0.2, 5.0, 0.0], (factors, 1)),
        0.01 * rng.standard_normal((factors, 3)),
        root @ root.transpose(0, 2, 1),
        np.full(factors, 1e-4),
        np.zeros(factors),
    )


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_filter_is_gaussian_conditioning_of_the_whole_past(seed: int) -> None:
    """Stack x_0 .. x_T and z_0 .. z_T into one Gaussian and condition it the slow way."""
    rng, ticks = np.random.default_rng(seed), 5
    line, sense = dynamics(rng), schema(0.02, 0.4)
    estimate = StateEstimate(sense, line)
    felt, commands = rng.standard_normal((ticks, 2)) * [0.1, 1.0], 0.1 * rng.standard_normal(ticks)
    a, h, r = line.transition[0], np.eye(2, 3), np.diag([0.02**2, 0.4**2])
    # the first senses are all there is at first, and the bias is unknown
    first = np.diag([0.02**2, 0.4**2, line.bias_variance[0]])
    maps, mean = [np.eye(3)], [np.array([*felt[0], 0.0])]
    for t in range(1, ticks):
        maps.append(a @ maps[-1])
        mean.append(a @ mean[-1] + line.control[0] * commands[t - 1] + line.offset[0])
    joint = np.zeros((ticks, ticks, 3, 3))
    for i in range(ticks):
        for j in range(ticks):
            cov = maps[i] @ first @ maps[j].T
            for k in range(1, min(i, j) + 1):
                cov += np.linalg.matrix_power(a, i - k) @ line.noise[0] @ np.linalg.matrix_power(a, j - k).T
            joint[i, j] = cov
    states = joint.transpose(0, 2, 1, 3).reshape(3 * ticks, 3 * ticks)
    look = np.kron(np.eye(ticks), h)[2:]
    z_cov = look @ states @ look.T + np.kron(np.eye(ticks - 1), r)
    gain = states @ look.T @ np.linalg.inv(z_cov)
    wanted = np.concatenate(mean) + gain @ (felt[1:].ravel() - look @ np.concatenate(mean))
    covariance = states - gain @ look @ states
    belief = estimate.start(felt[:1, :1], felt[:1, 1:])
    for t in range(1, ticks):
        belief = estimate.predict(belief, commands[t - 1].reshape(1, 1))
        belief = estimate.correct(belief, felt[t, :1].reshape(1, 1), felt[t, 1:].reshape(1, 1))
    np.testing.assert_allclose(belief.mean[0, 0], wanted[-3:], rtol=1e-8)
    np.testing.assert_allclose(belief.covariance.reshape(3, 3), covariance[-3:, -3:], rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("kernel", [[1.0], [0.25, 0.5, 0.25], [1 / 16, 4 / 16, 6 / 16, 4 / 16, 1 / 16]])
def test_the_doubt_is_how_far_off_beliefs_are(kernel: list[float]) -> None:
    """By living a long life with the very noise that is believed in."""
    rng, sense, ticks, lives = np.random.default_rng(1), schema(0.02, 0.4), 300, 400
    line = dynamics(rng)
    estimate, x = StateEstimate(sense, line), np.zeros((lives, 3))
    felt = x[:, None, :2] + rng.standard_normal((lives, 1, 2)) * [0.02, 0.4]
    belief, off = estimate.start(felt[..., 0], felt[..., 1]), []
    pushes = rng.multivariate_normal(np.zeros(3), line.noise[0], (ticks, lives))
    for push in pushes:
        x = x @ line.transition[0].T + line.offset[0] + push
        felt = x[:, None, :2] + rng.standard_normal((lives, 1, 2)) * [0.02, 0.4]
        belief = estimate.correct(estimate.predict(belief, np.zeros((lives, 1))), felt[..., 0], felt[..., 1])
        off.append(belief.mean[:, 0, 0] - x[:, 0])
    whole = np.lib.stride_tricks.sliding_window_view(np.array(off)[100:], len(kernel), axis=0) @ np.array(kernel)
    assert estimate.doubt(np.array(kernel))[0] == pytest.approx(np.mean(whole**2), rel=0.05)


def test_perfect_senses_are_believed_and_useless_ones_are_not() -> None:
    rng = np.random.default_rng(0)
    line = dynamics(rng, 2)
    before = Belief(rng.standard_normal((3, 2, 3)), np.tile(np.diag([1e-4, 1e-2, 1e-6]), (2, 1, 1)))
    posture, rate = rng.standard_normal((2, 3, 2))
    sharp = StateEstimate(schema(1e-9, 1e-9, 2), line).correct(before, posture, rate)
    np.testing.assert_allclose(sharp.mean[..., 0], posture, atol=1e-6)
    np.testing.assert_allclose(sharp.mean[..., 1], rate, atol=1e-6)
    blind = StateEstimate(schema(1e9, 1e9, 2), line).correct(before, posture, rate)
    np.testing.assert_allclose(blind.mean, before.mean, atol=1e-9)
    assert np.abs(blind.covariance - before.covariance).max() < 1e-12


def test_copies_and_factors_do_not_mix() -> None:
    rng = np.random.default_rng(1)
    line = dynamics(rng, 3)
    estimate = StateEstimate(schema(0.1, 1.0, 3), line)
    belief = Belief(rng.standard_normal((4, 3, 3)), np.tile(np.diag([1e-2, 1.0, 1e-4]), (3, 1, 1)))
    command, posture, rate = rng.standard_normal((3, 4, 3))
    whole = estimate.correct(estimate.predict(belief, command), posture, rate)
    for f in range(3):
        part = LinearDynamics(*(value[f : f + 1] for value in line))
        one = StateEstimate(schema(0.1, 1.0), part)
        alone = Belief(belief.mean[2:3, f : f + 1], belief.covariance[f : f + 1])
        alone = one.predict(alone, command[2:3, f : f + 1])
        alone = one.correct(alone, posture[2:3, f : f + 1], rate[2:3, f : f + 1])
        np.testing.assert_allclose(alone.mean[0, 0], whole.mean[2, f], atol=1e-12)


def test_an_expectation_on_the_line_changes_nothing_and_off_it_moves_the_prediction() -> None:
    rng = np.random.default_rng(2)
    line = dynamics(rng)
    belief = Belief(0.1 * rng.standard_normal((2, 1, 3)), np.eye(3)[None])
    command = np.array([[0.3], [-0.2]])

    on_it = line.offset[:, 0] + line.control[:, 0] * (command - belief.mean[..., 0])
    estimate = StateEstimate(schema(0.1, 1.0), line)
    plain, same = estimate.predict(belief, command), estimate.predict(belief, command, on_it)
    np.testing.assert_allclose(same.mean, plain.mean, atol=1e-12)
    moved = estimate.predict(belief, command, on_it + 0.05)
    np.testing.assert_allclose(moved.mean[..., 0] - plain.mean[..., 0], 0.05)
    np.testing.assert_allclose(moved.mean[..., 1] - plain.mean[..., 1], 0.05 * line.transition[0, 1, 2])
    np.testing.assert_array_equal(moved.covariance, plain.covariance)


def test_a_lasting_push_becomes_the_bias() -> None:
    """A body that is pushed by d every tick: the believed bias comes to d."""
    line = LinearDynamics(
        np.array([[[0.7, 0.0, 1.0], [-15.0, 0.0, 50.0], [0, 0, 0.98]]]),
        np.array([[0.3, 15.0, 0.0]]),
        np.zeros((1, 3)),
        np.diag([1e-10, 1e-6, 1e-8])[None],
        np.array([1e-5]),
        np.zeros(1),
    )
    estimate = StateEstimate(schema(1e-4, 1e-2), line)
    q, v, push = 0.0, 0.0, 0.004
    belief = estimate.start(np.zeros((1, 1)), np.zeros((1, 1)))
    for t in range(200):
        command = 0.3 * np.sin(0.05 * t)
        step = 0.3 * (command - q) + push
        v, q = step / 0.02, q + step
        belief = estimate.correct(
            estimate.predict(belief, np.full((1, 1), command)), np.full((1, 1), q), v * np.ones((1, 1))
        )
    assert belief.mean[0, 0, 2] == pytest.approx(push, rel=0.1)
