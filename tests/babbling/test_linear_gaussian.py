"""The least-squares line from additive integer sums: NumPy's own, whatever the order."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.errors import BabblingError
from babbling.linear_gaussian import SCALE, LinearGaussian


def moments(low: float = -2.0, high: float = 3.0) -> LinearGaussian:
    return LinearGaussian.empty(("x", "z", "y"), np.full((2, 3), low), np.full((2, 3), high))


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
        one = LinearGaussian.empty(("x", "z", "y"), np.full((1, 3), -2.0), np.full((1, 3), 3.0))
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
