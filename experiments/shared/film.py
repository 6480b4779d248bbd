"""A short film: the imitator, a ghost where the demonstration has it otherwise, and the teacher beside it."""

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from importlib import import_module
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from PIL import Image, ImageDraw

from babbling.axes import FloatArray
from experiments.shared.palette import DEMONSTRATED, GROUND
from experiments.shared.progress import progress
from experiments.shared.side_by_side import stick_figure
from models.body import SimulatedBody
from models.film import Filmed, view_of
from models.teachers.performance import Performance

FRAMES_S = 12.5
"""Pictures a second: every fourth tick of 20 ms, and whole hundredths of a second, as a GIF has them."""
SIZES = {"mp4": (480, 360), "gif": (400, 300)}
"""Pixels across and down, by kind of film."""
FINE = 50_000
"""Triangles of meshes beyond which a film has half the pixels across, and half the pictures: every ray costs more."""
COLOURS = 32
"""Of a GIF."""
POINTS = 200
"""Moments at which it is looked how far everything reaches."""


def filmed(
    kind: str | None,
    title: str,
    body: SimulatedBody,
    imitated: FloatArray,
    demonstrated: FloatArray,
    teacher: Performance | None,
) -> dict[str, Callable[[Path], None]]:
    """The film among a result's files, name -> writer; none is nothing.

    Args:
        kind: mp4, gif or None.
        title: said in the picture.
        body: who moves.
        imitated: (T, nq) configurations, one a tick.
        demonstrated: (T, nq) of its ghost.
        teacher: at the imitator's pace; None where joint angles were given.
    """
    if kind is None:
        return {}
    make = {"mp4": write_mp4, "gif": write_gif}[kind]
    return {f"film.{kind}": lambda path: make(path, *shot(title, body, imitated, demonstrated, teacher, SIZES[kind]))}


def shot(
    title: str,
    body: SimulatedBody,
    imitated: FloatArray,
    demonstrated: FloatArray | None = None,
    teacher: Performance | None = None,
    size: tuple[int, int] = SIZES["gif"],
) -> tuple[Iterator[Image.Image], float]:
    """Pictures, and how many a second: fewer and smaller ones of a body with fine meshes. See `filmed`."""
    figure = None if teacher is None else (stick_figure(teacher, len(imitated), body.tick_s), teacher.bones)
    coarse = 2 if body.model.nmeshface > FINE else 1
    rate = FRAMES_S / coarse
    return frames(title, body, imitated, demonstrated, figure, (size[0] // coarse, size[1] // coarse), rate), rate


def frames(
    title: str,
    body: SimulatedBody,
    imitated: FloatArray,
    demonstrated: FloatArray | None,
    figure: tuple[FloatArray, Sequence[tuple[int, int]]] | None,
    size: tuple[int, int],
    rate: float = FRAMES_S,
) -> Iterator[Image.Image]:
    """Pictures one after the other, so many pixels across and down and so many a second; `demonstrated`: no ghost
    where there is none; `figure`: the teacher's (T, K, 3) points and its bones."""
    scene, count = Filmed(body.model, GROUND, DEMONSTRATED), len(imitated)
    some = range(0, count, max(1, count // POINTS))
    moving = [imitated] if demonstrated is None else [imitated, demonstrated]
    reach = [scene.corners(one[t]).reshape(-1, 3) for one in moving for t in some]
    view = view_of(np.concatenate(reach + ([] if figure is None else [figure[0].reshape(-1, 3)])), *size)
    total = max(1, int(count * body.tick_s * rate))
    with progress("filming") as report:
        for number in range(total):
            t = min(round(number / rate / body.tick_s), count - 1)
            picture = Image.fromarray(scene.picture(view, *(one[t] for one in moving)))
            pen = ImageDraw.Draw(picture)
            if figure is not None:
                places = view.pixels(figure[0][t])
                for one, other in figure[1]:
                    pen.line([*places[one], *places[other]], fill=DEMONSTRATED, width=3)
            pen.text((8, size[1] - 18), f"{title}, {number / rate:.1f} s", fill=(220, 220, 220))
            yield picture
            report((number + 1) / total)


def write_mp4(path: Path, pictures: Iterator[Image.Image], rate: float = FRAMES_S) -> None:
    """H.264 where PyAV has it, otherwise MPEG-4."""
    av: Any = import_module("av")  # an extra
    codec = "libx264" if "libx264" in av.codecs_available else "mpeg4"
    with av.open(str(path), "w") as film:
        stream = film.add_stream(codec, rate=Fraction(rate), options={"crf": "20"} if codec == "libx264" else {})
        first = next(pictures)
        (stream.width, stream.height), stream.pix_fmt = first.size, "yuv420p"
        for picture in chain([first], pictures):
            film.mux(stream.encode(av.VideoFrame.from_image(picture)))
        film.mux(stream.encode())


def write_gif(path: Path | BinaryIO, pictures: Iterator[Image.Image], rate: float = FRAMES_S) -> None:
    """Few colours, those of the first picture, for ever."""
    first = next(pictures)
    palette = first.quantize(COLOURS, dither=Image.Dither.NONE)
    more = (one.quantize(palette=palette, dither=Image.Dither.NONE) for one in chain([first], pictures))
    how = {"save_all": True, "append_images": more, "duration": int(1000 / rate), "loop": 0, "optimize": False}
    next(more).save(path, "GIF", **how)
