"""Figures of a battery: agents beside infants, what was left out, what was varied."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from babbling.axes import FloatArray
from experiments.battery.beside import Row, of
from experiments.battery.chapters import STAGES, stage_of
from experiments.battery.effects import FEW, INSIDE, NOT_COMPARABLE, SAME, populations
from experiments.battery.found import Battery, enough, only
from experiments.battery.infants import Cell, Rate, Sign
from experiments.battery.intervals import Estimate
from experiments.battery.power import Power, power, power_figure
from experiments.battery.sensitivity import changes, sensitivity_figure
from experiments.battery.table import IMITATOR, WHOLE
from experiments.shared.figures import MARKS, captioned
from experiments.shared.palette import CYCLE, DARK, OURS, PLAIN, THEIRS

STUDIES = {
    "head touch, a week before and never seen": (Cell("head touch", "a week before"), Cell("head touch", "nothing")),
    "failed attempt and baseline": (Cell("intention", "failed"), Cell("intention", "baseline")),
    "headband and blindfold, 18 months, 20 trials each": (
        Cell("gaze, headband", "18 months"),
        Cell("gaze, blindfold", "18 months"),
    ),
}
"""Whose power is looked at."""
GOOD = (INSIDE, SAME)
OPEN = (FEW, NOT_COMPARABLE, "not shown")


def figures(done: Battery) -> dict[str, Figure]:
    """By name, in the order of the report."""
    found = dict[str, Figure]()
    shown = [row for row in done.rows if row.simulated is not None]
    for name, kind, draw in (("infants", Rate, beside_infants), ("signs", Sign, beside_signs)):
        if some := [row for row in shown if isinstance(row.published, kind)]:
            found[name] = draw(some)
    for name, (title, *_) in STAGES.items():
        part = enough(done.whole[done.whole["task"].map(stage_of) == name])
        if len(part):
            found[name] = ablations(part, title, rng=np.random.default_rng(0))
    if compared := powers(done, rng=np.random.default_rng(0)):
        found["power"] = power_figure(compared)
    if changed := changes(done, rng=np.random.default_rng(0)):
        found["sensitivity"] = sensitivity_figure(changed)
    for factor in done.factors:
        found[f"vary_{factor}"] = varied(enough(only(done.frame, factor), factor), factor, rng=np.random.default_rng(0))
    return found


def powers(done: Battery, *, rng: np.random.Generator) -> list[Power]:
    """Of studies that compare two groups, were infants these agents."""
    whole = done.whole[(done.whole["who"] == IMITATOR) & (done.whole["without"] == WHOLE)]
    pairs = {name: [of(whole, cell).to_numpy(float) for cell in cells] for name, cells in STUDIES.items()}
    return [power(a, b, repeats=400, name=name, rng=rng) for name, (a, b) in pairs.items() if min(len(a), len(b)) > 1]


@captioned(
    "Share of agents (orange, 95 % interval over separately babbled agents) and of infants (blue, exact 95 % interval; "
    "hollow where no n over infants was published). Agents watched the same two adults and draw in proportion to their "
    "posteriors; nothing was fitted."
)
def beside_infants(rows: Sequence[Row]) -> Figure:
    """Rates, a line each."""
    shown = [row for row in rows if isinstance(row.published, Rate) and row.simulated is not None]
    figure, axes = _lines(len(shown), "share of agents, of infants")
    for at, row in enumerate(shown):
        assert isinstance(row.published, Rate) and row.simulated is not None
        _dot(axes, row.simulated, at - 0.13, OURS)
        if row.verdict.published is not None:
            _dot(axes, row.verdict.published, at + 0.13, THEIRS)
        else:
            axes.plot(row.published.share, at + 0.13, "o", mfc="none", color=THEIRS, ms=6)
        _verdict(axes, at, row.verdict.word)
    axes.set_xlim(-0.02, 1.02)
    for who, ink in (("agents", OURS), ("infants", THEIRS)):
        axes.plot([], [], "o-", color=ink, ms=6, label=who)
    figure.legend(loc="outside upper right", ncols=2, frameon=False)
    _named(axes, [f"{row.published.cell}\n{row.published.study} ({row.published.status})" for row in shown
                  if isinstance(row.published, Rate)])  # fmt: skip
    return figure


@captioned(
    "By how much more often agents did it in the first than in the second condition (95 % interval over agents), "
    "beside the published sign. Where infants' groups did not differ, agents agree if it lies within 19 points."
)
def beside_signs(rows: Sequence[Row]) -> Figure:
    """Differences, a line each."""
    shown = [row for row in rows if isinstance(row.published, Sign) and row.simulated is not None]
    figure, axes = _lines(len(shown), "difference between shares of agents")
    labels = []
    for at, row in enumerate(shown):
        assert isinstance(row.published, Sign) and row.simulated is not None
        _dot(axes, row.simulated, at, OURS)
        _verdict(axes, at, row.verdict.word)
        one = row.published
        less = one.less.condition if one.less.task == one.more.task else one.less
        labels.append(f"{one.more} {one.relation} {less}\n{one.study} ({one.status})")
    axes.axvline(0, color=DARK, lw=0.8)
    axes.set_xlim(-1.02, 1.02)
    _named(axes, labels)
    return figure


@captioned(
    "Whole agents, agents without a stage, and peers with the same body that saw the same; means and 95 % intervals "
    "over agents. What a stage is for shows where it is left out."
)
def ablations(frame: pd.DataFrame, title: str, *, rng: np.random.Generator) -> Figure:
    """Panels for tasks; conditions down, everybody in a colour."""
    table = populations(frame, rng=rng)
    tasks = list(dict.fromkeys(table["task"]))
    longest = max(table[table["task"] == task]["condition"].nunique() for task in tasks)
    who = _everybody(table)
    figure = Figure(
        figsize=(4.2 * max(len(tasks), 2), 1.2 + 0.24 * max(longest, 3) * max(len(who), 2)), layout="constrained"
    )
    panels = figure.subplots(1, len(tasks), sharey=True, squeeze=False)[0]
    conditions = list(dict.fromkeys(table["condition"]))
    for axes, task in zip(panels, tasks, strict=True):
        here = table[table["task"] == task]
        for number, (name, (peer, without)) in enumerate(who.items()):
            some = here[(here["who"] == peer) & (here["without"] == without)]
            beside = 0.7 * ((number + 0.5) / len(who) - 0.5)
            at = np.array([conditions.index(one) for one in some["condition"]]) + beside
            how = {"fmt": MARKS[number % len(MARKS)], "color": CYCLE[number % len(CYCLE)], "ms": 5, "lw": 1.3}
            axes.errorbar(some["mean"], at, xerr=_spread(some), label=name, **how)
        unit = here["unit"].iloc[0]
        axes.set(xlabel=f"error [{unit}]" if unit else "share of agents' trials", title=task)
        axes.set_yticks(range(len(conditions)), conditions)
        axes.grid(alpha=0.25)
        axes.set_xscale("log") if unit else axes.set_xlim(-0.03, 1.03)
    panels[0].invert_yaxis()
    figure.suptitle(title)
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=4, frameon=False)
    return figure


def _everybody(table: pd.DataFrame) -> dict[str, tuple[str, str]]:
    pairs = dict.fromkeys(zip(table["who"], table["without"], strict=True))
    first = sorted(pairs, key=lambda pair: (pair != (IMITATOR, WHOLE), pair[1] == WHOLE))
    return {who if without == WHOLE else f"without {without}": (who, without) for who, without in first}


@captioned(
    "The same agents, seeds alike, with one parameter varied: means and 95 % intervals over agents, all else that "
    "was varied at its first value. A level line means that the result does not depend on this number."
)
def varied(frame: pd.DataFrame, factor: str, *, rng: np.random.Generator) -> Figure:
    """Panels for tasks, lines for conditions."""
    table = populations(frame, rng=rng)
    tasks = list(dict.fromkeys(table["task"]))
    figure = Figure(figsize=(4.4 * min(len(tasks), 3), 4.0 * -(-len(tasks) // 3)), layout="constrained")
    panels = figure.subplots(-(-len(tasks) // 3), min(len(tasks), 3), squeeze=False).ravel()
    for axes, task in zip(panels, tasks, strict=False):
        here = table[table["task"] == task]
        for number, (condition, some) in enumerate(here.groupby("condition", sort=False)):
            axes.errorbar(some[factor].astype(str), some["mean"], yerr=_spread(some), marker=MARKS[number % len(MARKS)],
                          color=CYCLE[number % len(CYCLE)], ms=4, lw=1.3, label=str(condition))  # fmt: skip
        unit = here["unit"].iloc[0]
        axes.set(xlabel=factor.replace("_", " "), ylabel=f"error [{unit}]" if unit else "share", title=task)
        axes.set_yscale("log") if unit else axes.set_ylim(-0.03, 1.03)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, frameon=False, fontsize=7)
        axes.grid(alpha=0.25)
    for axes in panels[len(tasks) :]:
        axes.set_visible(False)
    return figure


def _lines(count: int, label: str) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(9.5, 1.2 + 0.52 * max(count, 1)), layout="constrained")
    axes = figure.subplots()
    axes.set(xlabel=label, ylim=(count - 0.4, -0.6))
    axes.grid(axis="x", alpha=0.25)
    return figure, axes


def _dot(axes: Axes, one: Estimate, at: float, ink: str) -> None:
    spread = [[max(one.value - one.low, 0)], [max(one.high - one.value, 0)]]
    axes.errorbar(one.value, at, xerr=spread, fmt="o", color=ink, ms=6, lw=1.6)


def _spread(rows: pd.DataFrame) -> FloatArray:
    """(2, N) from means to the ends of their intervals."""
    return np.asarray(np.clip([rows["mean"] - rows["low"], rows["high"] - rows["mean"]], 0, None))


def _verdict(axes: Axes, at: float, word: str) -> None:
    ink = OURS if word in GOOD else PLAIN if word in OPEN else DARK
    axes.annotate(word, (1.01, at), xycoords=("axes fraction", "data"), va="center", fontsize=9, color=ink,
                  fontweight="normal" if word in OPEN else "bold")  # fmt: skip


def _named(axes: Axes, labels: Sequence[str]) -> None:
    axes.set_yticks(range(len(labels)), labels, fontsize=8)
