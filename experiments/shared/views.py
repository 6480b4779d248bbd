"""Panels that recordings share."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import rerun.blueprint as rrb

from babbling.axes import FloatArray
from experiments.shared.palette import GROUND

Point = tuple[float, float, float]

FRONT = np.array([1.12, 0.0, 0.25])
"""Where onlookers stand: robots look along x."""
FIELD, ASPECT = np.deg2rad(55), 1.15
"""What a 3-D view sees from top to bottom, and its width / height in `beside`."""

EYES, AXES = ("left", "right"), ("pan", "tilt")


def world(name: str, position: Point, look_target: Point, origin: str = "/world") -> rrb.Spatial3DView:
    """What an onlooker sees."""
    controls = rrb.EyeControls3D(position=position, look_target=look_target)
    return rrb.Spatial3DView(name=name, origin=origin, line_grid=False, background=[*GROUND], eye_controls=controls)


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
