"""Figures of acts on objects."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.objects.deciding import UNSEEN
from experiments.objects.found import Done, Studied
from experiments.play.figures import outcomes
from experiments.shared.palette import DARK, OURS, PLAIN, THEIRS
from imitation.acting.primitives import NAMES
from models.objects import TOYS

INFANTS = {
    "week": (8, 12, "Meltzoff 1988, n recalled"),
    "live": (15, 30, "Heimann 2017, laboratory"),
    "room": (14, 33, "Heimann 2017, familiar place"),
    "none": (2, 41, "Heimann 2017, baseline"),
}
"""Head touches, infants, and where that stands; other conditions are known by their signs only."""


def figures(done: Done) -> dict[str, Figure]:
    """What was chosen, and why; and the tables it rests on."""
    figure = Figure(figsize=(9.5, 4.6), layout="constrained")
    axes = figure.subplots(1, 3, sharey=True)
    play, rows = done.child.play, np.arange(len(NAMES))
    kind, goal = play.kinds.index(TOYS[done.config.object].kind), int(done.response.goals[0])
    likely = play.outcomes.predictive[0, kind, 0, :, max(goal, 0)] if goal != UNSEEN else np.zeros(len(NAMES))
    memory = np.zeros(len(NAMES)) if done.memory is None else done.memory.primitive
    for one, values, title, ink in (
        (axes[0], memory, "what it was taken for:\nP(primitive | movement)", THEIRS),
        (axes[1], likely, f"forward model:\nP({done.goal} | primitive)", PLAIN),
        (axes[2], done.response.posteriors[0], "Eq. (1): P(primitive | goal)", OURS),
    ):
        one.barh(rows, values, color=ink)
        one.set(xlim=(0, 1), xlabel="probability")
        one.set_title(title, fontsize=10, loc="left")
    axes[0].set_yticks(rows, NAMES)
    axes[0].invert_yaxis()
    said = "; ".join(f"{act}: {state}" for act, state in done.acts)
    figure.suptitle(f"{done.config.object}, {done.config.condition}. Done: {said}.", fontsize=10)
    return {"choice": figure, "outcomes": outcomes(play)}


def study_figures(studied: Studied) -> dict[str, Figure]:
    """Head touches beside infants', success by primitive, and the tables of the first play."""
    metrics = studied.metrics
    figure = Figure(figsize=(8.5, 4.4), layout="constrained")
    axes = figure.subplots()
    _bars(axes, metrics, "head_touch", "agents")
    for place, name in enumerate(metrics["head_touch"]):
        if name in INFANTS:
            hits, count, source = INFANTS[name]
            axes.plot(place + 0.28, hits / count, "D", color=DARK, ms=6)
            axes.annotate(source, (place + 0.3, hits / count), fontsize=7, rotation=30, va="bottom")
    axes.plot([], [], "D", color=DARK, label="infants")
    axes.set(ylabel="touched the panel with the forehead", ylim=(0, 1.12))
    axes.legend(frameon=False, loc="upper right")
    figure.suptitle(
        f"Head touch by condition: {metrics['agents']} agents over {len(studied.plays)} plays, exact 95 % intervals; "
        "infants' published rates.",
        fontsize=9,
    )
    other = Figure(figsize=(7.5, 4.0), layout="constrained")
    axes = other.subplots()
    _bars(axes, metrics, "primitive_success", "done")
    axes.set(ylabel="share of tries", ylim=(0, 1.05))
    other.suptitle("Primitives with specimens and places never met: exact 95 % intervals.", fontsize=9)
    return {"head_touch": figure, "primitives": other, "outcomes": outcomes(studied.plays[0].play)}


def _bars(axes: Axes, metrics: dict[str, Any], key: str, label: str) -> None:
    """Shares and their intervals out of metrics.json."""
    names = list(metrics[key])
    middle = np.array([metrics[key][name] for name in names])
    ends = np.array([metrics[f"{key}_interval"][name] for name in names])
    axes.bar(range(len(names)), middle, 0.5, color=OURS, label=label)
    axes.errorbar(range(len(names)), middle, np.abs(ends.T - middle), fmt="none", color=DARK, capsize=3)
    axes.set_xticks(range(len(names)), names)
