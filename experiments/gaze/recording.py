"""The recording of `imitate gaze`: both eyes, the table with gaze rays, P(object) through time, the fixations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from experiments.gaze.scene import FRAME_S, Episode
from experiments.shared.eyes_recording import BACKGROUND, FOUND, PREDICTED, log_images, log_points, log_stage
from experiments.shared.recording import DEMONSTRATED, IMITATED, log_series, recording
from models.robots import head_of

COLOURS = {"orange": (255, 150, 30), "lime": (150, 230, 30), "cyan": (0, 220, 220), "violet": (160, 90, 255)}
ESTIMATED = (110, 220, 150)


def record(path: Path, robot: str, one: Episode, summary: str, seed: int) -> None:
    """Write the recording of one episode."""
    with recording(path, "imitate-gaze", f"{robot} follows gaze, seed {seed}", _blueprint(robot, one)) as stream:
        stream.log("summary", rr.TextDocument(summary, media_type=rr.MediaType.MARKDOWN), static=True)
        for i, eye in enumerate(("left", "right")):
            log_images(stream, f"eyes/{eye}", [pair[i] for pair in one.images], FRAME_S)
            log_points(stream, f"eyes/{eye}/predicted", one.predicted[:, :, i], FRAME_S, PREDICTED, 2.2)
            log_points(stream, f"eyes/{eye}/found", one.found[:, :, i], FRAME_S, FOUND, 0.8)
        log_stage(stream, one.seen, FRAME_S)
        for k, name in enumerate(one.names):
            log_series(stream, f"belief/{name}", one.probability[:, k], FRAME_S, f"P({name})", COLOURS[name], 3.0)
        watched = np.isfinite(one.estimated[:, 0])
        for i, axis in enumerate(("pan", "tilt")):
            root = f"head/{axis}"
            log_series(
                stream,
                f"{root}/demonstrated",
                np.rad2deg(one.teacher[:, i]),
                FRAME_S,
                "the teacher's",
                DEMONSTRATED,
                4.0,
            )
            seen = np.rad2deg(one.estimated[watched, i])
            log_series(stream, f"{root}/estimated", seen, FRAME_S, "estimated", ESTIMATED)
            log_series(stream, f"{root}/imitated", np.rad2deg(one.own[:, i]), FRAME_S, "ours", IMITATED)
        times = np.array([when for when, _ in one.events])
        index = [rr.TimeColumn("sim_time", duration=times)]
        stream.send_columns("events", index, rr.TextLog.columns(text=[what for _, what in one.events]))


def _blueprint(robot: str, one: Episode) -> rrb.Blueprint:
    table = head_of(robot).table
    world = rrb.Spatial3DView(
        name=f"the teacher looks at {one.names[one.target]}", origin="/world", line_grid=False, background=BACKGROUND,
        eye_controls=rrb.EyeControls3D(
            position=[0.15, -1.1, table[2] + 0.85], look_target=[0.47, 0.0, table[2] + 0.05]
        ),
    )  # fmt: skip
    eyes = [rrb.Spatial2DView(name=f"{eye} eye", origin=f"/eyes/{eye}") for eye in ("left", "right")]
    angles = [rrb.TimeSeriesView(name=f"{axis} [deg]", origin=f"/head/{axis}") for axis in ("pan", "tilt")]
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(world, rrb.TextDocumentView(name="summary", origin="/summary"), row_shares=[1.5, 1]),
            rrb.Vertical(
                rrb.Horizontal(*eyes),
                rrb.TimeSeriesView(name="P(object | head)", origin="/belief"),
                rrb.Horizontal(*angles),
                rrb.TextLogView(name="what happens", origin="/events"),
                row_shares=[1.5, 1, 0.9, 0.7],
            ),
            column_shares=[1, 1.2],
        ),
        rrb.TimePanel(state="collapsed", timeline="sim_time", play_state="paused"),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
    )
