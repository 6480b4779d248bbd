"""The frame that a pilot fixes: a line to depart from, axes that bend, ranges that hold."""

from dataclasses import replace

import numpy as np
import pytest

from babbling.features import BEFORE, COLUMNS
from babbling.frame import GRID, MARGIN, QUANTILE, Frame, shares
from tests.babbling.joints import JITTER, bent, features, frame, linear, lived, slack, sticky

AT = {name: number for number, name in enumerate(COLUMNS)}


@pytest.mark.parametrize("rule", [linear, slack])
def test_the_shares_are_those_of_the_plays_that_push(rule) -> None:
    columns, outcome = lived(rule, 400, 0, noise=0.0)
    found = shares(columns, outcome)
    np.testing.assert_allclose(found.sum(1), 1, atol=1e-12)
    plays = columns[..., AT["action"] : AT["zone 1"]]
    arrives = replace(features(), share=found).effort(plays)
    assert np.abs(arrives - plays[..., {linear: 0, slack: 5}[rule]]).max() < 0.2 * JITTER  # its neighbours are alike


@pytest.mark.parametrize("rule", [linear, bent, slack])
def test_a_world_that_is_a_line_is_the_line_and_nothing_departs(rule) -> None:
    columns, outcome = lived(rule, 400, 0, noise=0.0)
    found = Frame.found(replace(features(), share=shares(columns, outcome)), columns, outcome)
    left = outcome - (columns[..., : len(COLUMNS)] * found.line).sum(-1)
    assert np.sqrt(np.mean(left**2)) < 0.02 * outcome.std()
    sticking, moved = lived(sticky, 400, 0, noise=0.0)
    stuck = Frame.found(features(), sticking, moved)
    assert np.sqrt(np.mean((moved - (sticking[..., : len(COLUMNS)] * stuck.line).sum(-1)) ** 2)) > 0.05 * moved.std()


def test_effort_is_counted_beyond_what_babbling_took_on_average_there() -> None:
    columns, _ = lived(slack, 400, 3)
    found = frame(slack, 3)
    effort = found.features.effort(columns[..., AT["action"] : AT["zone 1"]])
    for f in range(2):
        x = columns[:, f, : len(BEFORE)]
        line = np.linalg.lstsq(x, effort[:, f], rcond=None)[0]
        rate, beyond = (axis[:, f] for axis in found.bent(columns))
        wanted = effort[:, f] - x @ line
        assert np.corrcoef(np.sinh(beyond) * found.bend[f, 1], wanted)[0, 1] > 0.999
        np.testing.assert_allclose(np.sinh(rate) * found.bend[f, 0], x[:, AT["rate"]], atol=1e-12)


def test_half_of_what_happened_lies_where_the_axes_are_even_and_all_of_it_on_them() -> None:
    columns, outcome = lived(sticky, 400, 4)
    found = frame(sticky, 4)
    for bent_axis, axis in zip(found.bent(columns), (found.rate, found.effort), strict=True):
        np.testing.assert_allclose((np.abs(bent_axis) < np.arcsinh(1)).mean(0), 0.5, atol=0.01)
        assert (np.abs(bent_axis) <= axis.high).mean() > QUANTILE and (axis.low == -axis.high).all()
    left = np.abs(outcome - (columns[..., : len(COLUMNS)] * found.line).sum(-1))
    np.testing.assert_allclose(found.departure.high, MARGIN * np.quantile(left, QUANTILE, axis=0), rtol=1e-6)
    assert (found.rate.size, found.effort.size, found.departure.size) == GRID


def test_how_far_a_bend_reaches_is_a_matter_of_postures_not_of_how_often_it_was_passed() -> None:
    """A pilot that came to a knot now and then: what lies beyond is not cut, and its slope is found."""
    columns, outcome = lived(bent, 400, 5)
    highest = columns[..., AT["posture"]].max(0)
    mine = replace(features(), knots=np.sort(highest[:, None] - 0.02 * np.arange(6), axis=1))
    late = np.maximum(columns[..., [AT["posture"]]] - mine.knots, 0)
    columns[..., AT["hinge 1"] : AT["hinge 6"] + 1] = late
    found = Frame.found(mine, columns, outcome)
    reach = dict(zip(COLUMNS[1:], found.reach.T, strict=False))
    for number in range(6):
        np.testing.assert_allclose(reach[f"hinge {number + 1}"], reach["posture"] - mine.knots[:, number], rtol=1e-12)
    np.testing.assert_allclose(reach["squared"], reach["posture"] ** 2)
    np.testing.assert_allclose(reach["posture"], MARGIN * np.quantile(abs(columns[..., 5]), QUANTILE, 0), rtol=1e-6)
    assert COLUMNS[5] == "posture"


def test_what_the_pilot_never_met_has_no_weight() -> None:
    columns, outcome = lived(linear, 400, 6)
    far = slice(AT["hinge 5"], AT["hinge 6"] + 1)
    columns[..., far] = 0
    found = Frame.found(replace(features(), knots=features().knots + np.array([0, 0, 0, 0, 9, 9])), columns, outcome)
    assert (found.line[:, far] == 0).all() and np.isfinite(found.line).all() and (found.reach > 0).all()


def test_frames_that_differ_in_a_line_or_an_axis_are_not_the_same() -> None:
    one = frame(linear)
    assert one.same(frame(linear)) and not one.same(replace(one, line=one.line + 1e-9))
    other = frame(linear, seed=9)
    for name in ("rate", "effort", "departure"):
        assert not one.same(replace(one, **{name: getattr(other, name)})), name
