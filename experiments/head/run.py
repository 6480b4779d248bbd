"""A head watches another head nod, shake and look around, remembers it, and does the same: at once or another day."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray
from babbling.files import save
from babbling.mind import Mind, learn
from babbling.pilot import pilot_minutes
from experiments.head.alone import from_memory, nobody
from experiments.head.distractor import BALLS, IMITATED, Crossed, Kept, Strays, keep_all
from experiments.head.figures import figures
from experiments.head.found import Found, Imitation
from experiments.head.options import Config
from experiments.head.recall import reproduce, reproduce_elsewhere
from experiments.head.recording import record
from experiments.shared import caregiver
from experiments.shared.caregiver import FIND_FACE, FRAME_S, TURN_S, Occlusion, Search, Sequences
from experiments.shared.experiment import Result
from experiments.shared.eyes import open_eyes, reach_of
from experiments.shared.judging import rmse_deg
from experiments.shared.kept import once
from experiments.shared.minds import people_say
from experiments.shared.progress import Report, progress, ticking
from experiments.shared.tables import table
from experiments.shared.trajectories import left
from imitation.deferred import HeadMemory
from imitation.seeing.pose import Watched, watch
from models.biclops.movements import TICK_S, movement
from models.seeing_body import head_fingerprint, watching_body

STUDY_SEQUENCES = 20
MIND_COPIES = 32
BEFORE = 0.5
"""Share of the way to the teacher at which the card passes."""


def run(config: Config) -> Result:
    """Learn, watch, remember, imitate.

    Raises:
        ExperimentError, BodyError, BabblingError: options that cannot be meant.
    """
    config.check()
    if config.memory is not None:
        return from_memory(config)
    with progress("looking for a face") as report:
        looked = _search(config)
    if not looked.found:
        return nobody(config, looked)
    with progress("the caregiver mirrors") as report:
        appearance = once(caregiver.lesson, config, config.lessons, config.seed, config.distance, report=report)
    with progress("babbling with the neck") as report:
        mind = once(_babbled, config, report=report)
    with progress("watching") as report:
        sequences, paths, strays = _watch(config, report) if config.distractor else once(_watch, config, report=report)
    kept: dict[str, list[Kept]] = {}
    if strays is not None:
        with progress("tracking") as report:
            kept = keep_all(strays, [len(p) for p in paths], config.height, appearance, config.seed, report)
    done = []
    with progress("imitating") as report:
        for b, path in enumerate(paths):
            count = len(path)
            numbers = kept[IMITATED][b].numbers if kept else sequences.numbers[:count, b]
            watched = kept[IMITATED][b].watched if kept else watch(appearance, numbers, TICK_S)
            imitated, replayed = once(_perform, config, config.seed + b, mind=mind, watched=watched)
            truth, hidden = sequences.truth[:count, b], sequences.hidden[:count, b]
            done.append(Imitation(truth, numbers, hidden, watched, imitated, replayed))
            report((b + 1) / len(paths))
    crossed = None if strays is None else Crossed(strays, kept, [one.truth for one in done], appearance, config.seed)
    found = Found(config, looked, appearance, mind, sequences.images, done, crossed)
    metrics = _metrics(found)
    summary = _summary(config, metrics) + ("" if crossed is None else crossed.summary)
    return Result(metrics, summary, figures(found), lambda path: record(path, found, summary), _files(found))


def _search(config: Config) -> Search:
    body = open_eyes(
        config, FIND_FACE, copies=1, tick_s=TURN_S, seed=config.seed + 1, teacher=not config.absent,
        distance=config.distance,
    )  # fmt: skip
    body.reset()
    return caregiver.search(body, float(np.deg2rad(config.start_pan_deg)), config.search_s)


def _babbled(config: Config, report: Report) -> Mind:
    neck = watching_body(config.robot, copies=MIND_COPIES, scramble=config.scramble)
    with ticking(neck, report, (pilot_minutes(MIND_COPIES) + config.babbling_minutes) * 60 / neck.tick_s / MIND_COPIES):
        return learn(neck, minutes=config.babbling_minutes, seed=config.seed)


def _watch(config: Config, report: Any) -> tuple[Sequences, list[FloatArray], Strays | None]:
    count = STUDY_SEQUENCES if config.study else config.sequences
    rng = np.random.default_rng([config.seed, 0x5E9])
    name = "random" if config.study else config.movement
    paths = [within_reach(movement(name, rng), config.robot) for _ in range(count)]
    cards = [
        Occlusion(float(rng.uniform(0.8, len(p) * TICK_S - 0.8)), config.occlusion_s, BEFORE * config.distance)
        for p in paths
    ]
    balls = BALLS if config.distractor else ()
    body = open_eyes(
        config, FIND_FACE, copies=count, tick_s=FRAME_S, seed=config.seed + 2, teacher=True, distance=config.distance,
        balls=balls,
    )  # fmt: skip
    if not config.distractor:
        return caregiver.watch_teacher(body, paths, cards, report), paths, None
    strays = Strays(body, [len(p) * TICK_S for p in paths], np.random.default_rng([config.seed, 0x57A]))
    return caregiver.watch_teacher(body, paths, cards, report, move=strays.move, note=strays.note), paths, strays


def within_reach(path: FloatArray, robot: str) -> FloatArray:
    """A teacher minds what the pupil's neck can do: looks up are made as low as need be, alike in each."""
    low = 0.9 * reach_of(robot).low[1]
    up = path[:, 1].min()
    if up >= low:
        return path
    return np.column_stack([path[:, 0], np.where(path[:, 1] < 0, path[:, 1] * low / up, path[:, 1])])


