"""Panels that recordings share."""

from collections.abc import Sequence

import rerun.blueprint as rrb

from experiments.shared.palette import GROUND

Point = tuple[float, float, float]

EYES, AXES = ("left", "right"), ("pan", "tilt")


def world(name: str, position: Point, look_target: Point, origin: str = "/world") -> rrb.Spatial3DView:
    """What an onlooker sees."""
    controls = rrb.EyeControls3D(position=position, look_target=look_target)
    return rrb.Spatial3DView(name=name, origin=origin, line_grid=False, background=[*GROUND], eye_controls=controls)


def summary() -> rrb.TextDocumentView:
    """The result as a table."""
    return rrb.TextDocumentView(name="summary", origin="/summary")


def eyes() -> rrb.Horizontal:
    """What both eyes see."""
    return rrb.Horizontal(*(rrb.Spatial2DView(name=f"{eye} eye", origin=f"/eyes/{eye}") for eye in EYES))


def head_angles(*kinds: str) -> list[rrb.TimeSeriesView]:
    """Pan and tilt, every series of them or only these kinds."""
    return [
        rrb.TimeSeriesView(
            name=f"{axis} [deg]", origin=f"/head/{axis}", contents=[f"$origin/{kind}" for kind in kinds or ("**",)]
        )
        for axis in AXES
    ]


def beside(
    stage: rrb.Spatial3DView,
    *right: rrb.View | rrb.Container,
    row_shares: Sequence[float],
    stage_share: float = 1.5,
    right_share: float = 1.15,
) -> rrb.Horizontal:
    """The world and the summary on the left, all else on the right."""
    return rrb.Horizontal(
        rrb.Vertical(stage, summary(), row_shares=[stage_share, 1]),
        rrb.Vertical(*right, row_shares=[*row_shares]),
        column_shares=[1, right_share],
    )
