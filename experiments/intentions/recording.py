"""The recording of `imitate intentions`: what is shown, what is believed of it, and what is then done."""

from pathlib import Path
from typing import Final

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from babbling.axes import FloatArray
from experiments.intentions.agents import GOALS
from experiments.intentions.figures import LEAST_SHOWN
from experiments.intentions.found import Done
from experiments.intentions.showing import device
from experiments.objects.recording import STATE_LIGHTS, became, log_touch
from experiments.shared import views
from experiments.shared.palette import DEMONSTRATED, IMITATED, QUIET, inks, light, shades
from experiments.shared.playing import LOOKED_AT, TICK_S, at_table
from experiments.shared.recording import log_body, log_series, log_states, log_stick_figure, recording
from imitation.acting.primitives import NAMES
from models.objects.playing import MIDDLE, lay
from models.objects.scene import PREFIX
from models.shapes import parts

BESIDE: Final = 0.75
"""m between imitator and adult."""
GOAL_LIGHTS: Final = [light(ink) for ink in inks(GOALS).values()]
OVER: Final = "over"
WATCHES: Final = "watches"
POLES: Final = ((0, 3), (3, 5), (1, 4), (4, 6))
"""Of an outline: pincers to the ends of their poles."""


def record(path: Path, done: Done, summary: str) -> None:
    """Write the recording."""
    name = f"{done.config.condition}, {done.config.toy}, seed {done.config.seed}"
    with recording(path, "imitate-intentions", name, layout(done), summary) as stream:
        stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        watched = _log_shown(stream, done)
        _log_beliefs(stream, done, watched)
        _log_acts(stream, done, watched)


def layout(done: Done) -> rrb.Horizontal:
    """The tables left; beliefs, object and touch right."""
    return views.beside(
        views.world("imitator, and who shows it behind", (0.9, -0.3, 0.56), (0.06, 0.25, 0.24)),
        views.series("P(goal | somebody pursues one)", origin="/goal", within=views.CHANCE),
        views.series("P(that is somebody)", origin="/somebody", within=views.CHANCE),
        rrb.StateTimelineView(
            name="what is done, and what becomes of the object", contents=["/shown/**", "/imitator/**"]
        ),
        views.series("imitator's touch [N]", origin="/touch"),
        row_shares=[1.4, 0.7, 1.15, 0.8],
        stage_share=2.2,
    )


def _log_shown(stream: rr.RecordingStream, done: Done) -> int:
    """Everything that is shown, one after the other; how many ticks that takes."""
    if done.adult is None:
        return 0
    trials, tried = done.adult
    rows, offset = done.shown.rows, (0.0, BESIDE, 0.0)
    body = at_table(trials.toy, 1, busy=bool(done.shown.hands))
    lay(body.model, tried.laid[rows[0]])
    whole = np.concatenate([tried.configurations[:, row] for row in rows])
    shapes = parts(body.model, whole)
    if done.shown.body != "person":
        outline = np.concatenate([device(trials.outline[row]) for row in rows])
        seen = np.concatenate([n * len(tried.path) + np.array(LOOKED_AT) for n in range(len(rows))])
        shapes = [one for one in shapes if one.name.startswith(PREFIX) or one.name == "world"]
        poles = filled(outline, seen, len(whole)) + np.array(MIDDLE) + np.array(offset)
        log_stick_figure(stream, "world/device", poles, POLES, TICK_S, DEMONSTRATED, 0.008)
    log_body(stream, "world/adult", shapes, TICK_S, offset=offset, tint=DEMONSTRATED)
    states, acts = list[str](), list[str]()
    for presentation, row in zip(done.shown.seen, rows, strict=True):
        states += became(tried, trials.toy, row)
        again = "again at once" if presentation.again else "then left"
        acts += [f"{NAMES[int(trials.which[row])]}, {again}"] * len(tried.path)
    for entity, names, told in (("act", shades(acts, DEMONSTRATED), acts), ("object", STATE_LIGHTS, states)):
        log_states(stream, f"shown/{entity}", {**names, OVER: QUIET}, [*told, OVER], TICK_S)
    return len(whole)


def filled(values: FloatArray, at: FloatArray, count: int) -> FloatArray:
    """(count, P, 3) by straight lines between looks."""
    ticks = np.arange(count)
    flat = values.reshape(len(values), -1)
    return np.stack([np.interp(ticks, at, column) for column in flat.T], 1).reshape(count, *values.shape[1:])


def _log_beliefs(stream: rr.RecordingStream, done: Done, watched: int) -> None:
    """After every presentation; the goal that nobody ever reached has the heaviest line."""
    count = max(len(done.shown.seen), 1)
    ticks = np.minimum(np.arange(watched + sum(len(one.path) for one in done.tries)) * count // max(watched, 1), count)
    after = np.minimum(ticks, len(done.meant.goal) - 1)
    seen = {one.state for one in done.shown.seen}
    likely = [goal for goal in range(len(GOALS)) if done.meant.goal[:, goal].max() > LEAST_SHOWN]
    order = sorted(likely, key=lambda goal: -done.meant.goal[-1, goal])
    for number, goal in enumerate(order):
        never = bool(seen) and goal not in seen
        label = f"{GOALS[goal]}{', never reached' if never else ''}"
        width = 4.0 if never and number == 0 else 2.0
        log_series(stream, f"goal/{number}", done.meant.goal[after, goal], TICK_S, label, GOAL_LIGHTS[goal], width)
    log_series(stream, "somebody/P", done.meant.somebody[after], TICK_S, "P(that is somebody)", IMITATED)


def _log_acts(stream: rr.RecordingStream, done: Done, watched: int) -> None:
    """What the imitator does, after it watched."""
    toy = done.config.toy
    body = at_table(toy, 1)
    lay(body.model, done.tries[0].laid[0])
    acting = np.concatenate([one.configurations[:, 0] for one in done.tries])
    whole = np.concatenate([np.repeat(acting[:1], watched, 0), acting])
    log_body(stream, "world/imitator", parts(body.model, whole), TICK_S)
    states, acts = [WATCHES] * watched, [WATCHES] * watched
    for one, (goal, act, _) in zip(done.tries, done.acts, strict=True):
        states += became(one, toy)
        acts += [f"{act}, for {goal!r}"] * len(one.path)
    log_states(stream, "imitator/act", shades(acts, IMITATED) | {WATCHES: QUIET}, acts, TICK_S)
    log_states(stream, "imitator/object", STATE_LIGHTS | {WATCHES: QUIET}, states, TICK_S)
    log_touch(stream, done.tries, watched)
    labels = ["imitator"] + ([done.shown.body] if watched else [])
    places = [(-0.1, 0.0, 0.45), (-0.1, BESIDE, 0.45)][: len(labels)]
    signs = rr.Points3D(
        places, radii=[0.004], labels=labels, colors=[IMITATED, DEMONSTRATED][: len(labels)], show_labels=True
    )
    stream.log("world/labels", signs, static=True)
