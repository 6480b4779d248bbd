"""The recording of `imitate notice`: a hand takes up a weight, and the surprise of every joint."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from experiments.notice.trials import Changed
from experiments.shared import views
from experiments.shared.palette import IMITATED, REPLAYED, SERIES
from experiments.shared.recording import log_body, log_series, log_states, recording
from models.body import SimulatedBody
from models.shapes import parts

SHOWN = 5
"""Joints that were surprised most."""


def record(path: Path, done: Changed, body: SimulatedBody, limit: float, joints: Sequence[str], summary: str) -> None:
    """Write the recording of the first case."""
    whole, surprise = done.whole["average"][:, 0], done.surprise["average"][:, 0]
    layout = views.beside(
        views.world("imitator", (1.0, 0.0, 0.5), (0.0, 0.0, 0.3)),
        views.series("surprise of the body [nat]", origin="/body"),
        views.series("surprise of the joints [nat]", origin="/joints"),
        rrb.StateTimelineView(name="what happens", origin="/change"),
        row_shares=[1, 1.4, 0.5],
    )
    with recording(path, "imitate-notice", f"{body.name} takes up a weight", layout, summary) as stream:
        stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        log_body(stream, "world/imitator", parts(body.model, body.configurations(done.heard.angles)), body.tick_s)
        log_series(stream, "body/surprise", whole, body.tick_s, "whole body", IMITATED)
        log_series(stream, "body/limit", np.full(len(whole), limit), body.tick_s, "alarm from here on", REPLAYED, 1.0)
        most = np.argsort(-surprise.max(0))[:SHOWN]
        for joint, light in zip(most, SERIES, strict=False):
            log_series(stream, f"joints/{joints[joint]}", surprise[:, joint], body.tick_s, joints[joint], light)
        noticed = np.maximum.accumulate((whole > limit) & (np.arange(len(whole)) > done.at[0]))
        names = np.where(noticed, "noticed", np.where(np.arange(len(whole)) > done.at[0], "changed", "as it was"))
        colours = {"as it was": REPLAYED, "changed": SERIES[3], "noticed": IMITATED}
        log_states(stream, "change", colours, names.tolist(), body.tick_s)
