"""Figures that experiments share."""

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from babbling.axes import FloatArray
from experiments.shared.palette import OURS, PLAIN, THEIRS

STYLES = (("o-", OURS), ("s--", THEIRS))


def learning_curve(
    x: FloatArray | Sequence[float],
    lines: Mapping[str, FloatArray | Sequence[float]],
    labels: tuple[str, str],
    title: str = "",
    level: tuple[str, float] | None = None,
    *,
    log: bool = False,
    onto: Axes | None = None,
) -> Figure:
    """What was learned against what it took: lines by name over x, the imitator's own first; `level` is a name and a
    value to compare with. A figure of its own, or the axes of another."""
    figure = Figure(figsize=(6.5, 4.2), layout="constrained")
    axes = figure.subplots() if onto is None else onto
    for (name, values), (mark, ink) in zip(lines.items(), STYLES, strict=False):
        axes.plot(x, values, mark, color=ink, ms=5, label=name)
    if level is not None:
        axes.axhline(level[1], color=PLAIN, lw=1, ls="--", label=level[0])
    axes.set(xlabel=labels[0], ylabel=labels[1], title=title)
    if log:
        axes.set(xscale="log", yscale="log")
        axes.grid(alpha=0.25, which="both")
    else:
        axes.set_ylim(0, None)
    axes.legend(frameon=False)
    return figure
