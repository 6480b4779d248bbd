"""Figures of intentions."""

from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.intentions import films
from experiments.intentions.agents import GOALS
from experiments.intentions.found import Done, Studied
from experiments.shared.figures import captioned, legend_above, spaced
from experiments.shared.judging import interval_95
from experiments.shared.palette import DARK, OURS, PLAIN, THEIRS, inks
from models.objects.states import STATES

INFANTS: Final = {
    "target": ("recalled", 0.76),
    "failed": ("recalled", 0.80),
    "baseline": ("recalled", 0.20),
    "manipulation": ("recalled", 0.20),
    "device_failed": ("recalled", 0.10),
    "head_free": ("recalled", 9 / 13),
    "head_bound": ("recalled", 3 / 14),
    "head_none": ("seen", 2 / 41),
}
"""Published shares: Meltzoff (1995) of five acts and of the dumbbell, Gergely et al. (2002), Heimann et al. (2017);
"recalled": no source with the figure could be retrieved."""
WITHIN: Final = {"head_free": (9, 13), "head_bound": (3, 14), "head_none": (2, 41), "device_failed": (3, 30)}
"""How many infants of how many, where an interval over infants can be told."""
LEAST_SHOWN: Final = 0.02
"""P of a goal that gets a line of its own."""
WITH_END: Final = 1.15
"""Where what became of the thing stands, beside shares of the movement."""


def figures(done: Done) -> dict[str, Figure]:
    """File stem -> figure."""
    return {"meant": meant(done)}


@captioned(
    "What was believed of the other's goal after each presentation, and whether that is somebody at all. Goals that "
    "are never likelier than 2 per cent are left out."
)
def meant(done: Done) -> Figure:
    """What was believed after each presentation, and what was done."""
    figure = Figure(figsize=(8.4, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1.25, 1], sharey=True)
    after = np.arange(len(done.meant.goal))
    for n, (goal, ink) in enumerate(inks(GOALS).items()):
        if done.meant.goal[:, n].max() > LEAST_SHOWN:
            left.plot(after, done.meant.goal[:, n], "o-", color=ink, label=goal)
    left.set(xlabel="presentations seen", ylabel="P(goal | somebody pursues one)", ylim=(-0.02, 1.02), xticks=after)
    legend_above(left)
    right.plot(after, done.meant.somebody, "o-", color=DARK)
    right.set(xlabel="presentations seen", ylabel="P(that is somebody)", xticks=after)
    right.tick_params(labelleft=True)
    saw = ", ".join(STATES[one.state or 0] for one in done.shown.seen) or "nothing"
    did = "; ".join(f"{act}: {state}" for _, act, state in done.acts)
    figure.suptitle(
        f"{done.config.condition}, {done.config.toy}. Ends that were seen: {saw}. Then it did: {did}.", fontsize=9
    )
    return figure


def study_figures(studied: Studied, metrics: dict[str, Any]) -> dict[str, Figure]:
    """Rates, who is somebody, goals by share of the movement, films, sensitivity."""
    found = {
        "rates": rates(metrics, len(studied.plays)),
        "somebody": bodies(metrics),
        "goals": by_share(metrics),
        "films": films.figure(dict(studied.films)),
    }
    return found | ({"sensitivity": sensitivity(metrics)} if len(metrics["sensitivity"]) > 1 else {})


@captioned(
    "How often the target of an act came about after what was shown, beside infants and two simpler peers. "
    "Intervals are 95 % over agents, those of infants exact where numbers are known."
)
def rates(metrics: dict[str, Any], plays: int) -> Figure:
    """Every condition beside infants and both peers."""
    figure = Figure(figsize=(11.5, 5.0), layout="constrained")
    axes = figure.subplots()
    names = list(metrics["rates"])
    where = np.arange(len(names))
    for key, shift, ink, label in (
        ("rates", -0.27, OURS, "imitators, Eq. (2) then Eq. (1)"),
        ("rates_mimicry", 0.0, PLAIN, "mimicry: the movement it saw"),
        ("rates_emulation", 0.27, THEIRS, "emulation: the end it saw last"),
    ):
        middle = np.array([metrics[key][name] for name in names])
        ends = np.array([metrics[f"{key}_interval"][name] for name in names])
        axes.bar(where + shift, middle, 0.25, color=ink, label=label)
        axes.errorbar(where + shift, middle, np.abs(ends.T - middle), fmt="none", color=DARK, capsize=2, lw=1)
    for name, (status, share) in INFANTS.items():
        if name not in names:  # nobody could show it
            continue
        at, low, high = names.index(name) - 0.27, share, share
        if name in WITHIN:
            low, high = interval_95(*WITHIN[name])
        marker = "D" if status == "seen" else "s"
        axes.errorbar(at, share, [[share - low], [high - share]], fmt=marker, mfc="white", color=DARK, ms=5, capsize=3)
    axes.errorbar([], [], fmt="D", mfc="white", color=DARK, ms=5, label="infants, published")
    axes.errorbar([], [], fmt="s", mfc="white", color=DARK, ms=5, label="infants, figure recalled")
    axes.set(ylabel="share with whom the target came about", ylim=(0, 1.05), yticks=np.arange(0, 1.01, 0.2))
    axes.set_xticks(where, [spaced(name) for name in names], rotation=25, ha="right")
    legend_above(axes, 5)
    figure.suptitle(
        f"What is done after what was shown: {metrics['agents']} agents over {plays} plays, 95 % intervals over "
        "agents; physics for every act.",
        fontsize=9,
    )
    return figure


