"""The recording of `imitate objects`: teacher and imitator at their tables, contact, grip, states, the choice."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from matplotlib.figure import Figure

from babbling.axes import FloatArray
from experiments.objects.found import Done
from experiments.objects.options import words
from experiments.shared import views
from experiments.shared.palette import DEMONSTRATED, FEATURES, IMITATED, SERIES, THEIRS, inks, light, shades
from experiments.shared.playing import TICK_S, Tried, at_table
from experiments.shared.recording import log_body, log_figure, log_series, log_states, recording
from imitation.acting.primitives import NAMES
from models.objects import TOYS
from models.objects.playing import MIDDLE, lay
from models.objects.states import STATES, Watched
from models.shapes import parts

PARTS = ("left hand", "right hand", "forehead")
PART_LIGHTS = (light(FEATURES["magenta"]), light(THEIRS), SERIES[2])
"""As they are marked."""
STATE_LIGHTS = {state: light(ink) for state, ink in inks(STATES).items()}
FIGURES = {"choice": "what was chosen, and why", "outcomes": "what play taught"}
"""Those that the recording holds too, and what they are called there."""
BESIDE = 0.75
"""m between imitator and teacher."""


def record(path: Path, done: Done, summary: str, made: Mapping[str, Figure]) -> None:
    """Write the recording."""
    name = f"{words(done.config)}, seed {done.config.seed}"
    with recording(path, "imitate-objects", name, layout(), summary) as stream:
        _log_imitator(stream, done)
        if done.act is not None:
            _log_teacher(stream, done)
        for stem in FIGURES:
            log_figure(stream, f"figures/{stem}", made[stem])


def layout() -> rrb.Horizontal:
    """The tables left; state, touch, grip and places right; the choice and what it rests on in tabs of their own."""
    return views.beside(
        views.world("imitator, and teacher behind", (0.9, -0.3, 0.56), (0.06, 0.25, 0.24)),
        rrb.StateTimelineView(name="what is done, and the object's state", origin="/imitator"),
        views.series("touch [N]", origin="/touch"),
        views.series("grip, at most [N]", origin="/grip"),
        views.series("hands and forehead, above the table [m]", origin="/height"),
        row_shares=[1, 0.9, 0.7, 0.9],
        stage_share=2.2,
        more=[views.picture(name, f"/figures/{stem}") for stem, name in FIGURES.items()],
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
        log_series(stream, f"height/{n}", height, TICK_S, part, PART_LIGHTS[n])
        if n < 2:
            grip = np.concatenate([tried.grips[:, 0, n] for tried in tries])
            log_series(stream, f"grip/{n}", grip, TICK_S, part, PART_LIGHTS[n])
    log_touch(stream, tries)
    states, acts = list[str](), list[str]()
    for tried in tries:
        states += became(tried, toy)
        acts += [NAMES[int(tried.which[0])]] * len(tried.path)
    log_states(stream, "imitator/object", STATE_LIGHTS, states, TICK_S)
    log_states(stream, "imitator/act", shades(acts, IMITATED), acts, TICK_S)
    if done.memory is not None:
        goal = {done.goal: STATE_LIGHTS.get(done.goal, DEMONSTRATED)}
        log_states(stream, "imitator/wants", goal, [done.goal] * len(states), TICK_S)


def log_touch(stream: rr.RecordingStream, tries: Sequence[Tried], waited: int = 0) -> None:
    """What hands and forehead felt, one try after the other, after so many ticks of nothing."""
    for n, part in enumerate(PARTS):
        felt = np.concatenate([np.zeros(waited), *(_felt(tried)[:, 0, n] for tried in tries)])
        log_series(stream, f"touch/{n}", felt, TICK_S, part, PART_LIGHTS[n])


def _felt(tried: Tried) -> FloatArray:
    assert tried.true.touch is not None
    return tried.true.touch


def became(tried: Tried, toy: str, row: int = 0) -> list[str]:
    """The state of an object at every tick, as if all ended there."""
    true, one = tried.true, slice(row, row + 1)
    felt = _felt(tried)
    looks = [
        Watched(true.handles[: t + 1, one], true.parts[: t + 1, one], true.signal[: t + 1, one], felt[: t + 1, one])
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
