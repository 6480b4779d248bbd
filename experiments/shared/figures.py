"""Figures that experiments share."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from babbling.axes import FloatArray
from experiments.shared.judging import Sweep, over_learners
from experiments.shared.palette import DARK, OURS, PLAIN, THEIRS

STYLES = (("o-", OURS), ("s--", THEIRS), ("^:", DARK))


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


def sweeps(panels: Mapping[str, Sweep], chance: float, ylabel: str, caption: str) -> Figure:
    """Panels side by side, by title: how often every rule was right, means and 95 % intervals over learners."""
    figure = Figure(figsize=(3.1 * len(panels) + 0.8, 4.2), layout="constrained")
    row = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    for axes, (title, sweep) in zip(row, panels.items(), strict=True):
        place = np.arange(len(sweep.at))
        for rule, mean, half, (mark, ink) in zip(sweep.rules, *over_learners(100 * sweep.right), STYLES, strict=True):
            axes.errorbar(place, mean, half, fmt=mark, color=ink, ms=4, lw=1.4, capsize=2, label=rule)
        axes.axhline(100 * chance, color=PLAIN, lw=1, ls="--", label="chance")
        axes.set(title=title, xlabel=sweep.label, xticks=place, xticklabels=[f"{x:g}" for x in sweep.at], ylim=(0, 104))
        axes.title.set_size(10)
    row[0].set_ylabel(f"{ylabel}\nmean and 95 % over {len(next(iter(panels.values())).right)} learners")
    figure.suptitle(caption, fontsize=11)
    figure.legend(*row[0].get_legend_handles_labels(), frameon=False, ncols=4, loc="outside lower center")
    return figure
