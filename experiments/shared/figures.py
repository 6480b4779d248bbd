"""Figures that experiments share."""

from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from typing import Any, ParamSpec

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from babbling.axes import FloatArray
from experiments.shared.judging import Sweep, over_learners
from experiments.shared.palette import CYCLE, DARK, OURS, PLAIN, THEIRS

Rates = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""Panel -> who -> a curve of metrics.json: where (numbers or names), the share there and perhaps its 95 % intervals, in
this order."""
Drawn = ParamSpec("Drawn")
MARKS = "osD^v<>PX"
STYLES = (("o-", OURS), ("s--", THEIRS), ("^:", DARK))


def captioned(caption: str) -> Callable[[Callable[Drawn, Figure]], Callable[Drawn, Figure]]:
    """Of whatever draws a figure: what it shows, in two sentences; it stands under the figure and in the report."""

    def wrap(draw: Callable[Drawn, Figure]) -> Callable[Drawn, Figure]:
        @wraps(draw)
        def drawn(*values: Drawn.args, **named: Drawn.kwargs) -> Figure:
            figure = draw(*values, **named)
            figure.set_label(caption)
            return figure

        return drawn

    return wrap


def spaced(name: str) -> str:
    """A name as people write it."""
    return name.replace("_", " ")


def legend_above(axes: Axes, ncols: int = 4) -> None:
    """What lines are called: between the axes and their title, where nothing is drawn."""
    rows = -(-len(axes.get_legend_handles_labels()[0]) // ncols)
    for side in ("center", "left"):
        if title := axes.get_title(side):
            axes.set_title(title, loc=side, pad=6 + 13 * rows)
    axes.legend(frameon=False, fontsize=8, ncols=ncols, loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0.1)


def learning_curve(
    x: FloatArray | Sequence[float],
    lines: Mapping[str, FloatArray | Sequence[float]],
    labels: tuple[str, str],
    title: str = "",
    level: tuple[str, float] | None = None,
    *,
    log: str = "",
    onto: Axes | None = None,
) -> Figure:
    """What was learned against what it took: lines by name over x, the imitator's own first; `level` is a name and a
    value to compare with. A figure of its own, or the axes of another; `log`: which of them are logarithmic ("xy")."""
    figure = Figure(figsize=(6.5, 4.2), layout="constrained")
    axes = figure.subplots() if onto is None else onto
    for (name, values), (mark, ink) in zip(lines.items(), STYLES, strict=False):
        axes.plot(x, values, mark, color=ink, ms=5, label=name)
    if level is not None:
        axes.axhline(level[1], color=PLAIN, lw=1, ls="--", label=level[0])
    axes.set(xlabel=labels[0], ylabel=labels[1], title=title)
    if "y" not in log:
        axes.set_ylim(0, 1.05 * axes.dataLim.y1)
    for name in log:
        axes.set(**{f"{name}scale": "log"})
        plain(getattr(axes, f"{name}axis"))
    if log:
        axes.grid(alpha=0.25)
    legend_above(axes)
    return figure


def plain(axis: Axis) -> None:
    """A logarithmic axis in plain numbers, enough of them where it is short."""
    low, high = np.sort(axis.get_view_interval())
    few, more = (1.0, 2.0, 5.0), (1.0, 1.5, *range(2, 10))
    axis.set_major_locator(LogLocator(subs=more if high < 5 * low else few if high < 200 * low else (1.0,)))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter("{x:g}")


def rates(
    panels: Rates,
    labels: tuple[str, str],
    level: tuple[str, float] | None = None,
    title: str = "",
    *,
    log: bool = False,
    line: str = "-",
) -> Figure:
    """How often it went well, panels side by side, and a named level; a logarithmic axis begins at none."""
    figure = Figure(figsize=(3.6 * max(len(panels), 2.5) + 0.6, 5.0), layout="constrained")
    row = figure.subplots(1, len(panels), sharey=True, sharex=log, squeeze=False)[0]
    style, drawn = dict[str, tuple[str, str]](), dict[str, Any]()
    for axes, (panel, lines) in zip(row, panels.items(), strict=True):
        for method, curve in lines.items():
            at, share, interval = (*curve.values(), None)[:3]
            style.setdefault(method, (CYCLE[len(style) % len(CYCLE)], MARKS[len(style) % len(MARKS)]))
            ink, mark = style[method]
            spread = None if interval is None else np.clip(np.abs(np.transpose(interval) - share), 0, None)
            how = {
                "ms": 4.5,
                "lw": 1.6,
                "elinewidth": 1,
                "ls": line if len(at) > 1 else "",
                "zorder": 3 - 0.1 * len(drawn),
            }
            drawn[method] = axes.errorbar(at, share, spread, color=ink, marker=mark, **how)
        if level is not None:
            drawn[level[0]] = axes.axhline(level[1], color="black", lw=0.9, ls="--")
        axes.set(xlabel=labels[0], ylim=(-0.03, 1.05))
        axes.tick_params("x", labelsize=8)
        axes.set_title(panel, loc="left", fontsize=11)
        axes.grid(alpha=0.25)
    if log:
        row[0].set_xscale("symlog", linthresh=25, linscale=0.4)
        row[0].set_xlim(-4, None)
    row[0].set_ylabel(labels[1])
    figure.suptitle(title, fontsize=11)
    figure.legend([*drawn.values()], [*drawn], loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return figure


def sweeps(panels: Mapping[str, Sweep], chance: float, ylabel: str, title: str) -> Figure:
    """Panels side by side, by title: how often every rule was right, means and 95 % intervals over learners."""
    drawn, learners = {}, len(next(iter(panels.values())).right)
    for panel, sweep in panels.items():
        mean, half = over_learners(sweep.right)
        ends = np.clip(np.stack([mean - half, mean + half], -1), 0, 1)  # of shares
        curves = zip(sweep.rules, mean, ends, strict=True)
        at = [f"{x:g}" for x in sweep.at]
        drawn[panel] = {rule: {"at": at, "share": share, "interval": interval} for rule, share, interval in curves}
    figure = rates(drawn, ("", f"{ylabel}\nmean and 95 % over {learners} learners"), ("chance", chance), title)
    for axes, sweep in zip(figure.axes, panels.values(), strict=True):
        axes.set_xlabel(sweep.label)
    return figure
