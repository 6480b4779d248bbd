"""Bayesian regression from additive sums: NumPy's least squares, the textbook's posterior, exact in any order."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import multivariate_normal

from babbling.errors import BabblingError
from babbling.regression import SCALE, LinearGaussian, Regression, regress


def moments(low: float = -2.0, high: float = 3.0) -> LinearGaussian:
    return LinearGaussian(("x", "z", "y"), np.full((2, 3), low), np.full((2, 3), high))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.01, 0.5))
def test_the_fit_is_numpys_least_squares(seed: int, noise: float) -> None:
    rng = np.random.default_rng(seed)
    x, z = rng.uniform(-1, 1, (2, 400, 2))
    y = 0.3 + rng.uniform(-0.8, 0.8, 2) * x + rng.uniform(-0.8, 0.8, 2) * z + noise * rng.standard_normal(x.shape)
    m = moments(-8.0, 8.0)  # wide enough that no sample of y is cut
    m.observe(np.stack([x, z, y], -1), np.ones((400, 2), bool))
    fit = m.fit(["y"], ["x", "z"])
    for f in range(2):
        design = np.stack([np.ones(400), x[:, f], z[:, f]], 1)
        beta, rest, *_ = np.linalg.lstsq(design, y[:, f], rcond=None)
        np.testing.assert_allclose(fit.coefficients[f, 0], beta, atol=5e-4)
        assert fit.covariance[f, 0, 0] == pytest.approx(rest[0] / 400, rel=5e-3, abs=1e-7)
    np.testing.assert_allclose(fit.predict(x, z)[..., 0].mean(0), y.mean(0), atol=1e-4)


def test_several_targets_have_the_residuals_covariance() -> None:
    rng = np.random.default_rng(0)
    x = rng.uniform(-1, 1, (2000, 2))
    e = rng.multivariate_normal([0, 0], [[0.04, 0.03], [0.03, 0.09]], (2000, 2))
    m = moments()
    m.observe(np.stack([x, 0.5 * x + e[..., 0], -0.2 * x + e[..., 1]], -1), np.ones((2000, 2), bool))
    fit = m.fit(["z", "y"], ["x"])
    np.testing.assert_allclose(fit.covariance, [[[0.04, 0.03], [0.03, 0.09]]] * 2, atol=0.006)


def test_rows_left_out_leave_nothing() -> None:
    rng = np.random.default_rng(0)
    values = rng.uniform(-2, 3, (50, 2, 3))
    keep = rng.random((50, 2)) < 0.5
    m, kept = moments(), moments()
    m.observe(values, keep)
    for f in range(2):
        one = LinearGaussian(("x", "z", "y"), np.full((1, 3), -2.0), np.full((1, 3), 3.0))
        one.observe(values[keep[:, f], f : f + 1], np.ones((keep[:, f].sum(), 1), bool))
        kept.sums[f] = one.sums[0]
    assert (m.sums == kept.sums).all()
    assert m.samples.tolist() == keep.sum(0).tolist()
    assert (m.sums[:, 0, 0] == keep.sum(0) * SCALE**2).all()


def test_nothing_seen_is_no_line() -> None:
    m = moments()
    m.observe(np.zeros((9, 2, 3)), np.tile([True, False], (9, 1)))
    with pytest.raises(BabblingError, match="factor 1 has no experience"):
        m.fit(["y"], ["x"])


def test_merging_in_any_order_gives_the_same_bytes() -> None:
    rng = np.random.default_rng(1)
    parts = []
    for _ in range(5):
        m = LinearGaussian(("x", "z", "y"), np.full((2, 3), -2.0), np.full((2, 3), 3.0))
        m.observe(rng.uniform(-2, 3, (40, 2, 3)), rng.random((40, 2)) < 0.8)
        parts.append(m)
    fits = []
    for order in (range(5), (3, 1, 4, 0, 2)):
        m = LinearGaussian(("x", "z", "y"), np.full((2, 3), -2.0), np.full((2, 3), 3.0))
        for part in order:
            m.sums += parts[part].sums
        fits.append(m.fit(["y"], ["x", "z"]))
    assert fits[0].coefficients.tobytes() == fits[1].coefficients.tobytes()
    assert fits[0].precision.tobytes() == fits[1].precision.tobytes()


def test_precision_is_in_the_channels_own_units() -> None:
    rng = np.random.default_rng(3)
    m = moments()
    values = rng.uniform(-1.5, 2.5, (500, 2, 3))
    m.observe(values, np.ones((500, 2), bool))
    design = np.concatenate([np.ones((500, 2, 1)), values[..., :2]], -1)
    np.testing.assert_allclose(
        m.fit(["y"], ["x", "z"]).precision, np.einsum("nfi,nfj->fij", design, design), rtol=1e-4, atol=0.1
    )


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_rows_at_hand_are_fitted_as_numpy_does_each_factor_on_its_own(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scale = 10.0 ** rng.integers(-3, 4, 4)
    x = rng.standard_normal((60, 3, 4)) * scale
    y = x @ (rng.standard_normal((4, 2)) / scale[:, None]) + 0.1 * rng.standard_normal((60, 3, 2))
    y[rng.random((60, 3)) < 0.2] = np.nan
    fit = regress(x, y)
    for f in range(3):
        use = np.isfinite(y[:, f]).all(1)
        beta = np.linalg.lstsq(x[use, f], y[use, f], rcond=None)[0]
        rest = y[use, f] - x[use, f] @ beta
        np.testing.assert_allclose(fit.coefficients[f] * scale, beta.T * scale, rtol=1e-6, atol=1e-8)
        np.testing.assert_allclose(fit.covariance[f], rest.T @ rest / use.sum(), rtol=1e-7, atol=1e-12)
        assert fit.samples[f] == use.sum()
    np.testing.assert_allclose(fit.mean(x)[:, 1, 0], x[:, 1] @ fit.coefficients[1, 0])


def test_ridge_goes_from_least_squares_to_nothing() -> None:
    rng = np.random.default_rng(4)
    x, y = rng.standard_normal((50, 1, 3)), rng.standard_normal((50, 1, 2))
    sums = Regression(1, 3, 2)
    sums.observe(x[:20], y[:20])
    sums.observe(x[20:], y[20:])
    design, target = x[:, 0], y[:, 0]
    for ridge in (0.0, 0.3, 7.0):
        exact = np.linalg.solve(design.T @ design + ridge * np.eye(3), design.T @ target)
        np.testing.assert_allclose(sums.fit(ridge).coefficients[0], exact.T, rtol=1e-8)
    np.testing.assert_allclose(sums.fit(1e-9).coefficients, sums.fit().coefficients, atol=1e-9)
    assert np.abs(sums.fit(1e9).coefficients).max() < 1e-6


def test_features_that_say_the_same_share_the_weight() -> None:
    x = np.random.default_rng(5).standard_normal((40, 1, 1))
    fit = regress(np.concatenate([x, x, 0 * x], -1), 3 * x)
    np.testing.assert_allclose(fit.coefficients[0, 0], [1.5, 1.5, 0], atol=1e-6)


def test_noise_and_posterior_covariance_are_unbiased() -> None:
    """10000 small experiments: E[s^2] is the noise's variance; weights stray by s^2 A^-1: Mahalanobis squares of X."""
    rng = np.random.default_rng(0)
    factors, rows, features = 10_000, 12, 4
    x, truth = rng.standard_normal((rows, factors, features)), rng.standard_normal((factors, features))
    y = np.einsum("nfx,fx->nf", x, truth) + 0.2 * rng.standard_normal((rows, factors))
    fit = regress(x, y[..., None])
    assert np.mean(fit.noise**2) == pytest.approx(0.04, rel=0.03)
    assert np.mean(fit.covariance) == pytest.approx(0.04 * (rows - features) / rows, rel=0.03)
    away = fit.coefficients[:, 0] - truth
    assert np.einsum("fx,fxz,fz->f", away, fit.precision, away).mean() / 0.04 == pytest.approx(features, rel=0.03)
    there = rng.standard_normal((1, factors, features))
    doubt = np.einsum("nfx,fxz,nfz->nf", there, np.linalg.inv(fit.precision), there)
    np.testing.assert_allclose(fit.doubt(there), doubt, rtol=1e-6)


