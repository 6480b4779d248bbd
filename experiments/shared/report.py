"""A page for each run: what was found, its figures with their captions, its film, and the command that made it.

One file that opens from disk, without a server, scripts or anything from elsewhere; text is escaped, summaries are
Markdown without HTML of their own.
"""

import base64
import io
import shlex
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from importlib.resources import files
from pathlib import Path
from textwrap import fill
from types import MappingProxyType
from typing import Any, get_type_hints
from weakref import WeakKeyDictionary

import numpy as np
import tyro
from jinja2 import Environment, StrictUndefined, Template
from markdown_it import MarkdownIt
from markupsafe import Markup
from matplotlib.figure import Figure
from matplotlib.image import imread, imsave

from experiments.registry import EXPERIMENTS
from experiments.shared.options import Options
from experiments.shared.palette import DARK

FILMS = {".mp4": "video/mp4", ".gif": "image/gif"}
DPI, LETTERS = 130, 14.5
"""Pixels of a figure, and letters of a caption, to an inch."""
_BARE, _DRAWN = WeakKeyDictionary[Figure, bytes](), WeakKeyDictionary[Figure, bytes]()
FILMED = "The imitator, a ghost where the demonstration has it otherwise, and the teacher beside it."


def page(
    name: str,
    config: Options,
    summary: str,
    figures: Mapping[str, Figure],
    folder: Path,
    provenance: Mapping[str, Any],
    words: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """The report of a run as HTML.

    Args:
        name: of the experiment.
        config: its options.
        summary: Markdown.
        figures: file stem -> figure.
        folder: where the figures' files, the film, metrics.json and perhaps recording.rrd are already.
        provenance: what config.json says besides the options.
        words: Markdown that stands before a figure, by its file stem; captions of films that belong to one,
            film-STEM-1.gif and so on, by theirs.
    """
    drawn = [
        {"stem": stem, "caption": figure.get_label(), "data": bare(figure), "words": _html(words.get(stem, "")),
         "films": _films(folder, f"film-{stem}-[0-9].*", words)}
        for stem, figure in figures.items()
    ]  # fmt: skip
    return _template().render(
        name=name,
        line=EXPERIMENTS[name].line,
        command=command(name, config),
        summary=_html(summary),
        figures=drawn,
        films=_films(folder, "film.*", {"film": FILMED}),
        provenance=provenance,
        recording=(folder / "recording.rrd").exists(),
        metrics=(folder / "metrics.json").read_text(encoding="utf-8"),
    )


def _films(folder: Path, named: str, words: Mapping[str, str]) -> list[dict[str, str]]:
    """Those of such names, with their captions."""
    files = [file for file in sorted(folder.glob(named)) if file.suffix in FILMS]
    return [{"kind": FILMS[file.suffix], "caption": words[file.stem], "data": _inline(file)} for file in files]


def _html(markdown: str) -> Markup:
    return Markup(MarkdownIt("commonmark", {"html": False}).enable("table").render(markdown))


def drawn(figure: Figure) -> bytes:
    """A figure as PNG, its caption (its label) under it: made once, for its file and the recording."""
    if figure not in _DRAWN:
        width = figure.get_size_inches()[0]
        under = Figure(figsize=(width, 1), label="a caption")
        lines = fill(str(figure.get_label()), round(LETTERS * width))
        under.text(0.01, 0, lines, va="bottom", ha="left", fontsize=9, color=DARK)
        _DRAWN[figure] = _stacked(_bare(figure), _png(under))
    return _DRAWN[figure]


def bare(figure: Figure) -> str:
    """A figure without its caption, which stands under it as text."""
    return base64.b64encode(_bare(figure)).decode()


def _bare(figure: Figure) -> bytes:
    if figure not in _BARE:
        _settle(figure)
        _BARE[figure] = _png(figure)
    return _BARE[figure]


def _stacked(*pictures: bytes) -> bytes:
    """PNG, one under the other on white, from the left."""
    parts = [imread(io.BytesIO(one)) for one in pictures]
    height, width = sum(len(one) for one in parts), max(one.shape[1] for one in parts)
    whole, top = np.ones((height, width, 4), np.float32), 0
    for one in parts:
        whole[top : top + len(one), : one.shape[1]] = one
        top += len(one)
    imsave(file := io.BytesIO(), whole, format="png", dpi=DPI)
    return file.getvalue()


def _settle(figure: Figure) -> None:
    """Lay it out, once and for all; or legends go with the figure's edge to where the caption ends."""
    if engine := figure.get_layout_engine():
        engine.execute(figure)
        figure.set_layout_engine("none")
    for legend in figure.legends:
        legend.set_bbox_to_anchor((0, 0, 1, 1), figure.transFigure)


def _png(figure: Figure) -> bytes:
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=DPI, bbox_inches="tight")
    return file.getvalue()


def command(name: str, config: Options) -> str:
    """What to type for the same run: every option that is not what it would be anyway; not where results go."""
    words, kinds = ["imitate", name], get_type_hints(type(config), include_extras=True)
    for field in fields(config):
        value = getattr(config, field.name)
        if value == field.default or field.name in ("out", "quiet"):
            continue
        option = ("no-" if value is False else "") + field.name.replace("_", "-")
        words += [] if tyro.conf.Positional in getattr(kinds[field.name], "__metadata__", ()) else [f"--{option}"]
        words += [] if isinstance(value, bool) else map(str, value if isinstance(value, tuple) else (value,))
    return shlex.join(words)


def _inline(file: Path) -> str:
    return base64.b64encode(file.read_bytes()).decode()


@cache
def _template() -> Template:
    whole = (files("experiments.shared") / "report.html").read_text(encoding="utf-8")
    return Environment(autoescape=True, undefined=StrictUndefined).from_string(whole)