def remembered(config: Config, watched: Watched) -> HeadMemory:
    """What lasts of a watched sequence."""
    whose = head_fingerprint(config.robot, config.scramble)
    return HeadMemory(whose, TICK_S, config.movement, watched.pose, watched.deviation)


def _perform(config: Config, seed: int, mind: Mind, watched: Watched) -> tuple[FloatArray, FloatArray]:
    """(T, 2) true angles: the estimate imitated, and each frame's raw estimate replayed."""
    do = reproduce_elsewhere if config.deferred else reproduce
    imitated = do(remembered(config, watched), mind, config.robot, config.selection, seed, config.scramble)
    body = watching_body(config.robot, scramble=config.scramble)
    body.reset()
    replayed = np.empty_like(imitated)
    for _ in range(100):
        body.act(body.command_angles(watched.raw[:1]))
    for t, pose in enumerate(watched.raw):
        replayed[t] = body.joint_angles[0]
        body.act(body.command_angles(pose[None]))
    return imitated, replayed


def _metrics(found: Found) -> dict[str, Any]:
    config, done = found.config, found.sequences

    def joined(kind: str) -> NDArray[Any]:
        return np.concatenate([getattr(one if hasattr(one, kind) else one.watched, kind) for one in done])

    truth, hidden, pose, live, raw = map(joined, ("truth", "hidden", "pose", "live", "raw"))
    clear = np.where(hidden[:, None], np.nan, truth)
    estimate = rmse_deg(pose, truth)
    metrics: dict[str, Any] = {
        "robot": config.robot,
        "movement": "random" if config.study else config.movement,
        "face_found": True,
        "search_s_simulated": found.looked.seconds,
        "sequences": len(done),
        "frames": int(np.isfinite(truth[:, 0]).sum()),
        "hidden_frames": int((hidden & np.isfinite(truth[:, 0])).sum()),
        "lessons": config.lessons,
        "head_estimate_rmse_deg": estimate,
        "head_live_estimate_rmse_deg": rmse_deg(live, truth),
        "head_raw_estimate_rmse_deg": rmse_deg(raw, truth),
        "head_raw_estimate_in_view_rmse_deg": rmse_deg(raw, clear),
        "head_estimate_in_view_rmse_deg": rmse_deg(pose, clear),
        "head_raw_over_filtered": rmse_deg(raw, truth) / estimate,
        "head_reproduced_rmse_deg": rmse_deg(joined("imitated"), truth),
        "head_reproduced_worst_sequence_deg": max(rmse_deg(one.imitated, one.truth) for one in done),
        "head_raw_replay_rmse_deg": rmse_deg(joined("replayed"), truth),
        "deferred": config.deferred,
    }
    return metrics if found.crossed is None else metrics | found.crossed.metrics


def _files(found: Found) -> dict[str, Callable[[Path], None]]:
    memory, robot = remembered(found.config, found.sequences[0].watched), found.config.robot
    body = watching_body(robot, scramble=found.config.scramble)
    return left(found.trajectories(), csv=found.config.csv) | {
        "memory.nc": lambda path: save(memory, path, {"axis": ("pan", "tilt")}),
        "mind.nc": lambda path: save(found.mind, path, people_say(body), robot=robot),
    }


def _summary(config: Config, metrics: dict[str, Any]) -> str:
    how = "in a new process, from the memory file, in another room" if config.deferred else "at once"
    rows = [
        ("watched", f"{metrics['sequences']} x {metrics['movement']}, {metrics['frames']} frames, face hidden in "
                    f"{metrics['hidden_frames']}"),
        ("estimated pose", f"{metrics['head_estimate_rmse_deg']:.3f} deg RMS (knowing the past only "
                           f"{metrics['head_live_estimate_rmse_deg']:.3f})"),
        ("each frame by itself", f"{metrics['head_raw_estimate_rmse_deg']:.3f} deg, "
                                 f"{metrics['head_raw_over_filtered']:.1f} times as much; in view "
                                 f"{metrics['head_raw_estimate_in_view_rmse_deg']:.3f} against "
                                 f"{metrics['head_estimate_in_view_rmse_deg']:.3f}"),
        (f"imitated, {how}", f"{metrics['head_reproduced_rmse_deg']:.3f} deg from the true movement (worst sequence "
                             f"{metrics['head_reproduced_worst_sequence_deg']:.3f})"),
        ("raw estimate replayed", f"{metrics['head_raw_replay_rmse_deg']:.3f} deg"),
    ]  # fmt: skip
    return f"# {config.robot} imitates a head\n\n{table(rows)}\n"
