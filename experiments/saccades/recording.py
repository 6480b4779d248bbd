"""The recording of `imitate saccades`: what both eyes see, what was found and expected, the head in its room."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from experiments.shared.eyes import SACCADE_S
from experiments.shared.eyes_recording import BACKGROUND, FOUND, PREDICTED, log_images, log_points, log_stage
from experiments.shared.recording import log_series, recording
from models.onlooker import Onlooked

if TYPE_CHECKING:
    from experiments.saccades.run import Glance


def record(
    path: Path, seen: Onlooked, table: tuple[float, ...], glances: list[Glance], summary: str, name: str
) -> None:
    """Write the recording."""
    with recording(path, "imitate-saccades", name, _blueprint(table)) as stream:
        stream.log("summary", rr.TextDocument(summary, media_type=rr.MediaType.MARKDOWN), static=True)
        for i, eye in enumerate(("left", "right")):
            log_images(stream, f"eyes/{eye}", [g.images[i] for g in glances], SACCADE_S)
            columns = slice(2 * i, 2 * i + 2)
            predicted, found = (
                np.stack([getattr(g, part)[:, columns] for g in glances]) for part in ("predicted", "found")
            )
            log_points(stream, f"eyes/{eye}/predicted", predicted, SACCADE_S, PREDICTED, 2.2)
            log_points(stream, f"eyes/{eye}/found", found, SACCADE_S, FOUND, 1.0)
        log_stage(stream, seen, SACCADE_S)
        for axis, column, colour in (("pan", 0, (120, 170, 255)), ("tilt", 1, (255, 140, 40))):
            angles = np.rad2deg([g.angles[column] for g in glances])
            log_series(stream, f"head/{axis}/imitated", angles, SACCADE_S, axis, colour)
        index = [rr.TimeColumn("sim_time", duration=np.arange(len(glances)) * SACCADE_S)]
        stream.send_columns("events", index, rr.TextLog.columns(text=[g.event for g in glances]))


def _blueprint(table: tuple[float, ...]) -> rrb.Blueprint:
    world = rrb.Spatial3DView(
        name="head and toys", origin="/world", line_grid=False, background=BACKGROUND,
        eye_controls=rrb.EyeControls3D(
            position=[-0.9, -0.9, table[2] + 0.8], look_target=[0.35, 0.0, table[2] + 0.2]
        ),
    )  # fmt: skip
    eyes = [rrb.Spatial2DView(name=f"{eye} eye", origin=f"/eyes/{eye}") for eye in ("left", "right")]
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(world, rrb.TextDocumentView(name="summary", origin="/summary"), row_shares=[1.6, 1]),
            rrb.Vertical(
                rrb.Horizontal(*eyes),
                rrb.TimeSeriesView(name="pan and tilt [deg]", origin="/head"),
                rrb.TextLogView(name="fixations", origin="/events"),
                row_shares=[1.4, 1, 0.9],
            ),
            column_shares=[1, 1.2],
        ),
        rrb.TimePanel(state="collapsed", timeline="sim_time", play_state="paused"),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
    )
