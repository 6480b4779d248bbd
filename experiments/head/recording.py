"""The recordings of `imitate head`: both eyes, the two heads, demonstrated, estimated and imitated angles."""

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from experiments.head.found import Performed, Seen
from experiments.head.options import Config
from experiments.shared.caregiver import FACE, FRAME_S, NUMBERS, Search, Sequences
from experiments.shared.eyes_recording import BACKGROUND, FOUND, PREDICTED, log_images, log_points, log_stage
from experiments.shared.recording import DEMONSTRATED, IMITATED, log_series, recording
from imitation.head_memory import HeadMemory
from imitation.seeing.pose import Appearance
from models.biclops.movements import TICK_S
from models.biclops.room import Ball
from models.heads import stage
from models.onlooker import onlook
from models.robots import head_of

FloatArray = NDArray[np.float64]
AXES = ("pan", "tilt")
ESTIMATED, RAW = (110, 220, 150), (130, 130, 130)
TOYS_OF_ANOTHER_ROOM = (
    Ball("orange", (0.55, 0.30, 0.05), (1.0, 0.45, 0.0), 0.05),
    Ball("cyan", (0.75, -0.25, 0.06), (0.0, 0.9, 0.9), 0.06),
    Ball("violet", (0.45, -0.35, 0.04), (0.5, 0.0, 1.0), 0.04),
)


def record(
    path: Path, config: Config, sequences: Sequences, appearance: Appearance, one: Seen, done: Performed, summary: str
) -> None:
    """Write the recording of one sequence."""
    every = round(FRAME_S / TICK_S)
    frames = np.arange(0, len(one.path), every)
    name = f"{config.robot} imitates {config.movement}, seed {config.seed}"
    later = config.deferred
    model = stage(
        config.robot, teacher=not later, distance=config.distance, balls=TOYS_OF_ANOTHER_ROOM if later else ()
    ).compile()
    balls = {ball.name: np.array(ball.position) for ball in TOYS_OF_ANOTHER_ROOM} if later else {}
    with recording(path, "imitate-head", name, _blueprint(tuple(head_of(config.robot).table), config)) as stream:
        stream.log("summary", rr.TextDocument(summary, media_type=rr.MediaType.MARKDOWN), static=True)
        shape = (len(frames), len(FACE), 2, NUMBERS)
        found = one.numbers[frames].reshape(shape)
        expected = appearance.expect(one.watched.pose[frames]).reshape(shape)
        for i, eye in enumerate(("left", "right")):
            log_images(stream, f"eyes/{eye}", [pair[i] for pair in sequences.images[: len(frames)]], FRAME_S)
            log_points(stream, f"eyes/{eye}/predicted", expected[:, :, i, :2], FRAME_S, PREDICTED, 1.6)
            log_points(stream, f"eyes/{eye}/found", found[:, :, i, :2], FRAME_S, FOUND, 0.7)
        truth = one.truth[frames]
        seen = onlook(model, config.robot, done.imitated[frames], None if later else truth, balls)
        log_stage(stream, seen, FRAME_S)
        for i, axis in enumerate(AXES):
            root = f"head/{axis}"
            log_series(stream, f"{root}/raw", np.rad2deg(one.watched.raw[frames, i]), FRAME_S, "frame alone", RAW, 1.0)
            log_series(
                stream, f"{root}/demonstrated", np.rad2deg(truth[:, i]), FRAME_S, "demonstrated", DEMONSTRATED, 4.0
            )
            log_series(stream, f"{root}/estimated", np.rad2deg(one.watched.pose[:, i]), TICK_S, "estimated", ESTIMATED)
            log_series(stream, f"{root}/imitated", np.rad2deg(done.imitated[:, i]), TICK_S, "imitated", IMITATED)
        used = one.watched.used[frames].astype(float)
        log_series(stream, "seen/numbers", used, FRAME_S, "numbers used", ESTIMATED)
        error = np.rad2deg(np.hypot(*(done.imitated[frames] - truth).T))
        log_series(stream, "error/imitated", error, FRAME_S, "imitated [deg]", IMITATED)


