"""Figures of the benchmark: everyone on every body, and the learning curve."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullFormatter

from experiments.shared.figures import captioned
from experiments.shared.palette import CYCLE, DARK, OURS, PLAIN, THEIRS

_LINES = dict(zip(("average", "table", "inverse_line", "forward_line", "feature_line", "feature_line_forward"),
                  (OURS, DARK, PLAIN, CYCLE[2], THEIRS, CYCLE[3]), strict=True))  # fmt: skip


def drawn(metrics: Mapping[str, Any]) -> dict[str, Figure]:
    """By file stem."""
    found = {"errors": errors(metrics["errors_deg"])}
    grown = {name.partition("_")[2] or "ideal": models for name, models in metrics.items() if name.startswith("curve")}
    return found | ({"curve": curve(grown)} if grown else {})


@captioned(
    "Error of everyone on every body: a point for every seed and movement, a bar at their mean. Left of the "
    "imitator's are what is left of it without parts, then simpler peers."
)
def errors(of_bodies: Mapping[str, Any]) -> Figure:
    """Bodies below each other, models beside each other: a point for every seed and clip, a bar at their mean."""
    figure = Figure(figsize=(10, 1 + 1.7 * len(of_bodies)), layout="constrained")
    rows = figure.subplots(len(of_bodies), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (body, clips) in zip(rows, of_bodies.items(), strict=True):
        models = list(next(iter(clips.values())))
        for x, model in enumerate(models):
            ink = OURS if model.startswith("average") else THEIRS
            values = np.array([one[model] for one in clips.values()])  # (clips, seeds)
            places = x + np.linspace(-0.3, 0.3, len(values))[:, None] + 0 * values
            axes.plot(places.ravel(), values.ravel(), "o", color=ink, ms=2.5, alpha=0.6)
            axes.hlines(values.mean(), x - 0.38, x + 0.38, color=ink, lw=1.6)
        axes.set(yscale="log", ylabel=f"{body} [deg]")
        axes.grid(alpha=0.25, axis="y", which="both")
        axes.set_xticks(np.arange(len(models)), models, rotation=25, ha="right")
    rows[0].set_title("Joint error of every seed and clip (in order), and their mean; same experience, same loop")
    return figure


@captioned(
    "Error of imitation after so many body-minutes of babbling, the pilot's counted: mean over movements and seeds, "
    "bands from the least to the greatest of the seeds. Before 2.3 minutes points are lives of fewer bodies."
)
def curve(of_bodies: Mapping[str, Any]) -> Figure:
    """Error against body-minutes, pilot included: mean over seeds, and from the least to the greatest."""
    figure = Figure(figsize=(5.2 * len(of_bodies), 4.4), layout="constrained")
    row = figure.subplots(1, len(of_bodies), sharey=True, squeeze=False)[0]
    for axes, (body, models) in zip(row, of_bodies.items(), strict=True):
        for model, (minutes, values) in models.items():
            low, mean, high = (by(np.array(values), axis=1) for by in (np.min, np.mean, np.max))
            axes.plot(minutes, mean, "o-", color=_LINES[model], ms=3, lw=2 if model == "average" else 1.2, label=model)
            axes.fill_between(minutes, low, high, color=_LINES[model], alpha=0.15, lw=0)
        axes.set(xscale="log", yscale="log", xlabel="body-minutes, pilot included", title=body)
        axes.grid(alpha=0.25, which="both")
        axes.xaxis.set_major_locator(FixedLocator([0.3, 1, 3, 10, 30, 100]))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
    row[0].set_ylabel("joint error, mean over clips [deg]")
    figure.legend(*row[0].get_legend_handles_labels(), frameon=False, fontsize=8, loc="outside lower center", ncols=6)
    figure.suptitle("What more babbling is worth: mean and range over seeds", fontsize=11)
    return figure
