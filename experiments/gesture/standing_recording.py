"""The recording of `imitate gesture --stand`: the body on its feet, its pressure, and both beliefs."""

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from experiments.gesture.standing_figures import DIRECTIONS
from experiments.gesture.standing_found import Stands
from experiments.shared import views
from experiments.shared.palette import DEMONSTRATED, ESTIMATED, IMITATED, REPLAYED, SERIES
from experiments.shared.recording import log_bars, log_body, log_series, recording, ticks
from experiments.shared.side_by_side import log_imitator, log_teacher
from models.shapes import parts

BARS = ("stay balanced", "match the teacher", "their product")
APART = -0.55
"""m beside the imitator: who was simply sent the sub-goals."""
ARROW = 0.01
"""m of an arrow per N of a push."""


def record(path: Path, stands: Stands, summary: str) -> None:
    """Write the recording."""
    with recording(path, "imitate-gesture-stand", stands.title, layout(), summary) as stream:
        _log_world(stream, stands)
        _log_pressure(stream, stands)
        _log_beliefs(stream, stands)


def layout() -> rrb.Horizontal:
    """The world left; pressure, offsets, beliefs and loads right."""
    series = [views.series(f"pressure {name} [1 = edge]", origin=f"/pressure/{k}") for k, name in enumerate(DIRECTIONS)]
    edges = rrb.Spatial2DView(name="pressure: up is forward", origin="/edges")
    bars = [views.bars(f"{name}: P(offset [deg])", f"/belief/{n}") for n, name in enumerate(BARS)]
    more = rrb.Tabs(
        views.series("lean of the posture [1 = edge]", origin="/lean"),
        views.series("loads under the soles [N]", origin="/loads"),
        active_tab=0,
    )
    return views.beside(
        views.world("imitator, teacher, and who was sent the sub-goals", (1.25, 0.1, 0.5), (0.0, 0.0, 0.25)),
        rrb.Horizontal(edges, rrb.Vertical(*series), column_shares=[1, 1.6]),
        views.series("offset by Eq. (1) [deg]", origin="/offset"),
        rrb.Horizontal(*bars),
        more,
        row_shares=[1.6, 0.8, 1, 1],
        stage_share=2.2,
    )


def _log_world(stream: rr.RecordingStream, stands: Stands) -> None:
    tick, model, ours = stands.body.tick_s, stands.body.model, stands.ours
    log_imitator(stream, parts(model, ours.configurations[:, 0]), tick)
    floor = rr.Boxes3D(
        half_sizes=[(0.9, 1.4, 0.002)], centers=[(0, 0, -0.002)], colors=[(70, 74, 80)], fill_mode="solid"
    )
    stream.log("world/floor", floor, static=True)
    sent = stands.done["replay"]
    log_body(stream, "world/replay", parts(model, sent.configurations[:, 0]), tick, offset=(0, APART, 0), tint=REPLAYED)
    sign = rr.Points3D(
        [(0, APART, 0)], radii=[0.004], labels=["sent the sub-goals"], colors=[REPLAYED], show_labels=True
    )
    stream.log("world/labels/replay", sign, static=True)
    if stands.seen.teacher is not None:
        log_teacher(stream, stands.seen.teacher, len(ours.configurations), tick)
    if ours.pushes.any():
        places = ours.configurations[:, 0, :3] - ARROW * ours.pushes[:, 0]
        stream.log("world/push", rr.Arrows3D.from_fields(colors=[(255, 60, 60)], radii=[0.006]), static=True)
        arrows = rr.Arrows3D.columns(vectors=ARROW * ours.pushes[:, 0], origins=places)
        stream.send_columns("world/push", ticks(len(places), tick), arrows)


def _log_pressure(stream: rr.RecordingStream, stands: Stands) -> None:
    tick, ours = stands.body.tick_s, stands.ours
    felt = stands.pressed(ours.loads[:, 0])
    foretold, lean = (stands.sides * values[: len(felt), 0] for values in (ours.foretold, ours.plan.lean + ours.stays))
    for k in range(2):
        log_series(stream, f"pressure/{k}/felt", felt[:, k], tick, "felt", IMITATED)
        log_series(stream, f"pressure/{k}/foretold", foretold[:, k], tick, "foretold", ESTIMATED)
        log_series(stream, f"lean/{k}", lean[:, k], tick, DIRECTIONS[k], SERIES[k])
        log_series(stream, f"offset/{k}", np.rad2deg(ours.plan.offset[:, 0, k]), tick, DIRECTIONS[k], SERIES[k])
    for n, cell in enumerate(stands.body.senses["touch"].labels):
        name = cell.removesuffix("_load")
        log_series(stream, f"loads/{name}", ours.loads[:, 0, n], tick, name.replace("_", " "), SERIES[n % len(SERIES)])
    square = [[(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]]
    stream.log("edges/soles", rr.LineStrips2D(square, colors=[(200, 200, 200)], radii=[0.01]), static=True)
    for name, values, colour in (("foretold", foretold, ESTIMATED), ("felt", felt, IMITATED)):
        places = -values[:, ::-1]  # pictures count down and to the right
        stream.log(f"edges/{name}", rr.Points2D.from_fields(colors=[colour], radii=[0.05]), static=True)
        stream.send_columns(f"edges/{name}", ticks(len(places), tick), rr.Points2D.columns(positions=places))


def _log_beliefs(stream: rr.RecordingStream, stands: Stands) -> None:
    """Both terms of Eq. (1) over the offsets of the first direction, and their product."""
    tick, balancer, lean = stands.body.tick_s, stands.balancer, stands.ours.plan.lean[:, 0]
    [term] = balancer.terms(lean, stands.ours.plan.goal[:, 0])
    actions = np.broadcast_to(balancer.balance.forward_model.action.points[:, None], (2, len(lean), 65))
    balanced = term.likelihood(np.moveaxis(actions, -1, 0).swapaxes(1, 2))[..., 0].T ** float(np.max(term.weight))
    match = np.broadcast_to(balancer.match[0], balanced.shape)
    places = np.rad2deg(balancer.balance.forward_model.action.points[0])
    for number, (rows, colour) in enumerate(
        ((balanced, IMITATED), (match, DEMONSTRATED), (balanced * match, IMITATED))
    ):
        shares = rows / np.maximum(rows.sum(1, keepdims=True), 1e-300)
        log_bars(stream, f"belief/{number}", shares, tick, places, colour)