@captioned(
    "Whether that is somebody, by one's own body image: the same movement done by other bodies, looking at "
    "who watches or not."
)
def bodies(metrics: dict[str, Any]) -> Figure:
    """P(somebody) by body."""
    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    axes = figure.subplots()
    order = sorted(metrics["agent_log_odds"], key=lambda body: -metrics["agent_log_odds"][body])
    for key, ink, label in (
        ("agent_posterior_looked", THEIRS, "looks at who watches"),
        ("agent_posterior", OURS, "by its shape alone"),
        ("agent_posterior_unlooked", PLAIN, "never looks up"),
    ):
        axes.plot(range(len(order)), [metrics[key][body] for body in order], "o-", color=ink, label=label)
    axes.set(ylabel="P(that is somebody)", ylim=(-0.02, 1.02))
    axes.set_xticks(range(len(order)), order, rotation=30, ha="right")
    legend_above(axes)
    figure.suptitle("Is that somebody? By one's own body image, the same movement done by other bodies.", fontsize=9)
    return figure


@captioned(
    "How often the goal was inferred rightly after part of the movement, and with its end, beside simpler rules; 95 % "
    "intervals over plays."
)
def by_share(metrics: dict[str, Any]) -> Figure:
    """Accuracy of the inferred goal by share of the movement that was seen, and with what became of the thing."""
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = figure.subplots()
    parts, ends = metrics["goal_accuracy_by_share"], metrics["goal_accuracy_by_share_interval_over_plays"]
    whole, last = metrics["goal_accuracy"], metrics["goal_accuracy_interval_over_plays"]
    for rule, ink in {"Eq. (2)": OURS, "last motion": THEIRS, "most frequent": PLAIN, "end": DARK}.items():
        seen = {float(share): (one[rule], ends[share][rule]) for share, one in parts.items() if rule in one}
        for style, shown in (("o-", seen), ("D", {WITH_END: (whole[rule], last[rule])})):
            label = None if style == "D" and seen else "the end itself" if rule == "end" else rule
            if shown:
                middle = np.array([share for share, _ in shown.values()])
                two = np.array([pair or (share, share) for share, pair in shown.values()])
                axes.errorbar(list(shown), middle, np.abs(two.T - middle), fmt=style, color=ink, capsize=2, label=label)
    axes.set(xlabel="share of the movement that was seen", ylabel="share of goals inferred rightly", ylim=(0, 1))
    tenths = np.arange(2, 11, 2) / 10
    axes.set_xticks([*tenths, WITH_END], [*(f"{share:g}" for share in tenths), "its end too"])
    legend_above(axes)
    figure.suptitle(f"{metrics['goal_presentations']} presentations by adults who pursue a goal.", fontsize=9)
    return figure


@captioned(
    "Per cent of imitators with whom the target came about, by condition, when one number that is not learned "
    "is another. Rows that differ little say that it matters little."
)
def sensitivity(metrics: dict[str, Any]) -> Figure:
    """Rates by what is otherwise."""
    rows, columns = list(metrics["sensitivity"]), list(metrics["rates"])
    values = np.array([[metrics["sensitivity"][row].get(name, np.nan) for name in columns] for row in rows])
    figure = Figure(figsize=(11.0, 0.36 * len(rows) + 2.4), layout="constrained")
    axes = figure.subplots()
    _table(axes, 100 * values)
    axes.set_xticks(range(len(columns)), [spaced(name) for name in columns], rotation=30, ha="right")
    axes.set_yticks(range(len(rows)), rows)
    figure.suptitle(
        "Sensitivity: per cent of imitators with whom the target came about, one thing changed.", fontsize=9
    )
    return figure


def _table(axes: Axes, values: Any) -> None:
    axes.imshow(values, vmin=0, vmax=100, cmap="Oranges", aspect="auto")
    for (row, column), value in np.ndenumerate(values):
        if np.isfinite(value):
            axes.text(column, row, f"{value:.0f}", ha="center", va="center", fontsize=8)
