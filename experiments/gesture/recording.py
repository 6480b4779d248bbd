"""The recording of `imitate gesture`: teacher and imitator side by side, and every belief on the way."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from matplotlib.figure import Figure

from experiments.gesture.figures import beside_target, chosen_beside, posterior
from experiments.gesture.found import Performed
from experiments.shared import views
from experiments.shared.palette import COMMANDED, DEMONSTRATED, EARLIER, ESTIMATED, IMITATED, REPLAYED, SERIES, TRUE
from experiments.shared.recording import log_bars, log_body, log_figure, log_series, recording
from experiments.shared.side_by_side import Stage, log_imitator, log_teacher
from models.shapes import parts

SHOWN = 4
"""Joints that err most, whose loops are shown."""
FIGURES = {
    "beliefs": "beliefs of all joints",
    "body_schema": "body schema",
    "explanations": "explanations",
    "ringing": "does it shake?",
}
"""Those that the recording holds too, and what they are called there."""


def record(path: Path, done: Performed, summary: str, made: Mapping[str, Figure]) -> None:
    """Write the recording."""
    model, ticks = done.body.model, len(done.imitated)
    # one body in both places: its meshes are made once
    whole = parts(model, np.concatenate([done.body.configurations(x) for x in (done.imitated, done.seen.angles)]))
    imitator, aims = ([part.during(some) for part in whole] for some in (slice(ticks), slice(ticks, None)))
    given = done.seen.teacher is None
    stage, shown = Stage.of(imitator, aims if given else ()), done.worst[:SHOWN]
    with recording(path, "imitate-gesture", done.title, layout(done, shown, stage), summary) as stream:
        log_imitator(stream, imitator, done.body.tick_s, stage.aside)
        log_body(stream, "world/sub-goals", aims, done.body.tick_s, tint=DEMONSTRATED, ghost=True)
        if done.seen.teacher is None:
            log_body(stream, "world/teacher", aims, done.body.tick_s, offset=(0, stage.aside, 0), tint=DEMONSTRATED)
        else:
            log_teacher(stream, done.seen.teacher, len(done.seen.angles), done.body.tick_s, *stage.teacher)
        _log_joints(stream, done)
        for joint in shown:
            _log_loop(stream, done, joint)
        for stem in FIGURES:
            log_figure(stream, f"figures/{stem}", made[stem])


def layout(done: Performed, shown: Sequence[int], stage: Stage) -> rrb.Horizontal:
    """3D left; right what it missed by and, for each of the joints that err most, the loop of Figure 9 and Eq. (1)."""
    joints, units = [done.body.joints[j] for j in shown], [done.body.shown_units[j] for j in shown]
    whole = " or ".join(sorted({*done.body.shown_units}))
    loops = [
        rrb.Vertical(
            views.series(f"{joint} [{unit}]", origin=f"/joints/{joint}"),
            views.series(f"the loop of Figure 9: off its sub-goal [{unit}]", origin=f"/loop/{joint}"),
            rrb.Horizontal(
                views.bars(f"Eq. (1) now: P(command - sub-goal [{unit}])", f"/belief/{joint}/now"),
                views.picture("Eq. (1) through time", f"/belief/{joint}/history"),
            ),
            name=joint,
        )
        for joint, unit in zip(joints, units, strict=True)
    ]
    errors = [views.series(f"error of all joints, root mean square [{whole}]", origin="/error")]
    if done.limb_errors_deg:
        errors.append(views.series("limbs off the teacher's, mean [deg]", origin="/limbs"))
    return views.beside(
        views.framed("imitator, its sub-goals as a ghost; teacher", stage.low, stage.high),
        rrb.Horizontal(*errors),
        rrb.Tabs(*loops, active_tab=0),
        row_shares=[1, 3.4],
        stage_share=2.2,
        right_share=1.35,
        more=[views.picture(name, f"/figures/{stem}") for stem, name in FIGURES.items()],
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
            log_series(stream, f"joints/{joint}/{name}", shown, tick, said, colour, width)
    tries = [one.truth[:, 0] for one in done.attempts]
    runs = [(f"attempt_{n}", one, EARLIER) for n, one in enumerate(tries[:-1], 1)]
    runs += [("replayed", done.replayed, REPLAYED), ("imitated", done.imitated, IMITATED)]
    for name, values, colour in runs:
        for unit in sorted({*units}):
            away = done.away(values)[:, done.joints_in(unit)]
            said = name if len({*units}) == 1 else f"{name}, {'joints' if unit == 'deg' else 'slides'} [{unit}]"
            log_series(stream, f"error/{unit}/{name}", np.sqrt(np.mean(away**2, axis=1)), tick, said, colour)
    shown = {
        "replayed": ("replayed", REPLAYED),
        "least": ("the joints' limit", TRUE),
        "imitated": ("imitated", IMITATED),
    }
    for name, (said, colour) in shown.items():
        if name in done.limb_errors_deg:
            log_series(stream, f"limbs/{name}", done.limb_errors_deg[name].mean(1), tick, said, colour)


def _log_loop(stream: rr.RecordingStream, done: Performed, joint: int) -> None:
    """What went round in the last attempt's loop for one joint, and what Eq. (1) thought of its commands."""
    tick, last, name = done.body.tick_s, done.attempts[-1], done.body.joints[joint]
    factor, scale = done.factors[joint], done.body.shown_scale[joint]
    wanted = done.seen.angles[: len(last.commands), joint]
    felt = last.senses[:, 0, done.learned.mind.pilot.schema.posture[factor]]
    went = {
        "felt": (felt - wanted, IMITATED, 2.5),
        "believed": (last.believed[:, 0, factor, 0] - wanted, ESTIMATED, 1.2),
        "correction (felt bias)": (last.believed[:, 0, factor, 2], SERIES[5], 1.5),
        "target": (0 * wanted, DEMONSTRATED, 1.0),
    }
    for number, (said, (values, colour, width)) in enumerate(went.items()):
        log_series(stream, f"loop/{name}/{number}", scale * values, tick, said, colour, width)
    commanded = scale * last.commands[:, 0, factor]
    log_series(stream, f"joints/{name}/commanded", commanded, tick, "commanded", COMMANDED, 1.0)
    places, mass = beside_target(done, joint)
    chosen = np.zeros_like(mass)
    at = np.abs(chosen_beside(done, joint)[:, None] - places).argmin(1)
    chosen[np.arange(len(mass)), at] = mass.max()
    log_bars(stream, f"belief/{name}/now/chosen", chosen, tick, places, COMMANDED, width=0.3)
    log_bars(stream, f"belief/{name}/now/posterior", mass, tick, places, IMITATED)
    log_figure(stream, f"belief/{name}/history", posterior(done, joint))
