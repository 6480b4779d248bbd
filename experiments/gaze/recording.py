"""The recording of `imitate gaze`: both eyes, the table with gaze rays, P(object) through time, the fixations."""

from pathlib import Path

import numpy as np
import rerun.blueprint as rrb

from experiments.gaze.scene import FRAME_S, Following
from experiments.shared import views
from experiments.shared.eyes_recording import log_events, log_eyes, log_head, log_stage
from experiments.shared.palette import BALLS, DEMONSTRATED, ESTIMATED, IMITATED, light
from experiments.shared.recording import log_series, recording
from models.robots import head_of


def record(path: Path, robot: str, one: Following, summary: str, seed: int) -> None:
    """Write the recording of one episode."""
    with recording(path, "imitate-gaze", f"{robot} follows gaze, seed {seed}", _layout(robot, one), summary) as stream:
        log_eyes(stream, one.images, FRAME_S, one.found, one.predicted)
        log_stage(stream, one.seen, FRAME_S)
        for k, name in enumerate(one.names):
            log_series(stream, f"belief/{name}", one.probability[:, k], FRAME_S, name, light(BALLS[name]), 3.0)
        log_head(stream, "demonstrated", one.teacher, FRAME_S, DEMONSTRATED, "the teacher's", 4.0)
        log_head(stream, "estimated", one.estimated[np.isfinite(one.estimated[:, 0])], FRAME_S, ESTIMATED)
        log_head(stream, "imitated", one.own, FRAME_S, IMITATED, "ours")
        log_events(stream, one.events)


def _layout(robot: str, one: Following) -> rrb.Horizontal:
    height = head_of(robot).table[2]
    return views.beside(
        views.world(
            f"the teacher looks at {one.names[one.target]}; lines: gaze",
            (0.15, -1.1, height + 0.85),
            (0.47, 0.0, height + 0.05),
        ),
        views.eyes(one.images[0][0]),
        views.series("P(toy | pose of the teacher's head)", origin="/belief", within=views.CHANCE),
        rrb.Horizontal(*views.head_angles()),
        views.events("what happens"),
        row_shares=[1.5, 1, 0.9, 0.7],
    )
