"""The recording of `imitate correspondence`: two bodies side by side, where their parts point, which part moves."""

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from experiments.correspondence.found import Studied
from experiments.shared import views
from experiments.shared.palette import DEMONSTRATED, IMITATED, REPLAYED, SERIES
from experiments.shared.recording import heat_map, log_picture, log_series, log_states, recording, ticks
from experiments.shared.side_by_side import BESIDE, log_imitator, log_teacher
from imitation.correspondence.organ import identify
from models.shapes import parts as shapes

WINDOW_S = 0.5
"""Movements are put to a part by what turned within this time."""
FAN = 0.13
"""m, length of the arrows."""


def record(path: Path, done: Studied, summary: str) -> None:
    """Write the recording."""
    row = done.shown
    name = (
        f"{row.performance.name} ({row.performance.teacher}) through a learned correspondence, seed {done.config.seed}"
    )
    with recording(path, "imitate-correspondence", name, layout(), summary) as stream:
        body = done.clean.body
        log_imitator(stream, shapes(body.model, body.configurations(row.clean.angles)), body.tick_s)
        log_teacher(stream, row.performance, len(row.clean.angles), body.tick_s)
        _log_directions(stream, done)
        _log_organ(stream, done)
        log_picture(stream, "structure", heat_map(done.noisy.image.organs.information, aspect=2.0))


def layout() -> rrb.Horizontal:
    """World and summary left; organ, errors and structure right."""
    return views.beside(
        views.world("teacher, imitator, and where their parts point", (1.2, 0.75, 0.75), (0.0, 0.28, 0.52)),
        rrb.StateTimelineView(name="which part moves", origin="/organ", contents=["/organ/identified"]),
        views.series("P(part moves)", origin="/organ/probability"),
        views.series("limb-direction error [deg]", origin="/error"),
        rrb.Spatial2DView(name="what moves what (part by factor)", origin="/structure"),
        row_shares=[0.6, 1, 1, 1],
        stage_share=2.2,
        right_share=0.87,
    )


def _log_directions(stream: rr.RecordingStream, done: Studied) -> None:
    """Arrows over either head, arms above legs, left beside right: the state that both bodies share."""
    tick, row = done.clean.body.tick_s, done.shown
    places = {"imitator": (row.clean.shown, 0.0, IMITATED), "teacher": (row.clean.teacher, BESIDE, DEMONSTRATED)}
    for who, (directions, aside, colour) in places.items():
        count = directions.shape[1]
        names = row.clean.found.parts
        upper = np.array([not name.endswith(("thigh", "shank", "foot")) for name in names], float)
        side = np.array([name.startswith("left_") - float(name.startswith("right_")) for name in names])
        origin = np.stack([np.zeros(count), aside + 0.11 * side, 0.68 + 0.2 * upper], 1)
        entity = f"world/directions/{who}"
        stream.log(entity, rr.Arrows3D.from_fields(colors=[colour], radii=[0.006]), static=True)
        columns = rr.Arrows3D.columns(
            vectors=(FAN * directions).reshape(-1, 3), origins=np.tile(origin, (len(directions), 1))
        ).partition([count] * len(directions))
        stream.send_columns(entity, ticks(len(directions), tick), columns)


def _log_organ(stream: rr.RecordingStream, done: Studied) -> None:
    tick, row = done.clean.body.tick_s, done.shown
    goals, names = row.clean.found, (*done.clean.image.parts, "nothing")
    window = round(WINDOW_S / tick)
    seen = np.full((len(goals.wanted), len(done.clean.image.parts), 3), np.nan)
    rng = np.random.default_rng([done.config.seed, 18])
    for number, part in enumerate(goals.parts):
        seen[:, done.clean.image.parts.index(part)] = done.noisy.look(row.clean.teacher[:, number], rng)
    found = [
        identify(done.noisy.image.organs, seen[max(t - window, 0) : t + 1], tick) for t in range(window, len(seen))
    ]
    labels = [names[organ.part] for organ in found]
    log_states(stream, "organ/identified", dict.fromkeys(names), labels, tick, window)
    probability = np.stack([organ.probability for organ in found])
    often = np.argsort(-probability.mean(0))[:5]
    for place, colour in zip(often, SERIES, strict=False):
        series = np.concatenate([np.zeros(window), probability[:, place]])
        log_series(stream, f"organ/probability/{names[place]}", series, tick, names[place], colour)
    for label, who, colour in (("clean eyes", row.clean, IMITATED), ("noisy eyes", row.noisy, DEMONSTRATED)):
        log_series(stream, f"error/{label.split()[0]}", who.error_deg.mean(1), tick, f"learned, {label}", colour)
    log_series(stream, "error/oracle", row.oracle.error_deg.mean(1), tick, "inverse kinematics", REPLAYED)
