"""The recordings of `imitate head`: both eyes, the two heads, demonstrated, estimated and imitated angles."""

from pathlib import Path

import numpy as np
import rerun.blueprint as rrb

from babbling.axes import FloatArray
from experiments.head.found import Performed, Seen
from experiments.head.options import Config
from experiments.shared import views
from experiments.shared.caregiver import FACE, FRAME_S, NUMBERS, Search, Sequences
from experiments.shared.eyes_recording import log_eyes, log_head, log_stage
from experiments.shared.palette import DEMONSTRATED, ESTIMATED, IMITATED, REPLAYED
from experiments.shared.recording import log_series, recording
from imitation.head_memory import HeadMemory
from imitation.seeing.pose import Appearance
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


def record(
    path: Path, config: Config, sequences: Sequences, appearance: Appearance, one: Seen, done: Performed, summary: str
) -> None:
    """Write the recording of one sequence."""
    every = round(FRAME_S / TICK_S)
    frames = np.arange(0, len(one.path), every)
    name = f"{config.robot} imitates {config.movement}, seed {config.seed}"
    later = config.deferred
    toys = TOYS_OF_ANOTHER_ROOM if later else ()
    model = stage(config.robot, teacher=not later, distance=config.distance, balls=toys).compile()
    with recording(path, "imitate-head", name, _layout(config), summary) as stream:
        shape = (len(frames), len(FACE), 2, NUMBERS)
        found = one.numbers[frames].reshape(shape)[..., :2]
        expected = appearance.expect(one.watched.pose[frames]).reshape(shape)[..., :2]
        log_eyes(stream, sequences.images[: len(frames)], FRAME_S, found, expected, (0.7, 1.6))
        truth = one.truth[frames]
        seen = onlook(model, config.robot, done.imitated[frames], None if later else truth, PLACES if later else {})
        log_stage(stream, seen, FRAME_S)
        log_head(stream, "raw", one.watched.raw[frames], FRAME_S, REPLAYED, "frame alone", 1.0)
        log_head(stream, "demonstrated", truth, FRAME_S, DEMONSTRATED, width=4.0)
        log_head(stream, "estimated", one.watched.pose, TICK_S, ESTIMATED)
        log_head(stream, "imitated", done.imitated, TICK_S, IMITATED)
        used = one.watched.used[frames].astype(float)
        log_series(stream, "seen/numbers", used, FRAME_S, "numbers used", ESTIMATED)
        error = np.rad2deg(np.hypot(*(done.imitated[frames] - truth).T))
        log_series(stream, "error/imitated", error, FRAME_S, "imitated [deg]", IMITATED)


def _layout(config: Config) -> rrb.Horizontal:
    height = head_of(config.robot).table[2]
    room = "imitated later, in another room" if config.deferred else "teacher and imitator"
    more = rrb.Tabs(
        rrb.TimeSeriesView(name="error [deg]", origin="/error"),
        rrb.TimeSeriesView(name="numbers the filter used", origin="/seen"),
        rrb.TimeSeriesView(name="each frame alone [deg]", contents=["/head/*/raw", "/head/*/demonstrated"]),
        active_tab=0,
    )
    return views.beside(
        views.world(room, (0.1, -1.15, height + 0.62), (0.36, 0.0, height + 0.16)),
        views.eyes(),
        *views.head_angles("demonstrated", "estimated", "imitated"),
        more,
        row_shares=[1.5, 1, 1, 0.8],
    )


def record_search(path: Path, looked: Search, summary: str) -> None:
    """What was seen while nobody was found."""
    layout = rrb.Vertical(views.eyes(), rrb.TimeSeriesView(name="pan [deg]", origin="/head"), views.summary())
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
