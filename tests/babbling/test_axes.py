"""Axes: soft assignment keeps the mean, hard assignment takes the nearest, nothing impossible is a grid."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from babbling.axes import UNIT, Axis
from babbling.errors import BabblingError

numbers = st.floats(-50, 50)


def axis(low: float, extent: float, size: int) -> Axis:
    return Axis("x", "rad", np.array([low, 0.0]), np.array([low + extent, 1.0]), size)


@settings(max_examples=100, deadline=None)
@given(numbers, st.floats(0.01, 20), st.integers(2, 40), st.floats(0, 1))
def test_soft_assignment_keeps_the_mean_and_is_local(low: float, extent: float, size: int, share: float) -> None:
    grid = axis(low, extent, size)
    x = np.array([low + share * extent, share])
    soft = grid.soft(x)
    w = soft.weight / UNIT
    f = np.arange(2)
    mean = (1 - w) * grid.points[f, soft.lower] + w * grid.points[f, soft.lower + 1]
    np.testing.assert_allclose(mean, x, atol=0.51 * grid.step.max() / UNIT + 1e-9)
    assert ((soft.weight >= 0) & (soft.weight <= UNIT) & (soft.lower >= 0) & (soft.lower < size - 1)).all()
    nearest = grid.hard(x)
    assert (np.abs(grid.points[f, nearest] - x) <= grid.step / 2 + 1e-9).all()


@given(numbers, st.floats(0.01, 20), st.integers(2, 40), st.floats(0.01, 5))
def test_off_the_axis_is_said_and_taken_at_the_end(low: float, extent: float, size: int, beyond: float) -> None:
    grid = axis(low, extent, size)
    for x, end in ((np.array([low - beyond, -beyond]), 0), (np.array([low + extent + beyond, 1 + beyond]), size - 1)):
        soft = grid.soft(x)
        assert not soft.inside.any()
        assert (soft.lower + soft.weight / UNIT == end).all()
        assert (grid.hard(x) == end).all()


def test_grid_points_are_on_the_axis_exactly() -> None:
    grid = axis(-1, 2, 5)
    np.testing.assert_array_equal(grid.points[0], [-1, -0.5, 0, 0.5, 1])
    np.testing.assert_array_equal(grid.soft(grid.points.T).weight % UNIT, 0)
    assert grid.soft(grid.points.T).inside.all()
    with pytest.raises(ValueError, match="read-only"):
        grid.low[0] = 3


@pytest.mark.parametrize(
    ("low", "high", "size", "message"),
    [
        ([0.0], [1.0], 1, "at least 2"),
        ([0.0, 1.0], [1.0, 1.0], 3, "factor 1 has no extent"),
        ([0.0], [np.inf], 3, "not finite"),
        ([0.0], [1.0, 2.0], 3, "one per factor"),
    ],
)
def test_what_is_no_axis(low: list[float], high: list[float], size: int, message: str) -> None:
    with pytest.raises(BabblingError, match=message):
        Axis("x", "rad", np.array(low), np.array(high), size)


def test_categories_are_distinct() -> None:
    with pytest.raises(BabblingError, match="distinct"):
        Axis.categorical("x", ("a", "a"))
    with pytest.raises(BabblingError, match="at least one"):
        Axis.categorical("x", ())
