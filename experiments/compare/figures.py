"""The figure of `imitate compare`."""

from matplotlib.figure import Figure

from experiments.compare.found import Compared
from experiments.shared.figures import captioned, legend_above
from experiments.shared.palette import CYCLE, OURS

COLOURS = (OURS, *CYCLE[2:])
"""Of runs; blue is the demonstration's."""
UNITS = ("deg", "rad", "m", "s", "ms", "px", "bits", "nat", "share", "minutes")
"""With which names of numbers end."""


def figures(done: Compared) -> dict[str, Figure]:
    """File stem -> figure; none where nothing can be drawn."""
    return {"comparison": comparison(done)} if done.errors or done.headlines else {}


@captioned(
    "Error against the sub-goals through time, root mean square of the joints that runs share, and the headline "
    "numbers of every run. One colour a run, throughout."
)
def comparison(done: Compared) -> Figure:
    """Errors through time; headlines below."""
    count = bool(done.errors) + bool(done.headlines)
    figure = Figure(figsize=(11, 3.4 * count), layout="constrained")
    rows = iter(figure.subfigures(count, 1, squeeze=False)[:, 0])
    if done.errors:
        axes = next(rows).subplots()
        for number, run, time, error in done.errors:
            axes.plot(time, error, color=COLOURS[number % len(COLOURS)], lw=1.1, label=run.label)
        axes.set(xlabel="time [s]", ylabel=f"error [{done.unit}]", ylim=(0, None))
        axes.set_title(f"error against the sub-goals, root mean square of {len(done.joints)} joints")
        legend_above(axes)
    if done.headlines:
        columns = next(rows).subplots(1, len(done.headlines), squeeze=False)[0]
        for axes, (name, values) in zip(columns, done.headlines.items(), strict=True):
            places = range(len(values))
            axes.bar(places, values, color=[COLOURS[n % len(COLOURS)] for n in places])
            axes.set_ylabel(named(name), fontsize=8)
            axes.set_xticks(places, [run.label for run in done.runs], rotation=60, ha="right", fontsize=7)
            axes.tick_params(axis="y", labelsize=7)
    return figure


def named(metric: str) -> str:
    """A number of metrics.json, its unit in brackets."""
    *words, last = metric.split("_")
    return " ".join([*words, f"[{last}]" if last in UNITS else last])
