"""What opens with a recording: nothing empty, and the checker that says so is itself held to what Rerun does."""

from pathlib import Path

import numpy as np
import pytest
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from experiments.shared import palette, views
from experiments.shared.recording import log_bars, log_series, log_states, recording
from tests.recordings import empty_views
from tests.recordings import views as read_back


def drawn(path: Path, *shown: rrb.View) -> list[str]:
    with recording(path, "it", "it", rrb.Horizontal(*shown, views.summary()), "words") as stream:
        log_series(stream, "belief/left/entropy", np.arange(5.0), 0.02, "left", (255, 0, 0))
        log_series(stream, "belief/right/entropy", np.full(5, np.nan), 0.02, "right", (0, 255, 0))
        log_bars(stream, "bars", np.eye(5), 0.02, np.linspace(-1, 1, 5))
    return empty_views(path)


def test_a_view_of_data_is_not_empty(tmp_path: Path) -> None:
    assert drawn(
        tmp_path / "it.rrd",
        views.series("tree", origin="/belief"),
        views.series("one", "/belief/left/entropy"),
        views.series("all", "/belief/**"),
        views.series("below", "$origin/left/**", origin="/belief"),
        views.bars("bars", "/bars"),
    ) == []  # fmt: skip
    assert {view.name for view in read_back(tmp_path / "it.rrd")} == {"tree", "one", "all", "below", "bars", "summary"}


@pytest.mark.parametrize(
    "view",
    [
        rrb.TimeSeriesView(name="star", contents=["/belief/*/entropy"]),
        rrb.TimeSeriesView(name="nowhere", origin="/beliefs"),
        rrb.TimeSeriesView(name="not a number", origin="/belief/right"),
        rrb.TimeSeriesView(name="other kind", origin="/bars"),
        rrb.BarChartView(name="lines", origin="/belief"),
    ],
    ids=lambda view: str(view.name),
)
def test_a_view_of_nothing_is_found_out(tmp_path: Path, view: rrb.View) -> None:
    with pytest.raises(AssertionError, match="nothing is seen in"):  # what conftest.py holds every recording to
        drawn(tmp_path / "it.rrd", view)


def test_time_goes_on_after_the_end_so_that_names_lie_over_nothing(tmp_path: Path) -> None:
    shown = views.series("tree", origin="/belief"), rrb.StateTimelineView(name="is", origin="/is")
    with recording(
        tmp_path / "it.rrd", "it", "it", rrb.Horizontal(rrb.Vertical(*shown), views.summary()), ""
    ) as stream:
        log_series(stream, "belief/one", np.arange(5.0), 0.5, "one", (255, 0, 0))
        log_states(stream, "is", {"a": None, "b": None}, ["a", "b"], 0.5)
    reader = RrdReader(tmp_path / "it.rrd")
    ends = [
        chunk.to_record_batch().column("TimeAxis:view_range")[0].as_py()[0]["end"]
        for chunk in reader.stream(store=reader.blueprints()[-1])
        if "TimeAxis:view_range" in chunk.to_record_batch().schema.names
    ]
    assert ends == 2 * [round(views.LEGEND_ROOM * 2e9)] and views.LEGEND_ROOM > 1


def test_names_keep_their_colours() -> None:
    names = ["as ever", *"abcdefgh", "more"]
    given = palette.inks(names)
    assert list(given) == names and given["as ever"] == palette.PLAIN and len({*given.values()}) == len(names) - 1
    assert palette.inks(names[:3]).items() <= given.items()
    light, dark, again = palette.shades(["x", "y", "z", "x"], (100, 200, 10)).values()
    assert light == again == (100, 200, 10) and dark == (70, 140, 7)
