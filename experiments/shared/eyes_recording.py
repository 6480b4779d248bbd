"""Pieces of recordings with eyes: images with points on them, a stage with gaze rays."""

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from babbling.axes import FloatArray
from experiments.shared.palette import DEMONSTRATED, EXPECTED, FOUND, IMITATED, Light
from experiments.shared.recording import log_body, log_series, log_stick_figure, png, ticks
from experiments.shared.views import AXES, EYES
from models.onlooker import Onlooked


def log_eyes(
    stream: rr.RecordingStream,
    images: Sequence[tuple[NDArray[np.uint8], NDArray[np.uint8]]],
    tick_s: float,
    found: FloatArray | None = None,
    expected: FloatArray | None = None,
    radii: tuple[float, float] = (0.8, 2.2),
) -> None:
    """What both eyes see, with (T, K, 2 eyes, 2) pixels where things were found and where they were expected."""
    for i, eye in enumerate(EYES):
        shown = rr.EncodedImage.columns(blob=[png(pair[i]) for pair in images], media_type=["image/png"] * len(images))
        stream.send_columns(f"eyes/{eye}", ticks(len(images), tick_s), shown)
        if found is not None and expected is not None:
            log_points(stream, f"eyes/{eye}/predicted", expected[:, :, i], tick_s, EXPECTED, radii[1])
            log_points(stream, f"eyes/{eye}/found", found[:, :, i], tick_s, FOUND, radii[0])


def log_head(
    stream: rr.RecordingStream,
    kind: str,
    angles: FloatArray,
    tick_s: float,
    colour: Light,
    label: str | None = None,
    width: float = 2.0,
) -> None:
    """(T, 2) pan and tilt, rad, as two series in degrees."""
    for axis, values in zip(AXES, np.rad2deg(angles).T, strict=True):
        log_series(stream, f"head/{axis}/{kind}", values, tick_s, label or kind, colour, width)


def log_events(stream: rr.RecordingStream, events: Sequence[tuple[float, str]]) -> None:
    """Seconds, and what happened."""
    index = [rr.TimeColumn("sim_time", duration=np.array([when for when, _ in events]))]
    stream.send_columns("events", index, rr.TextLog.columns(text=[what for _, what in events]))


def log_points(
    stream: rr.RecordingStream, entity: str, points: FloatArray, tick_s: float, colour: Light, radius: float = 1.2
) -> None:
    """(T, K, 2) pixels, NaN for none: dots that come and go."""
    stream.log(entity, rr.Points2D.from_fields(colors=[colour], radii=[radius], draw_order=10.0), static=True)
    rows = [row[np.isfinite(row[:, 0])] + 0.5 for row in points]
    flat = np.concatenate(rows) if sum(map(len, rows)) else np.zeros((0, 2))
    columns = rr.Points2D.columns(positions=flat).partition([len(row) for row in rows])
    stream.send_columns(entity, ticks(len(rows), tick_s), columns)


def log_rings(
    stream: rr.RecordingStream, entity: str, centres: FloatArray, radii: FloatArray, tick_s: float, colour: Light
) -> None:
    """(T, K, 2) pixels and (T, K) radii, NaN for none: circles that come and go."""
    stream.log(entity, rr.LineStrips2D.from_fields(colors=[colour], radii=[0.25], draw_order=9.0), static=True)
    turn = np.linspace(0.0, 2.0 * np.pi, 25)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    rings = centres[:, :, None] + radii[:, :, None, None] * circle + 0.5  # (T, K, 25, 2)
    there = np.isfinite(rings).all((2, 3))
    columns = rr.LineStrips2D.columns(strips=list(rings[there])).partition(there.sum(1))
    stream.send_columns(entity, ticks(len(rings), tick_s), columns)


def log_stage(stream: rr.RecordingStream, seen: Onlooked, tick_s: float) -> None:
    """The robot, the teacher, the table, balls and gazes (lines of 1.2 m), under /world."""
    log_body(stream, "world", seen.parts, tick_s)
    for who, gaze, colour in (("ours", seen.gaze, IMITATED), ("teacher", seen.teacher_gaze, DEMONSTRATED)):
        if gaze is not None:
            start, way = gaze
            ends = np.stack([start, start + 1.2 * way], axis=1)
            log_stick_figure(stream, f"world/gaze/{who}", ends, [(0, 1)], tick_s, colour, 0.003)
