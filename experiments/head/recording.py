"""The recordings of `imitate head`: both eyes, the two heads, demonstrated, estimated and imitated angles."""

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from babbling.axes import FloatArray
from experiments.head.distractor import BALLS, INKS, Crossed
from experiments.head.found import Found
from experiments.head.options import Config
from experiments.shared import views
from experiments.shared.caregiver import FACE, FRAME_S, NUMBERS, Search
from experiments.shared.eyes_recording import log_eyes, log_head, log_points, log_rings, log_stage
from experiments.shared.palette import DEMONSTRATED, ESTIMATED, EXPECTED, FOUND, IMITATED, REPLAYED, light
from experiments.shared.recording import log_series, log_states, recording
from imitation.deferred import HeadMemory
from models.biclops.movements import TICK_S
from models.biclops.room import Ball
from models.heads import stage
from models.onlooker import onlook
from models.robots import head_of

TOYS_OF_ANOTHER_ROOM = (
    Ball("orange", (0.55, 0.30, 0.05), (1.0, 0.45, 0.0), 0.05),
    Ball("cyan", (0.75, -0.25, 0.06), (0.0, 0.9, 0.9), 0.06),
    Ball("violet", (0.45, -0.35, 0.04), (0.5, 0.0, 1.0), 0.04),
)
PLACES = {ball.name: np.array(ball.position) for ball in TOYS_OF_ANOTHER_ROOM}


def record(path: Path, done: Found, summary: str) -> None:
    """Write the recording of the first sequence."""
    config, one, crossed = done.config, done.sequences[0], done.crossed
    every = round(FRAME_S / TICK_S)
    frames = np.arange(0, len(one.truth), every)
    name = f"{config.robot} imitates {config.movement}, seed {config.seed}"
    later = config.deferred
    balls: dict[str, FloatArray] = PLACES if later else {}
    if crossed is not None:
        crossing = np.array([crossed.strays.places(frame * TICK_S)[0] for frame in frames])
        balls = balls | {ball.name: way for ball, way in zip(BALLS, np.moveaxis(crossing, 1, 0), strict=True)}
    toys = [ball for ball in (*TOYS_OF_ANOTHER_ROOM, *BALLS) if ball.name in balls]
    model = stage(config.robot, teacher=not later, distance=config.distance, balls=toys).compile()
    with recording(path, "imitate-head", name, _layout(config, done.images[0][0]), summary) as stream:
        shape = (len(frames), len(FACE), 2, NUMBERS)
        found = one.numbers[frames].reshape(shape)[..., :2]
        expected = done.appearance.expect(one.watched.pose[frames]).reshape(shape)[..., :2]
        log_eyes(stream, done.images[: len(frames)], FRAME_S, found, expected, (0.7, 1.6))
        truth = one.truth[frames]
        seen = onlook(model, config.robot, one.imitated[frames], None if later else truth, balls)
        log_stage(stream, seen, FRAME_S)
        log_head(stream, "raw", one.watched.raw[frames], FRAME_S, REPLAYED, "frame alone", 1.0)
        log_head(stream, "demonstrated", truth, FRAME_S, DEMONSTRATED, width=4.0)
        log_head(stream, "estimated", one.watched.pose, TICK_S, ESTIMATED)
        for sign, side in ((1, "above"), (-1, "below")):
            edge = one.watched.pose + 2 * sign * one.watched.deviation
            log_head(stream, f"band/{side}", edge, TICK_S, ESTIMATED, "two standard deviations", 0.6)
        log_head(stream, "imitated", one.imitated, TICK_S, IMITATED)
        states = np.where(one.hidden, "hidden by a card", "seen").tolist()
        log_states(stream, "face", {"seen": REPLAYED, "hidden by a card": EXPECTED}, states, TICK_S)
        used = one.watched.used[frames].astype(float)
        log_series(stream, "seen/numbers", used, FRAME_S, "numbers used", ESTIMATED)
        error = np.rad2deg(np.hypot(*(one.imitated[frames] - truth).T))
        log_series(stream, "error/imitated", error, FRAME_S, "imitated", IMITATED)
        if crossed is not None:
            _record_strays(stream, crossed, frames)