@pytest.mark.parametrize("rows", [30, 100])
def test_the_noise_found_has_the_greatest_evidence(rows: int) -> None:
    """Against ln N(y; 0, s^2 I + X X^T / prior) itself."""
    rng = np.random.default_rng(rows)
    x = rng.standard_normal((rows, 20))
    y = x @ (0.5 * rng.standard_normal(20)) + 0.3 * rng.standard_normal(rows)
    sums = Regression(1, 20, 1)
    sums.observe(x[:, None], y[:, None, None])
    fit, variance = sums.fit_with_noise(prior=4.0)

    def evidence(v: float) -> float:
        return float(multivariate_normal.logpdf(y, np.zeros(rows), v * np.eye(rows) + x @ x.T / 4.0))

    assert evidence(variance) > max(evidence(0.95 * variance), evidence(1.05 * variance))
    assert fit.noise[0, 0] == pytest.approx(np.sqrt(variance))


def test_fewer_rows_than_weights_determine_no_noise() -> None:
    rng = np.random.default_rng(7)
    x, y = rng.standard_normal((5, 1, 8)), rng.standard_normal((5, 1, 1))
    assert np.isinf(regress(x, y).noise).all()
    sums = Regression(1, 8, 1)
    sums.observe(x, y)
    fit, variance = sums.fit_with_noise()
    assert np.isfinite(fit.coefficients).all() and 0 < variance < 10


def test_outliers_are_left_out_of_the_next_round_and_nothing_else_is() -> None:
    rng = np.random.default_rng(8)
    x = np.concatenate([np.ones((300, 1, 1)), rng.uniform(-1, 1, (300, 1, 1))], -1)
    exact = x @ np.array([[0.2], [0.7]])
    assert regress(x, exact, outlier=3.0, rounds=4).samples == 300
    spoilt = exact + 0.01 * rng.standard_normal(exact.shape)
    spoilt[:25] += 4.0
    once, often = regress(x, spoilt), regress(x, spoilt, outlier=3.0, rounds=5)
    assert abs(once.coefficients[0, 0, 0] - 0.2) > 0.2
    np.testing.assert_allclose(often.coefficients[0, 0], [0.2, 0.7], atol=0.005)
    assert 265 <= often.samples[0] <= 275 and often.noise[0, 0] == pytest.approx(0.01, rel=0.15)
    allowed = np.arange(300)[:, None] >= 25
    np.testing.assert_allclose(regress(x, spoilt, keep=allowed).coefficients[0, 0], [0.2, 0.7], atol=0.005)
