"""Figures of acts on objects."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.objects.deciding import UNSEEN
from experiments.objects.found import Done, Studied
from experiments.play.figures import outcomes
from experiments.shared.figures import captioned, legend_above
from experiments.shared.judging import interval_95
from experiments.shared.palette import DARK, OURS, PLAIN, THEIRS
from imitation.acting.primitives import NAMES
from models.objects import TOYS

INFANTS = {
    "week": (("Meltzoff 1988 (n recalled)", 8, 12), ("Heimann et al. 2017", 29, 63)),
    "none": (("Meltzoff 1988 (n recalled)", 0, 24), ("Heimann et al. 2017", 2, 41)),
}
"""Infants who touched it with the head, and how many there were; other conditions are known by their signs only."""
MARKS = {"Meltzoff 1988 (n recalled)": "D", "Heimann et al. 2017": "s"}
PEERS = ("mimic", "emulate")


def figures(done: Done) -> dict[str, Figure]:
    """File stem -> figure."""
    return {"choice": choice(done), "outcomes": outcomes(done.child.play)}


@captioned(
    "What the movement was taken for, what would bring the goal about, and what Eq. (1) makes of it: the posterior "
    "over primitives from which the first act was drawn."
)
def choice(done: Done) -> Figure:
    """What was chosen, and why."""
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
    return figure


def study_figures(studied: Studied) -> dict[str, Figure]:
    """File stem -> figure."""
    found = {"head_touch": head_touch(studied), "primitives": primitives(studied)}
    return found | {"outcomes": outcomes(studied.plays[0].play)}


@captioned(
    "Primitives with specimens and places that were never met: share of tries, exact 95 % intervals; beside the peer "
    "who learned no aims and does them in the middle of where they may be done."
)
def primitives(studied: Studied) -> Figure:
    """Success by primitive."""
    figure = Figure(figsize=(7.5, 4.0), layout="constrained")
    axes = figure.subplots()
    _bars(axes, studied.metrics, "primitive_success", label="aimed as play taught")
    _bars(
        axes,
        studied.metrics,
        "primitive_success_unaimed",
        list(studied.by_name("unaimed")),
        label="no aims learned",
        shift=0.4,
    )
    axes.set(ylabel="share of tries that did what they should", ylim=(0, 1.05))
    legend_above(axes)
    return figure


@captioned(
    "How many touched the panel with the forehead, by how the act was seen: imitators over several plays, and peers "
    "that do the movement (mimic) or bring the light about (emulate). Exact 95 % intervals; infants beside."
)
def head_touch(studied: Studied) -> Figure:
    """Head touches beside infants'."""
    metrics = studied.metrics
    figure = Figure(figsize=(9.5, 4.8), layout="constrained")
    axes = figure.subplots()
    _bars(axes, metrics, "head_touch", PEERS)
    places, shown = list(metrics["head_touch"]), set[str]()
    for condition, sources in INFANTS.items():
        for number, (source, hits, count) in enumerate(sources):
            if condition in places:
                low, high = interval_95(hits, count)
                where, share = places.index(condition) + 0.3 + 0.13 * number, hits / count
                label = None if source in shown else f"infants, {source}"
                ends = [[share - low], [high - share]]
                axes.errorbar(where, share, ends, fmt=MARKS[source], color=DARK, ms=5, capsize=2, lw=1, label=label)
                shown.add(source)
    axes.set(ylabel="share who touched it with the forehead", ylim=(0, 1.05))
    legend_above(axes)
    figure.suptitle(
        f"Head touch by what was seen: {metrics['agents']} agents over {len(studied.plays)} plays, and peers that do "
        "the movement (mimic)\nor bring the light about (emulate); exact 95 % intervals. Infants: published rates.",
        fontsize=9,
    )
    return figure


def _bars(
    axes: Axes, metrics: dict[str, Any], key: str, peers: Sequence[str] = (), *, label: str = "", shift: float = 0.0
) -> None:
    """Shares and their intervals out of metrics.json."""
    names = list(metrics[key])
    middle = np.array([metrics[key][name] for name in names])
    ends = np.array([metrics[f"{key}_interval"][name] for name in names])
    places = np.arange(len(names)) + shift
    inks = [PLAIN if name in peers else OURS for name in names]
    axes.bar(places, middle, 0.4 if label else 0.5, color=inks, label=label or None)
    axes.errorbar(places, middle, np.abs(ends.T - middle), fmt="none", color=DARK, capsize=3)
    axes.set_xticks(range(len(names)), names, rotation=25, ha="right")
