"""The figure of `imitate reinforcement`."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from experiments.shared.figures import MARKS, captioned
from experiments.shared.palette import CYCLE, DARK, OURS, PLAIN

LINES = {"direct replay": (PLAIN, "--"), "inverse line": (DARK, ":"), "first attempt": (OURS, "-")}
"""Levels that are drawn."""


@captioned(
    "What a movement is missed by after so many body-minutes, over all copies: geometric mean, band from the best to "
    "the worst seed; none is drawn at half a minute. Points: the imitator, after its pilot, babbling and rehearsal."
)
def body_time(metrics: Mapping[str, Any]) -> Figure:
    """Error against body time, both logarithmic; levels are lines."""
    figure = Figure(figsize=(9.5, 4.8), layout="constrained")
    axes = figure.subplots()
    for (who, curves), ink in zip(metrics["peers"].items(), CYCLE[1:], strict=False):
        spent = [np.maximum([p["minutes"] for p in one], 0.5) for one in curves]
        off = [np.log10([p["error_deg"] for p in one]) for one in curves]
        at = np.geomspace(0.5, min(one[-1] for one in spent), 60)  # where all of them are known
        every = 10 ** np.array([np.interp(np.log(at), np.log(x), y) for x, y in zip(spent, off, strict=True)])
        axes.fill_between(at, every.min(0), every.max(0), color=ink, alpha=0.2, lw=0)
        axes.plot(at, np.exp(np.log(every).mean(0)), color=ink, label=who)
    for number, stage in enumerate(
        ("after its pilot", "after babbling", "after rehearsal")[-len(metrics["ours"][0]) :]
    ):
        points = np.array([[life[number]["minutes"], life[number]["error_deg"]] for life in metrics["ours"]])
        axes.plot(*points.T, MARKS[number], color=OURS, ms=6, label=f"the imitator {stage}")
    for name, (ink, style) in LINES.items():
        axes.axhline(metrics["levels_deg"][name], color=ink, ls=style, lw=1, label=name)
    axes.set(
        xscale="log", yscale="log", xlabel="body-minutes, all copies", ylabel="root mean square of all joints [deg]"
    )
    axes.grid(alpha=0.25, which="both")
    figure.legend(loc="outside right upper", frameon=False, fontsize=8)
    return figure
