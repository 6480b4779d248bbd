"""Errors of joints: hinges in degrees, slides in millimetres, each by itself."""

from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from experiments.gesture.figures import through_time
from experiments.gesture.found import Performed
from experiments.gesture.joints import ROWS, joint_metrics, joint_rows
from experiments.shared.judging import ringing, rmse, rmse_deg


def done(units: tuple[str, ...], off: np.ndarray) -> Any:
    """Somebody whose joints were off by (J,) rad or m all along, twice as much at first; a wave in every joint."""
    wanted = 0.5 * np.sin(np.arange(200) / 9)[:, None] * np.ones(len(units))
    wanted[:, -1] = 0  # it stands still
    order = np.arange(len(units))[::-1]  # factors are numbered the other way round

    def attempt(size: float) -> SimpleNamespace:
        truth = (wanted + size * off)[:, None]
        return SimpleNamespace(truth=truth, approach=truth[:50] + off, way=truth[:50][..., order])

    body = SimpleNamespace(units=units, joints=[f"j{i}" for i in range(len(units))])
    return SimpleNamespace(
        body=body, attempts=[attempt(2), attempt(1)], peer=attempt(4), imitated=wanted + off, replayed=wanted + 3 * off,
        seen=SimpleNamespace(angles=wanted), factors=order,
    )  # fmt: skip


def test_hinges_and_slides_are_told_apart() -> None:
    off = np.array([0.01, 0.003, -0.02, 0.004])
    told = joint_metrics(done(("rad", "m", "rad", "m"), off))
    for shown, scale, mine in (("deg", 180 / np.pi, off[[0, 2]]), ("mm", 1e3, off[[1, 3]])):
        size = scale * np.sqrt(np.mean(mine**2))
        assert told[f"joint_rmse_{shown}"] == pytest.approx(size)
        assert told[f"attempts_rmse_{shown}"] == pytest.approx([2 * size, size])
        assert told[f"direct_replay_rmse_{shown}"] == pytest.approx(3 * size)
        assert told[f"linear_peer_rmse_{shown}"] == pytest.approx(4 * size)
        assert told[f"approach_error_{shown}"] == pytest.approx(size)
        for name in ("largest_error", "worst_joint"):
            assert told[f"{name}_{shown}"] == pytest.approx(scale * np.abs(mine).max())
        assert told[f"ringing_{shown}"] == pytest.approx(0, abs=1e-9)
    assert told["worst_joint"] == "j2" and told["worst_slide"] == "j3"
    assert told["joint_rmse_deg_by_joint"].keys() == {"j0", "j2"} and told["joint_rmse_mm_by_joint"].keys() == {
        "j1",
        "j3",
    }
    assert told["moving_joints_rmse_mm"] == pytest.approx(3)  # the other stands still
    rows = dict(joint_rows(told))
    assert (
        rows["worst joint (j2)"] == f"{np.rad2deg(0.02):.4f} deg" and rows["worst joint (j3) (slides)"] == "4.0000 mm"
    )
    assert len(rows) == 2 * (len(ROWS) + 2)


def test_ringing_is_told_beside_direct_replays() -> None:
    one = done(("rad", "rad", "m"), np.zeros(3))
    shaking = 0.01 * (-1.0) ** np.arange(200)
    one.imitated[:, 1] += shaking
    one.replayed[:] += 0.1 * shaking[:, None]
    told = joint_metrics(one)
    size = np.rad2deg(2 * np.sqrt(2) * 0.01)
    assert told["ringing_worst_deg"] == pytest.approx(size) and told["ringing_deg"] == pytest.approx(size / 2)
    assert told["direct_replay_ringing_worst_deg"] == pytest.approx(size / 10)
    rows = dict(joint_rows(told))
    name = "ringing, peak to peak, worst joint (j1); direct replay's"
    assert rows[name] == f"{size:.4f}; {size / 10:.4f} deg" and f"{name} (slides)".replace("j1", "j2") in rows


@pytest.mark.parametrize(("units", "unit", "alike"), [(("rad", "m", "rad"), "deg", [0, 2]), (("m", "m"), "mm", [0, 1])])
def test_joints_drawn_as_one_line_have_one_unit(units: tuple[str, ...], unit: str, alike: list[int]) -> None:
    off = np.array([0.01, 0.5, -0.02])[: len(units)]
    one = done(units, off)
    scale = np.array([{"rad": 180 / np.pi, "m": 1e3}[own] for own in units])
    one.body.shown_scale, one.body.shown_units = scale, tuple({"rad": "deg", "m": "mm"}[own] for own in units)
    one.body.tick_s, one.usual = 0.02, Performed.usual.fget(one)  # type: ignore[attr-defined]
    one.away, one.joints_in = partial(Performed.away, one), partial(Performed.joints_in, one)
    assert one.usual == unit and np.flatnonzero(one.joints_in(unit)).tolist() == alike
    np.testing.assert_allclose(one.away(one.imitated[:50]), np.tile(scale * off, (50, 1)), atol=1e-9)
    through_time(axes := Figure().subplots(), one)
    drawn = {line.get_label(): np.asarray(line.get_ydata()) for line in axes.lines}
    np.testing.assert_allclose(drawn["imitated, attempt 2"], np.sqrt(np.mean((scale * off)[alike] ** 2)))
    assert axes.get_ylabel().endswith(f"[{unit}]")


def test_where_there_are_no_slides_or_no_hinges_nothing_is_made_up() -> None:
    hinges = joint_metrics(done(("rad", "rad"), np.array([0.01, 0.02])))
    assert not [name for name in hinges if "_mm" in name or "slide" in name]
    slides = joint_metrics(done(("m", "m"), np.array([0.01, 0.02])))
    told = {name: value for name, value in slides.items() if name.endswith("_deg")}
    assert told and all(value is None for value in told.values()) and told.keys() <= hinges.keys()
    assert all(said.endswith(" mm") for _, said in joint_rows(slides)) and len(joint_rows(slides)) == len(ROWS) + 2


def test_ringing_is_a_sines_height_and_slow_errors_hardly_count() -> None:
    t = np.arange(1000)
    shaking = 0.3 * (-1.0) ** t  # from tick to tick: its second difference is 4 a
    assert ringing(np.stack([shaking, 5 + 0 * t], 1)) == pytest.approx([2 * np.sqrt(2) * 0.3, 0])
    assert ringing(np.sin(2 * np.pi * t / 100)[:, None])[0] < 0.01


def test_what_was_not_wanted_is_not_missed() -> None:
    reached, wanted = np.array([[3.0, 1.0], [0.0, 9.0]]), np.array([[0.0, 1.0], [4.0, np.nan]])
    assert rmse(reached, wanted) == pytest.approx(np.sqrt(25 / 3))
    assert rmse_deg(np.deg2rad(reached), np.deg2rad(wanted)) == pytest.approx(np.sqrt(25 / 3))
