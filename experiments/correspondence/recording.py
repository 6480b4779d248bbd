"""The recording of `imitate correspondence`: two bodies side by side, arrows along their parts, which part moves."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from matplotlib.figure import Figure

from babbling.axes import FloatArray
from experiments.correspondence.found import Studied
from experiments.shared import views
from experiments.shared.figures import spaced
from experiments.shared.palette import DEMONSTRATED, IMITATED, REPLAYED, SERIES, Light
from experiments.shared.recording import log_figure, log_series, log_states, recording
from experiments.shared.side_by_side import Stage, log_arrows, log_imitator, log_teacher
from imitation.correspondence.organ import identify
from models.mirror import Mirror
from models.shapes import parts as shapes

WINDOW_S = 0.5
"""Movements are put to a part by what turned within this time."""
LINES = 5
"""Of probabilities: the parts that most likely move."""


def record(path: Path, done: Studied, summary: str, structure: Figure) -> None:
    """Write the recording."""
    row, body = done.shown, done.clean.body
    name = (
        f"{row.performance.name} ({row.performance.teacher}) through a learned correspondence, seed {done.config.seed}"
    )
    imitator = shapes(body.model, body.configurations(row.clean.angles))
    stage = Stage.of(imitator)
    with recording(path, "imitate-correspondence", name, layout(stage), summary) as stream:
        log_imitator(stream, imitator, body.tick_s, stage.aside, glass=True)
        log_arrows(stream, "imitator", *Mirror(body).arrows(row.clean.angles), body.tick_s, IMITATED)
        log_teacher(stream, row.performance, len(row.clean.angles), body.tick_s, *stage.teacher, arrows=True)
        _log_organ(stream, done)
        log_figure(stream, "structure", structure)


def layout(stage: Stage) -> rrb.Horizontal:
    """World and summary left; organ and errors right, and what moves what in a tab of its own."""
    return views.beside(
        views.framed("where the parts of imitator and teacher point", stage.low, stage.high),
        rrb.StateTimelineView(
            name="which of the teacher's parts moves", origin="/organ", contents=["/organ/identified"]
        ),
        views.series("P(part moves)", origin="/organ/probability", within=views.CHANCE),
        views.series("limb directions off the teacher's, mean [deg]", origin="/error"),
        row_shares=[0.4, 1, 1],
        stage_share=2.2,
        more=[views.picture("what moves what", "/structure")],
    )


def _log_organ(stream: rr.RecordingStream, done: Studied) -> None:
    tick, row = done.clean.body.tick_s, done.shown
    goals, names = row.clean.found, [*map(spaced, done.clean.image.parts), "nothing"]
    window = round(WINDOW_S / tick)
    seen = np.full((len(goals.wanted), len(done.clean.image.parts), 3), np.nan)
    rng = np.random.default_rng([done.config.seed, 18])
    for number, part in enumerate(goals.parts):
        seen[:, done.clean.image.parts.index(part)] = done.noisy.look(row.clean.teacher[:, number], rng)
    found = [
        identify(done.noisy.image.organs, seen[max(t - window, 0) : t + 1], tick) for t in range(window, len(seen))
    ]
    labels = [names[organ.part] for organ in found]
    probability = np.stack([organ.probability for organ in found])
    colours = coloured(names, probability)
    log_states(stream, "organ/identified", colours, labels, tick, window)
    before = np.full(window, np.nan)
    for place in np.argsort(-probability.mean(0), kind="stable")[:LINES]:
        series, part = np.concatenate([before, probability[:, place]]), names[place]
        log_series(stream, f"organ/probability/{part}", series, tick, part, colours[part])
    for label, who, colour in (("clean eyes", row.clean, IMITATED), ("noisy eyes", row.noisy, DEMONSTRATED)):
        log_series(stream, f"error/{label.split()[0]}", who.error_deg.mean(1), tick, f"learned, {label}", colour)
    log_series(stream, "error/oracle", row.oracle.error_deg.mean(1), tick, "inverse kinematics", REPLAYED)


def coloured(names: Sequence[str], probability: FloatArray) -> dict[str, Light]:
    """One colour of each of these, in bars and lines: those of (T, K) most probability have one of their own, the rest
    and nothing (the last) are grey."""
    often = np.argsort(-probability[:, :-1].mean(0), kind="stable")
    own = {names[place]: light for place, light in zip(often, SERIES, strict=False)}
    return {name: own.get(name, REPLAYED) for name in names}
