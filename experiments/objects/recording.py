"""The recording of `imitate objects`: teacher and imitator at their tables, contact, grip, states, Eq. (1)'s choice."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from experiments.objects.found import Done
from experiments.objects.options import words
from experiments.shared import views
from experiments.shared.palette import DEMONSTRATED, IMITATED, REPLAYED, SERIES
from experiments.shared.playing import TICK_S, Tried, at_table
from experiments.shared.recording import heat_map, log_bars, log_body, log_picture, log_series, log_states, recording
from imitation.acting.primitives import NAMES
from models.objects import TOYS
from models.objects.playing import MIDDLE, lay
from models.objects.states import STATES, Watched
from models.shapes import parts

PARTS = ("left hand", "right hand", "forehead")
BESIDE = 0.75
"""m between imitator and teacher."""


def record(path: Path, done: Done, summary: str) -> None:
    """Write the recording."""
    name = f"{words(done.config)}, seed {done.config.seed}"
    with recording(path, "imitate-objects", name, layout(done), summary) as stream:
        _log_imitator(stream, done)
        if done.act is not None:
            _log_teacher(stream, done)
        _log_tables(stream, done)


def layout(done: Done) -> rrb.Horizontal:
    """The tables left; touch, grip, state and choice right."""
    belief = views.bars(f"Eq. (1): P(primitive | {done.goal})", "/choice")
    taken = views.bars("P(primitive | movement seen)", "/recognised")
    tables = rrb.Spatial2DView(name="P(state | primitive), states across, primitives down", origin="/tables")
    return views.beside(
        views.world("imitator, and teacher behind", (0.9, -0.3, 0.56), (0.06, 0.25, 0.24)),
        rrb.StateTimelineView(name="the imitator's object", origin="/object"),
        views.series("touch [N]", origin="/touch"),
        views.series("grip, at most [N]", origin="/grip"),
        rrb.Horizontal(taken, belief),
        rrb.Tabs(tables, views.series("where its parts are, above the table [m]", origin="/height"), active_tab=0),
        row_shares=[1.1, 0.9, 0.7, 0.9, 1.2],
        stage_share=2.2,
    )


def _log_imitator(stream: rr.RecordingStream, done: Done) -> None:
    """All its acts, one after the other."""
    tries, toy = done.response.tried, done.config.object
    body = at_table(toy, 1, further=done.config.further_m)
    lay(body.model, tries[0].laid[0])
    whole = np.concatenate([tried.configurations[:, 0] for tried in tries])
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    log_body(stream, "world/imitator", parts(body.model, whole), TICK_S)
    for n, part in enumerate(PARTS):
        height = np.concatenate([tried.true.parts[:, 0, n, 2] for tried in tries]) + MIDDLE[2] - body.table
        log_series(stream, f"height/{n}", height, TICK_S, part, SERIES[n])
        if n < 2:
            grip = np.concatenate([tried.grips[:, 0, n] for tried in tries])
            log_series(stream, f"grip/{n}", grip, TICK_S, part, SERIES[n])
    log_touch(stream, tries)
    colours = dict(zip(STATES, [REPLAYED, *SERIES[: len(STATES) - 1]], strict=True))
    states, acts = list[str](), list[str]()
    for tried in tries:
        states += became(tried, toy)
        acts += [NAMES[int(tried.which[0])]] * len(tried.path)
    log_states(stream, "object/state", colours, states, TICK_S)
    log_states(stream, "object/act", dict.fromkeys(acts), acts, TICK_S)
    if done.memory is not None:
        goal = [done.goal] * len(states)
        log_states(stream, "object/remembered", {done.goal: DEMONSTRATED}, goal, TICK_S)
    choice = np.concatenate([np.repeat(done.response.posteriors[:1], len(tried.path), 0) for tried in tries])
    log_bars(stream, "choice", choice, TICK_S)
    if done.memory is not None:
        log_bars(stream, "recognised", np.repeat(done.memory.primitive[None], len(choice), 0), TICK_S)


def log_touch(stream: rr.RecordingStream, tries: Sequence[Tried], waited: int = 0) -> None:
    """What hands and forehead felt, one try after the other, after so many ticks of nothing."""
    for n, part in enumerate(PARTS):
        felt = np.concatenate([np.zeros(waited), *(tried.touch[:, 0, n] for tried in tries)])
        log_series(stream, f"touch/{n}", felt, TICK_S, part, SERIES[n])


def became(tried: Tried, toy: str, row: int = 0) -> list[str]:
    """The state of an object at every tick, as if all ended there."""
    true, one = tried.true, slice(row, row + 1)
    looks = [
        Watched(true.handles[: t + 1, one], true.parts[: t + 1, one], true.signal[: t + 1, one])
        for t in range(len(tried.path))
    ]
    return [STATES[int(TOYS[toy].state(look)[0])] for look in looks]


def _log_teacher(stream: rr.RecordingStream, done: Done) -> None:
    assert done.act is not None
    row = int(done.act.rows[0])
    shown = at_table(done.config.object, 1, robot=done.act.robot, table=done.act.table, further=done.config.further_m)
    lay(shown.model, done.act.tried.laid[row])
    moved = done.act.tried.configurations[:, row]
    offset = (0.0, BESIDE, 0.0)
    log_body(stream, "world/teacher", parts(shown.model, moved), TICK_S, offset=offset, tint=DEMONSTRATED)
    signs = rr.Points3D(
        [(-0.1, 0, 0.45), (-0.1, BESIDE, 0.45)], radii=[0.004], labels=["imitator", "teacher"],
        colors=[IMITATED, DEMONSTRATED], show_labels=True,
    )  # fmt: skip
    stream.log("world/labels", signs, static=True)


def _log_tables(stream: rr.RecordingStream, done: Done) -> None:
    play = done.child.play
    kind = play.kinds.index(TOYS[done.config.object].kind)
    log_picture(stream, "tables", heat_map(play.outcomes.predictive[0, kind, 0], aspect=1.2))
