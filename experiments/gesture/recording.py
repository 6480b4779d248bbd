"""The recording of `imitate gesture`: teacher and imitator side by side, and every belief on the way."""

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from babbling.axes import FloatArray
from experiments.gesture.found import Performed
from experiments.shared import views
from experiments.shared.palette import DEMONSTRATED, ESTIMATED, IMITATED, REPLAYED, SERIES
from experiments.shared.recording import (
    heat_map,
    log_bars,
    log_body,
    log_picture,
    log_series,
    recording,
)
from experiments.shared.side_by_side import Stage, log_imitator, log_teacher
from models.shapes import parts

SHOWN = 3
"""Joints that move most, whose beliefs are shown."""
REACH = 6.0
"""Standard deviations to either side of the chosen action."""


def record(path: Path, done: Performed, summary: str) -> None:
    """Write the recording."""
    joints = [done.body.joints[j] for j in done.busiest[:SHOWN]]
    model, ticks = done.body.model, len(done.imitated)
    # one body in both places: its meshes are made once
    poses = [done.imitated, done.seen.angles] if done.seen.teacher is None else [done.imitated]
    whole = parts(model, np.concatenate([done.body.configurations(angles) for angles in poses]))
    imitator, shown = ([part.during(some) for part in whole] for some in (slice(ticks), slice(ticks, None)))
    stage = Stage.of(imitator, shown if done.seen.teacher is None else ())
    shows = layout(joints, bool(done.limb_errors_deg), stage)
    with recording(path, "imitate-gesture", done.title, shows, summary) as stream:
        log_imitator(stream, imitator, done.body.tick_s, stage.aside)
        if done.seen.teacher is None:
            log_body(stream, "world/teacher", shown, done.body.tick_s, offset=(0, stage.aside, 0), tint=DEMONSTRATED)
        else:
            log_teacher(stream, done.seen.teacher, len(done.seen.angles), done.body.tick_s, stage.aside, stage.height)
        _log_joints(stream, done)
        _log_beliefs(stream, done)
        _log_babbling(stream, done)


def layout(joints: list[str], limbs: bool, stage: Stage) -> rrb.Horizontal:
    """3D left; limb directions if a teacher showed them, joint angles, posterior, correction right; summary."""
    angles = [rrb.TimeSeriesView(name=joint, origin=f"/joints/{joint}") for joint in joints[:2]]
    if limbs:
        angles[1:] = [rrb.TimeSeriesView(name="limb directions off the teacher's [deg]", origin="/limbs")]
        angles.reverse()
    angles.append(rrb.TimeSeriesView(name="error, all joints", contents=["/error/**"]))
    beliefs = [
        rrb.BarChartView(name=f"P(action), {joints[0]}, about the chosen", origin=f"/belief/{joints[0]}/posterior"),
        rrb.TimeSeriesView(name="felt bias", origin="/correction"),
    ]
    more = rrb.Tabs(
        *(rrb.Spatial2DView(name=f"posterior, {joint}", origin=f"/belief/{joint}/history") for joint in joints),
        rrb.TimeSeriesView(name="entropy [bit]", contents=["/belief/*/entropy"]),
        rrb.TimeSeriesView(name="evidence [log10]", contents=["/belief/*/evidence"]),
        rrb.Spatial2DView(name="body schema", origin="/babbling/body_schema"),
        rrb.Spatial2DView(name="explanations", origin="/babbling/explanations"),
        rrb.Spatial2DView(name="table coverage", origin="/babbling/coverage"),
        active_tab=0,
    )
    return views.beside(
        views.framed("imitator and teacher", stage.low, stage.high),
        *angles,
        rrb.Horizontal(*beliefs),
        more,
        row_shares=[1, 1, 1, 1.1, 1.2],
        stage_share=2.2,
    )


