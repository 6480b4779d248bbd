"""Figures of `imitate fit`."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullFormatter

from experiments.battery.fit import MODELS
from experiments.battery.recovery import Recovery
from experiments.fit.found import Found
from experiments.shared.figures import captioned
from experiments.shared.palette import DARK, OURS, PLAIN, THEIRS

LOGARITHMIC = ("temperature", "trust")


def figures(done: Found) -> dict[str, Figure]:
    """By file stem."""
    drawn = {"parameters": parameters(done), "check": check(done), "models": models(done)}
    return drawn | ({"recovery": recovery(done.recovery)} if done.recovery is not None else {})


@captioned(
    "Parameters of each individual, median and 95 % credible interval, in order of the first (orange); of all as one "
    "(blue band). Dashed: matching the posterior of Eq. (1) or (2) as it is."
)
def parameters(done: Found) -> Figure:
    """A panel a parameter."""
    figure = Figure(figsize=(10, 3.8), layout="constrained")
    order = np.argsort(done.individual[:, 0, 0], kind="stable")
    for place, (axes, name) in enumerate(zip(figure.subplots(1, 3), done.names, strict=True)):
        middle, low, high = done.individual[order, place].T
        axes.axhspan(*done.pooled[place, 1:], color=THEIRS, alpha=0.3, lw=0, label="all as one")
        axes.errorbar(
            np.arange(len(order)), middle, [middle - low, high - middle], fmt="o", color=OURS, ms=3, elinewidth=0.8,
            label="each alone",
        )  # fmt: skip
        _scale(axes, name, "y")
        if name in LOGARITHMIC:
            axes.axhline(1, color=DARK, lw=0.8, ls="--")
        axes.set(xlabel="individuals", ylabel=name)
        axes.grid(alpha=0.25)
    axes.legend(frameon=False, fontsize=8)
    return figure


@captioned(
    "Share of every response, in each task and condition: observed, against what the fitted individuals would do "
    "(posterior predictive, 95 %). Blue: outside."
)
def check(done: Found) -> Figure:
    """Observed against expected."""
    figure = Figure(figsize=(4.8, 4.6), layout="constrained")
    axes = figure.subplots()
    axes.plot([0, 1], [0, 1], color=PLAIN, lw=1, ls="--")
    outside = done.check.index.isin(done.outside.index)
    for which, ink, name in ((~outside, OURS, "within"), (outside, THEIRS, "outside")):
        rows = done.check[which]
        if len(rows):
            ends = np.abs(rows[["low", "high"]].to_numpy().T - rows["expected"].to_numpy())
            axes.errorbar(
                rows["observed"], rows["expected"], ends, fmt="o", color=ink, ms=4, elinewidth=0.8, label=name
            )
    axes.set(xlabel="observed share", ylabel="expected share", xlim=(-0.03, 1.03), ylim=(-0.03, 1.03))
    axes.grid(alpha=0.25)
    axes.legend(frameon=False)
    return figure


@captioned(
    "Log evidence of each model above chance, parameters summed over their prior: all individuals as one (bar), and "
    "each alone (points, their sum may differ)."
)
def models(done: Found) -> Figure:
    """Bars and points."""
    figure = Figure(figsize=(6.5, 3.8), layout="constrained")
    whole, each = figure.subplots(1, 2)
    base = done.evidence["chance"]
    shown = [model for model in MODELS if model != "chance"]
    for place, model in enumerate(shown):
        own, ink = done.evidence[model], OURS if model == "full" else PLAIN
        whole.bar(place, own.pooled - base.pooled, color=ink)
        alone = own.individual - base.individual
        each.plot(place + np.linspace(-0.3, 0.3, len(alone)), np.sort(alone), ".", color=ink)
    for axes, title in ((whole, "all as one"), (each, "each alone")):
        axes.axhline(0, color=DARK, lw=0.8)
        axes.set_xticks(range(len(shown)), [model.replace(" ", "\n") for model in shown])
        axes.set_title(title, loc="left", fontsize=11)
        axes.set_ylabel("log evidence above chance")
    return figure


@captioned(
    "Infants of known parameters, simulated on the same options: true against found, median and 95 % interval. Grey "
    "points: infants alone; orange: groups of 20 that are alike."
)
def recovery(done: Recovery) -> Figure:
    """A panel a parameter."""
    figure = Figure(figsize=(10.5, 4.0), layout="constrained")
    told = done.coverage()
    for place, (axes, one) in enumerate(zip(figure.subplots(1, 3), done.prior, strict=True)):
        alone = done.found[..., place, 0].ravel()[:1000], done.truth[..., place].ravel()[:1000]
        axes.plot(alone[1], alone[0], ".", color=PLAIN, ms=2.5, alpha=0.6)
        middle, low, high = done.pooled[:, place].T
        axes.errorbar(
            done.shared[:, place], middle, [middle - low, high - middle], fmt="o", color=OURS, ms=2.5, elinewidth=0.6
        )
        ends = one.back(one.edges[[0, -1]])
        axes.plot(ends, ends, color=DARK, lw=0.8)
        for way in "xy":
            _scale(axes, one.name, way)
        shares = [f"{told[kind][one.name]['coverage']:.1%}" for kind in ("individual", "pooled")]
        axes.set_title(f"{one.name}: in the interval\n{shares[0]} of infants, {shares[1]} of groups", fontsize=10)
        axes.set(xlabel="true", ylabel="found")
        axes.grid(alpha=0.25)
    return figure


def _scale(axes: Axes, name: str, way: str) -> None:
    """Of an axis of a parameter."""
    if name in LOGARITHMIC:
        getattr(axes, f"set_{way}scale")("log")
        axis = getattr(axes, f"{way}axis")
        axis.set_major_locator(FixedLocator([0.1, 0.2, 0.5, 1, 2, 5, 10]))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
