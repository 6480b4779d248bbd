"""Panels that recordings share."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from babbling.axes import FloatArray
from experiments.shared.palette import GRID, GROUND

Point = tuple[float, float, float]

FRONT = np.array([1.12, 0.0, 0.25])
"""Where onlookers stand: robots look along x."""
FIELD, ASPECT = np.deg2rad(55), 1.15
"""What a 3-D view sees from top to bottom, and its width / height in `beside`."""

EYES, AXES = ("left", "right"), ("pan", "tilt")
GRID_M = 0.1
"""m between the lines on the floor."""
LEGEND_ROOM = 1.3
"""How far time axes go, in times of what there is."""
CHANCE = (0.0, 1.05)
"""Where a probability is drawn."""


def series(
    name: str, *contents: str, origin: str = "/", within: tuple[float, float] | None = None
) -> rrb.TimeSeriesView:
    """Lines through time, what they are called at the right (`with_room`); all under `origin` where nothing is named.
    Rerun 0.41 finds nothing for a `*` in the middle of a path: entities are named one by one."""
    return rrb.TimeSeriesView(
        name=name,
        origin=origin,
        contents=[*contents] or "$origin/**",
        plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop),
        axis_y=None if within is None else rrb.ScalarAxis(range=within, zoom_lock=True),
    )


def bars(name: str, origin: str) -> rrb.BarChartView:
    """A distribution that changes through time; its title says what a legend would."""
    return rrb.BarChartView(name=name, origin=origin, plot_legend=rrb.PlotLegend(visible=False))


def world(name: str, position: Point, look_target: Point, origin: str = "/world") -> rrb.Spatial3DView:
    """What an onlooker sees."""
    controls = rrb.EyeControls3D(position=position, look_target=look_target)
    grid = rrb.LineGrid3D(spacing=GRID_M, color=GRID)
    return rrb.Spatial3DView(name=name, origin=origin, line_grid=grid, background=[*GROUND], eye_controls=controls)


def framed(name: str, low: FloatArray, high: FloatArray) -> rrb.Spatial3DView:
    """`world` from in front and a little above, as near as all between these (3,) corners is in the picture."""
    middle, half = (low + high) / 2, np.maximum((high - low) / 2, 1e-3)
    towards = FRONT / np.linalg.norm(FRONT)  # from the middle to the eye
    right = np.cross((0, 0, 1), towards) / np.hypot(*towards[:2])
    corners = half * np.array(list(product((-1, 1), repeat=3)))
    spread = np.maximum(abs(corners @ right) / ASPECT, abs(corners @ np.cross(towards, right)))
    away = float((corners @ towards + spread / np.tan(FIELD / 2)).max())
    x, y, z = middle + away * towards
    return world(name, (x, y, z), tuple(middle))


def summary() -> rrb.TextDocumentView:
    """The result as a table."""
    return rrb.TextDocumentView(name="summary", origin="/summary")


def events(name: str) -> rrb.TextLogView:
    """What happened when, in words."""
    only = rrb.TextLogColumns(timeline_columns=["sim_time"], text_log_columns=["body"])
    return rrb.TextLogView(name=name, origin="/events", columns=only)


def eyes(picture: NDArray[np.uint8]) -> rrb.Horizontal:
    """What both eyes see in pictures (H, W, 3), and no more: what is expected outside does not shrink them."""
    edges = rrb.VisualBounds2D(x_range=(0, picture.shape[1]), y_range=(0, picture.shape[0]))
    return rrb.Horizontal(
        *(rrb.Spatial2DView(name=f"{eye} eye", origin=f"/eyes/{eye}", visual_bounds=edges) for eye in EYES)
    )


def head_angles(*kinds: str) -> list[rrb.TimeSeriesView]:
    """Pan and tilt, every series of them or only these kinds."""
    return [series(f"{axis} [deg]", *(f"$origin/{kind}" for kind in kinds), origin=f"/head/{axis}") for axis in AXES]


def picture(name: str, origin: str) -> rrb.Spatial2DView:
    """A figure, or another still picture."""
    return rrb.Spatial2DView(name=name, origin=origin)


def beside(
    stage: rrb.View | rrb.Container,
    *right: rrb.View | rrb.Container,
    row_shares: Sequence[float],
    stage_share: float = 1.5,
    right_share: float = 1.15,
    more: Sequence[rrb.View] = (),
) -> rrb.Horizontal:
    """The world and the summary on the left, all else on the right; tabs of their own for what wants all that room."""
    now: rrb.Container = rrb.Vertical(*right, row_shares=[*row_shares], name="through time")
    return rrb.Horizontal(
        rrb.Vertical(stage, summary(), row_shares=[stage_share, 1]),
        rrb.Tabs(now, *more, active_tab=0) if more else now,
        column_shares=[1, right_share],
    )


def with_room(layout: rrb.Container | rrb.View, end: int) -> None:
    """Let the time axes of a layout go on after the `end` (ns or steps): lines are named there, over nothing."""
    if isinstance(layout, rrb.Container):
        for part in layout.contents:
            with_room(part, end)
    elif isinstance(layout, (rrb.TimeSeriesView, rrb.StateTimelineView)):
        beyond = rr.TimeRangeBoundary.absolute(seq=round(LEGEND_ROOM * end))
        axis = rrb.TimeAxis(view_range=rr.TimeRange(rr.TimeRangeBoundary.absolute(seq=0), beyond))
        layout.properties["TimeAxis"] = axis