def _log_joints(stream: rr.RecordingStream, done: Performed) -> None:
    tick, units = done.body.tick_s, done.body.shown_units
    for j, joint in enumerate(done.body.joints):
        for name, said, values, colour, width in (
            ("replayed", "replayed", done.replayed, REPLAYED, 1.0),
            ("demonstrated", "sub-goals", done.seen.angles, DEMONSTRATED, 3.0),
            ("imitated", "imitated", done.imitated, IMITATED, 1.5),
        ):
            shown = done.body.shown_scale[j] * values[:, j]
            log_series(stream, f"joints/{joint}/{name}", shown, tick, f"{said} [{units[j]}]", colour, width)
    for name, values, colour in (("imitated", done.imitated, IMITATED), ("replayed", done.replayed, REPLAYED)):
        for unit in sorted({*units}):
            own = np.array(units) == unit
            away = (done.body.shown_scale * (values - done.seen.angles))[:, own]
            said = f"{name}, root mean square of all {'joints' if unit == 'deg' else 'slides'} [{unit}]"
            at = f"error/{name}" if unit == "deg" else f"error/slides/{name}"
            log_series(stream, at, np.sqrt(np.mean(away**2, axis=1)), tick, said, colour)
    shown = {
        "replayed": ("replayed", REPLAYED),
        "least": ("the joints' limit", ESTIMATED),
        "imitated": ("imitated", IMITATED),
    }
    for name, (said, colour) in shown.items():
        if name in done.limb_errors_deg:
            log_series(
                stream, f"limbs/{name}", done.limb_errors_deg[name].mean(1), tick, f"{said}, mean of parts", colour
            )


def _log_beliefs(stream: rr.RecordingStream, done: Performed) -> None:
    tick, last = done.body.tick_s, done.attempts[-1]
    for joint, colour in zip(done.busiest[:SHOWN], SERIES, strict=False):
        factor, name = done.factors[joint], done.body.joints[joint]
        posterior = about_the_chosen(last.candidates[:, factor], last.posterior[:, factor])
        log_bars(stream, f"belief/{name}/posterior", posterior, tick)
        log_picture(stream, f"belief/{name}/history", heat_map(posterior.T[::-1] ** 0.5, aspect=4.0))
        log_series(stream, f"belief/{name}/entropy", last.entropy[:, 0, factor], tick, name, colour)
        evidence = np.log10(np.maximum(last.evidence[:, 0, factor], 1e-30))
        log_series(stream, f"belief/{name}/evidence", evidence, tick, name, colour)
        bias = done.body.shown_scale[joint] * last.believed[:, 0, factor, 2]
        log_series(stream, f"correction/{name}", bias, tick, f"{name} [{done.body.shown_units[joint]}]", colour)


def about_the_chosen(candidates: FloatArray, posterior: FloatArray, bars: int = 91) -> FloatArray:
    """(T, bars) probability mass of (T, A) candidates by how far they lie from the posterior's mean, the same scale at
    every tick: one hump where a joint moves, two where it may stick or slip.
    """
    away = candidates - (candidates * posterior).sum(1, keepdims=True)
    reach = REACH * float(np.median(np.sqrt((posterior * away**2).sum(1))))
    density, places = posterior / np.gradient(away, axis=1), np.linspace(-reach, reach, bars)
    mass = np.stack([np.interp(places, *tick, left=0, right=0) for tick in zip(away, density, strict=True)])
    return np.asarray(mass / np.maximum(mass.sum(1, keepdims=True), 1e-300))


def _log_babbling(stream: rr.RecordingStream, done: Performed) -> None:
    mind = done.learned.mind
    log_picture(stream, "babbling/body_schema", heat_map(mind.pilot.schema.information, aspect=3.0))
    log_picture(stream, "babbling/explanations", heat_map(mind.forward_model.weights[done.factors], aspect=0.5))
    visits = np.log1p(mind.forward_model.table.visits)
    tiles = [visits[done.factors[joint]] for joint in done.busiest[:SHOWN]]
    gap = np.full((1, visits.shape[-1]), visits.max())
    coverage = np.concatenate([part for tile in tiles for part in (tile, gap)][:-1])
    log_picture(stream, "babbling/coverage", heat_map(coverage, "viridis", aspect=3.0))