def _record_strays(stream: rr.RecordingStream, crossed: Crossed, frames: NDArray[np.intp]) -> None:
    """All that was found, where each filter believed the face's parts to be (rings of two standard deviations), and
    the error of the pose by way of tracking."""
    found = crossed.strays.sightings[: len(frames), 0, ..., :2]  # (T, eyes, K, n, 2)
    for i, eye in enumerate(views.EYES):
        log_points(stream, f"eyes/{eye}/candidates", found[:, i].reshape(len(found), -1, 2), FRAME_S, FOUND, 0.4)
        for name in ("kalman", "particles"):
            kept = crossed.kept[name][0]
            radii = 1.5 + 2.0 * kept.spread[:, i]
            log_rings(stream, f"eyes/{eye}/{name}", kept.place[:, i], radii, FRAME_S, light(INKS[name]))
    for name, runs in crossed.kept.items():
        away = np.rad2deg(np.hypot(*(runs[0].watched.pose - crossed.truths[0])[frames].T))
        log_series(stream, f"tracking/{name}", np.maximum(away, 1e-3), FRAME_S, name, light(INKS[name]))


def _layout(config: Config, picture: NDArray[np.uint8]) -> rrb.Horizontal:
    height = head_of(config.robot).table[2]
    room = "imitated later, in another room" if config.deferred else "imitator, left, and teacher; lines: gaze"
    alone = [
        views.series(f"{axis}, each frame alone [deg]", *(f"$origin/{kind}" for kind in ("raw", "demonstrated")),
                     origin=f"/head/{axis}")
        for axis in views.AXES
    ]  # fmt: skip
    more = rrb.Tabs(
        views.series("error [deg]", origin="/error"),
        views.series("numbers the filter used (of 30)", origin="/seen"),
        rrb.Horizontal(*alone, name="each frame alone"),
        *([views.series("error by tracking [deg]", origin="/tracking")] if config.distractor else []),
        active_tab=0,
    )
    return views.beside(
        views.world(room, (0.1, -1.15, height + 0.62), (0.36, 0.0, height + 0.16)),
        views.eyes(picture),
        *views.head_angles("demonstrated", "estimated", "band/**", "imitated"),
        more,
        rrb.StateTimelineView(name="the face", origin="/face"),
        row_shares=[1.4, 1, 1, 0.9, 0.62],
    )


def record_search(path: Path, looked: Search, summary: str) -> None:
    """What was seen while nobody was found."""
    layout = rrb.Vertical(views.eyes(looked.images[0][0]), views.series("pan [deg]", origin="/head"), views.summary())
    with recording(path, "imitate-head", "no face", layout, summary) as stream:
        log_eyes(stream, looked.images, 1.4)
        log_series(stream, "head/pan/imitated", np.rad2deg(looked.pans), 1.4, "pan", IMITATED)


def record_recall(path: Path, config: Config, memory: HeadMemory, imitated: FloatArray, summary: str) -> None:
    """A remembered movement, performed in another room."""
    model = stage(config.robot, balls=TOYS_OF_ANOTHER_ROOM).compile()
    layout = rrb.Horizontal(
        views.world("from memory", (1.0, -0.8, 0.7), (0.1, 0.0, 0.2)),
        rrb.Vertical(*views.head_angles(), views.summary()),
    )
    with recording(path, "imitate-head", f"{config.robot} from memory", layout, summary) as stream:
        log_stage(stream, onlook(model, config.robot, imitated, None, PLACES), memory.tick_s)
        log_head(stream, "estimated", memory.pose, memory.tick_s, ESTIMATED, "remembered", 4.0)
        log_head(stream, "imitated", imitated, memory.tick_s, IMITATED)