def _blueprint(table: tuple[float, ...], config: Config) -> rrb.Blueprint:
    room = "imitated later, in another room" if config.deferred else "teacher and imitator"
    world = rrb.Spatial3DView(
        name=room, origin="/world", line_grid=False, background=BACKGROUND,
        eye_controls=rrb.EyeControls3D(
            position=[0.1, -1.15, table[2] + 0.62], look_target=[0.36, 0.0, table[2] + 0.16]
        ),
    )  # fmt: skip
    eyes = [rrb.Spatial2DView(name=f"{eye} eye", origin=f"/eyes/{eye}") for eye in ("left", "right")]
    angles = [
        rrb.TimeSeriesView(
            name=f"{axis} [deg]",
            origin=f"/head/{axis}",
            contents=[f"/head/{axis}/{kind}" for kind in ("demonstrated", "estimated", "imitated")],
        )
        for axis in AXES
    ]
    more = rrb.Tabs(
        rrb.TimeSeriesView(name="error [deg]", origin="/error"),
        rrb.TimeSeriesView(name="numbers the filter used", origin="/seen"),
        rrb.TimeSeriesView(name="each frame alone [deg]", contents=["/head/*/raw", "/head/*/demonstrated"]),
        active_tab=0,
    )
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(world, rrb.TextDocumentView(name="summary", origin="/summary"), row_shares=[1.5, 1]),
            rrb.Vertical(rrb.Horizontal(*eyes), *angles, more, row_shares=[1.5, 1, 1, 0.8]),
            column_shares=[1, 1.15],
        ),
        rrb.TimePanel(state="collapsed", timeline="sim_time", play_state="paused"),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
    )


def record_search(path: Path, looked: Search, summary: str) -> None:
    """What was seen while nobody was found."""
    blueprint = rrb.Blueprint(
        rrb.Vertical(
            rrb.Horizontal(*(rrb.Spatial2DView(name=f"{e} eye", origin=f"/eyes/{e}") for e in ("left", "right"))),
            rrb.TimeSeriesView(name="pan [deg]", origin="/head"),
            rrb.TextDocumentView(name="summary", origin="/summary"),
        ),
        rrb.TimePanel(state="collapsed", timeline="sim_time", play_state="paused"),
    )
    with recording(path, "imitate-head", "no face", blueprint) as stream:
        stream.log("summary", rr.TextDocument(summary, media_type=rr.MediaType.MARKDOWN), static=True)
        for i, eye in enumerate(("left", "right")):
            log_images(stream, f"eyes/{eye}", [pair[i] for pair in looked.images], 1.4)
        log_series(stream, "head/pan/imitated", np.rad2deg(looked.pans), 1.4, "pan", IMITATED)


def record_recall(path: Path, config: Config, memory: HeadMemory, imitated: FloatArray, summary: str) -> None:
    """A remembered movement, performed in another room."""
    model = stage(config.robot, balls=TOYS_OF_ANOTHER_ROOM).compile()
    balls = {ball.name: np.array(ball.position) for ball in TOYS_OF_ANOTHER_ROOM}
    blueprint = rrb.Blueprint(
        rrb.Horizontal(
            rrb.Spatial3DView(
                name="from memory", origin="/world", background=BACKGROUND, line_grid=False,
                eye_controls=rrb.EyeControls3D(position=[1.0, -0.8, 0.7], look_target=[0.1, 0.0, 0.2]),
            ),
            rrb.Vertical(
                *(rrb.TimeSeriesView(name=f"{axis} [deg]", origin=f"/head/{axis}") for axis in AXES),
                rrb.TextDocumentView(name="summary", origin="/summary"),
            ),
        ),
        rrb.TimePanel(state="collapsed", timeline="sim_time", play_state="paused"),
    )  # fmt: skip
    with recording(path, "imitate-head", f"{config.robot} from memory", blueprint) as stream:
        stream.log("summary", rr.TextDocument(summary, media_type=rr.MediaType.MARKDOWN), static=True)
        log_stage(stream, onlook(model, config.robot, imitated, None, balls), memory.tick_s)
        for i, axis in enumerate(AXES):
            log_series(
                stream,
                f"head/{axis}/estimated",
                np.rad2deg(memory.pose[:, i]),
                memory.tick_s,
                "remembered",
                ESTIMATED,
                4,
            )
            log_series(stream, f"head/{axis}/imitated", np.rad2deg(imitated[:, i]), memory.tick_s, "imitated", IMITATED)
