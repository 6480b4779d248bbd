"""Pieces of recordings with eyes: images with points on them, a stage with gaze rays."""

import io
from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray
from PIL import Image as Picture

from experiments.shared.recording import DEMONSTRATED, IMITATED, log_body, ticks
from models.onlooker import Onlooked

FloatArray = NDArray[np.float64]
FOUND, PREDICTED = (255, 255, 255), (255, 150, 40)
BACKGROUND = (30, 34, 40)


def log_images(stream: rr.RecordingStream, entity: str, images: Sequence[NDArray[np.uint8]], tick_s: float) -> None:
    """One (H, W, 3) image per tick."""
    blobs = []
    for image in images:
        buffer = io.BytesIO()
        Picture.fromarray(image).save(buffer, "PNG")
        blobs.append(buffer.getvalue())
    stream.send_columns(
        entity,
        ticks(len(blobs), tick_s),
        rr.EncodedImage.columns(blob=blobs, media_type=["image/png"] * len(blobs)),
    )


def log_points(
    stream: rr.RecordingStream,
    entity: str,
    points: FloatArray,
    tick_s: float,
    colour: tuple[int, int, int],
    radius: float = 1.2,
) -> None:
    """(T, K, 2) pixels, NaN for none: dots that come and go."""
    stream.log(entity, rr.Points2D.from_fields(colors=[colour], radii=[radius], draw_order=10.0), static=True)
    rows = [row[np.isfinite(row[:, 0])] + 0.5 for row in points]
    flat = np.concatenate(rows) if sum(map(len, rows)) else np.zeros((0, 2))
    columns = rr.Points2D.columns(positions=flat).partition([len(row) for row in rows])
    stream.send_columns(entity, ticks(len(rows), tick_s), columns)


def log_stage(stream: rr.RecordingStream, seen: Onlooked, tick_s: float) -> None:
    """The robot, the teacher, the table, balls and gazes, under /world."""
    log_body(stream, "world", seen.parts, tick_s)
    for name, ball in seen.balls.items():
        shape = rr.Ellipsoids3D(
            half_sizes=[np.repeat(ball.radius, 3)], centers=[ball.place], fill_mode="solid",
            colors=[tuple(int(255 * c) for c in ball.colour)],
        )  # fmt: skip
        stream.log(f"world/balls/{name}", shape, static=True)
    log_ray(stream, "world/gaze/ours", *seen.gaze, tick_s, IMITATED)
    if seen.teacher_gaze is not None:
        log_ray(stream, "world/gaze/teacher", *seen.teacher_gaze, tick_s, DEMONSTRATED)


def log_ray(
    stream: rr.RecordingStream,
    entity: str,
    start: FloatArray,
    way: FloatArray,
    tick_s: float,
    colour: tuple[int, int, int],
    length: float = 1.2,
) -> None:
    """A gaze: (T, 3) starts and unit directions, drawn as a line."""
    strips = np.stack([start, start + length * way], axis=1)
    stream.log(entity, rr.LineStrips3D.from_fields(colors=[colour], radii=[0.003]), static=True)
    stream.send_columns(
        entity, ticks(len(strips), tick_s), rr.LineStrips3D.columns(strips=list(strips)).partition([1] * len(strips))
    )
