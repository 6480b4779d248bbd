"""Figures of faces."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.face.power_figure import power_figure
from experiments.face.study import Studied
from experiments.face.theories import GESTURES, LABELS, SAID
from experiments.shared.figures import captioned, legend_above
from experiments.shared.palette import DARK, OURS, PLAIN, THEIRS

LEAST = 0.004
"""Share that is written into a cell."""


def study_figures(found: Studied, m: dict[str, Any]) -> dict[str, Figure]:
    """Confusion, convergence and course, power beside false positives."""
    return {"imitated": imitated(m), "power": power_figure(found.powers)}


@captioned(
    "What infants who never saw their own face did of what they were shown (per cent, strong acts above weak "
    "ones), how tries converge, and how soon they know whose organ moves. Bands are quartiles over looks."
)
def imitated(m: dict[str, Any]) -> Figure:
    """What was done of what was shown; how tries converge; how the organ is found while an act goes on."""
    figure = Figure(figsize=(13.5, 4.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3, width_ratios=[1.35, 1, 1])
    matrix(left, m)
    for name, ink, label in (
        ("match_error_share", OURS, "fresh"), ("match_error_share_worn", THEIRS, "worn: play and a sigmoid"),
    ):  # fmt: skip
        tries = np.arange(1, len(m[name]) + 1)
        low, high = np.array(m[f"{name}_interval"]).T
        middle.plot(tries, m[name], "o-", color=ink, label=label)
        middle.fill_between(tries, low, high, color=ink, alpha=0.15, lw=0)
        middle.plot(1, m[f"{name}_line"], "x", color=ink, ms=8, label=f"{label}: a line instead of the table")
    middle.set(xlabel="try", ylabel="missed, share of the range", yscale="log", title="correction without feedback")
    legend_above(middle, 2)
    over = m["organ_over_the_act"]
    for strength, ink, line in (("strong", OURS, "-"), ("weak", THEIRS, "--")):
        right.plot(1e3 * np.array(over["time"]), over[f"probability_{strength}"], f"o{line}", color=ink, label=strength)
    right.set(xlabel="time into the act [ms]", ylabel="P(the organ that moves)", ylim=(0, 1.02), title="organ first")
    legend_above(right)
    figure.suptitle(
        f"{m['infants']} infants that never saw their own face. Bands: quartiles over looks. "
        "Cells: % of strong (below: weak) acts shown, at the last try.",
        fontsize=9,
    )
    return figure


def matrix(axes: Axes, m: dict[str, Any]) -> None:
    """Shown by done, strong above weak in every cell."""
    strong, weak = (
        np.array([[m[key][row][col] for col in SAID] for row in GESTURES]) for key in ("confusion", "confusion_weak")
    )
    axes.imshow((strong + weak) / 2, cmap="Greys", vmin=0, vmax=1.4)
    for i in range(len(GESTURES)):
        for j in range(LABELS):
            if strong[i, j] + weak[i, j] > LEAST:
                both = f"{100 * strong[i, j]:.0f}\n{100 * weak[i, j]:.0f}"
                axes.text(j, i, both, ha="center", va="center", fontsize=8, color=OURS if i == j else DARK)
    axes.set_xticks(range(LABELS), [name.replace(" ", "\n") for name in SAID], fontsize=7)
    axes.set_yticks(range(len(GESTURES)), GESTURES, fontsize=8)
    axes.set(xlabel="done", ylabel="shown")
    axes.spines[:].set_color(PLAIN)
