"""Recording of one infant that watches a face and does the same: `recording.rrd`."""

from pathlib import Path
from typing import Final

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from babbling.axes import FloatArray
from babbling.relations import RELATIONS
from experiments.face.judging import WHOSE
from experiments.face.once import ACT_TICKS, TICK_S, Done, Watched, named, slowly
from experiments.shared import views
from experiments.shared.eyes_recording import log_eyes
from experiments.shared.palette import DEMONSTRATED, IMITATED, QUIET, REPLAYED, SERIES
from experiments.shared.recording import log_body, log_series, log_states, recording
from imitation.seeing.face_marks import POINTS
from imitation.seeing.face_template import appear
from models.face.looks import FOCAL_PX, RETINA
from models.shapes import parts

EYES_M: Final = (-0.052, 0.0, -0.002)
"""Where the middle of an infant's head is, seen from between its eyes."""
SHOWN: Final = (0, 1, 2, 4, 5, 6)
"""Relations that have a panel line; the rest is in metrics.json."""


def record(path: Path, done: Done, summary: str) -> None:
    """Write the recording."""
    name = f"{done.config.gesture}, {done.config.strength}, seed {done.config.seed}"
    with recording(path, "imitate-face", name, layout(done), summary) as stream:
        stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        after = 2 * ACT_TICKS * len(done.tried.commands)
        seen = 0 if done.watched is None else _log_watched(stream, done.watched, after)
        _log_tries(stream, done, seen)


def layout(done: Done) -> rrb.Horizontal:
    """Faces and eyes left; beliefs and relations right."""
    eyes = [views.eyes(done.watched.images[0][0])] if done.watched is not None else []
    return views.beside(
        views.world("the infant, left, and who is watched", (0.17, -0.6, 0.14), (0.17, 0.0, -0.01)),
        *eyes,
        views.series("P(organ that moves | seen)", origin="/organ", within=views.CHANCE),
        views.series("relations [widths of the mouth, turns: 90 deg]: seen, then felt", origin="/relations"),
        rrb.StateTimelineView(name="what is done", origin="/doing"),
        row_shares=[*([1.2] if eyes else []), 1.2, 1.2, 0.8],
        stage_share=2.0,
    )


def _log_watched(stream: rr.RecordingStream, watched: Watched, after: int) -> int:
    """What was shown, and beliefs, which last for the ticks after it; how many ticks it took."""
    count = len(watched.configurations)
    model = watched.watcher.onlooker.model
    whole = np.concatenate([watched.configurations, watched.configurations[:1]])  # then it is at rest again
    log_body(stream, "world/adult", parts(model, whole), TICK_S)
    centre = np.array([(RETINA.width - 1) / 2, (RETINA.height - 1) / 2])
    known, shape = watched.watcher.known, (count, 2, len(POINTS), 2)
    looks = np.stack([one.look for one in watched.seen])
    expected = np.stack(
        [
            appear(known.shape, known.pose, look[None], FOCAL_PX, one.tongue)[0]
            for look, one in zip(looks, watched.seen, strict=True)
        ]
    )
    there, thought = ((each[..., :-1].reshape(shape) + centre).swapaxes(1, 2) for each in (watched.numbers, expected))
    log_eyes(stream, watched.images, TICK_S, there, thought, (1.2, 2.6))
    colours = [*SERIES[: len(WHOSE) - 1], REPLAYED]
    for name, colour, belief in zip(WHOSE, colours, watched.organs.T, strict=True):
        log_series(stream, f"organ/{name}", np.pad(belief, (0, after), mode="edge"), TICK_S, name, colour)
    _log_relations(stream, "seen", watched.relations, 0)
    quiet = count - ACT_TICKS
    states = ["at rest"] * quiet + ["acts"] * ACT_TICKS + ["at rest"]
    log_states(stream, "doing/adult", {"at rest": QUIET, "acts": DEMONSTRATED}, states, TICK_S)
    return count


def _log_tries(stream: rr.RecordingStream, done: Done, begin: int) -> None:
    """The tries once more, tick by tick."""
    config, group = done.config, done.group
    model, frames, senses, did = slowly(group.face, done.mind, done.tried.commands[:, 0], config.scramble, config.seed)
    configurations = np.concatenate([np.repeat(frames[:1], begin, 0), frames[1:]])
    doing = ["watches"] * begin + did
    log_body(stream, "world/infant", parts(model, configurations), TICK_S, offset=EYES_M)
    _log_relations(stream, "felt", done.mind.landmarks.relations(senses), begin)
    light = {what: IMITATED if what.startswith("try") else QUIET for what in doing}
    log_states(stream, "doing/infant", light, doing, TICK_S)
    target = np.repeat(done.memory.relations[None], len(senses), 0)
    moved = [k for k in SHOWN if done.memory.moved[k]]
    _log_relations(stream, "target", target, begin, moved)
    signs = rr.Points3D(
        [(-0.06, 0.0, 0.075), (config.distance + 0.06, 0.0, 0.14)][: 1 + (begin > 0)],
        labels=["infant", named(done.watched.shown.gesture) if done.watched else ""][: 1 + (begin > 0)],
        radii=[0.001], colors=[IMITATED, DEMONSTRATED][: 1 + (begin > 0)], show_labels=True,
    )  # fmt: skip
    stream.log("world/labels", signs, static=True)


def _log_relations(
    stream: rr.RecordingStream, kind: str, values: FloatArray, begin: int, some: list[int] | None = None
) -> None:
    """(T, 8) from tick `begin` on, one line each; what is seen and what is felt share colour and axis."""
    blank = np.full((begin, values.shape[1]), np.nan)
    whole = np.concatenate([blank, values])
    width = {"seen": 2.0, "felt": 2.0, "target": 1.0}[kind]
    for k in SHOWN if some is None else some:
        label = f"{RELATIONS[k]}, target" if kind == "target" else RELATIONS[k]
        log_series(stream, f"relations/{kind}_{RELATIONS[k]}", whole[:, k], TICK_S, label, SERIES[k], width)
