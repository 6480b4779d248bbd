"""The figure of one infant."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from babbling.relations import RELATIONS, UNITS
from experiments.face.judging import MAIN, WHOSE
from experiments.face.once import TICK_S, Done
from experiments.shared.figures import captioned, legend_above
from experiments.shared.palette import CYCLE, DARK, OURS, PLAIN, THEIRS


@captioned(
    "What one infant saw at the end, whose organ it took to move, frame by frame, and its tries: as it felt "
    "them and as they were, beside the target that it saw."
)
def demo_figure(done: Done, m: dict[str, Any]) -> Figure:
    """What was seen and which organ it seemed to be, frame by frame; then tries, as felt and as they were."""
    figure = Figure(figsize=(12.5, 4.0), layout="constrained")
    image, organ, tries = figure.subplots(1, 3, width_ratios=[1.1, 1, 1])
    relation = int(np.flatnonzero(done.memory.moved)[-1]) if done.memory.moved.any() else 0
    if done.watched is not None:
        watched, relation = done.watched, int(MAIN[done.watched.shown.gesture])
        image.imshow(watched.images[-1][0])
        image.set_title("what its left eye saw at the end", fontsize=9)
        time = 1e3 * TICK_S * np.arange(len(watched.organs))
        inks = [*CYCLE[: len(WHOSE) - 1], PLAIN]
        for name, ink, belief in zip(WHOSE, inks, watched.organs.T, strict=True):
            organ.plot(time, belief, color=ink, label=name, lw=2 if belief[-1] > 0.5 else 1)
        organ.set(xlabel="time [ms]", ylabel="P(organ that moves | seen)", ylim=(-0.02, 1.02))
        legend_above(organ, 3)
    image.set_axis_off()
    number = np.arange(1, len(done.true) + 1)
    tries.axhline(done.memory.relations[relation], color=THEIRS, ls="--", label="as seen: the target")
    if done.watched is not None:
        tries.axhline(done.watched.true[relation], color=DARK, lw=1, label="as it was shown")
    tries.plot(number, done.tried.felt[:, 0, relation], "o:", color=PLAIN, label="felt")
    tries.plot(number, done.true[:, relation], "o-", color=OURS, label="done")
    tries.set(xlabel="try", ylabel=f"{RELATIONS[relation]} [{UNITS[relation]}]", xticks=number)
    legend_above(tries, 2)
    figure.suptitle(f"An infant that never saw its own face does {' and '.join(dict.fromkeys(m['done']))}.", fontsize=9)
    return figure
