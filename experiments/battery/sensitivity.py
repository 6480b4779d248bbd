"""How much what agents do depends on each of their parameters: none was fitted, so none may matter unseen."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from experiments.battery.beside import of
from experiments.battery.found import Battery, only
from experiments.battery.infants import RATES, SIGNS, Cell
from experiments.battery.intervals import Estimate, of_mean
from experiments.shared.figures import captioned
from experiments.shared.palette import LESS_TO_MORE

CELLS = tuple(dict.fromkeys([*(one.cell for one in RATES), *(cell for one in SIGNS for cell in (one.more, one.less))]))
"""Whatever stands beside infants."""


class Change(NamedTuple):
    """What one other value of one parameter changes."""

    parameter: str
    value: float | str
    usual: float | str
    cell: Cell
    difference: Estimate
    """Of the share of agents who do it, the same agents with the usual value."""


def changes(done: Battery, *, rng: np.random.Generator) -> list[Change]:
    """Of every parameter that was varied, whatever else was at its first value."""
    found = list[Change]()
    for name in done.factors:
        frame = only(done.frame, name)
        frame = frame.assign(agent=frame["seed"])  # the same children have another number in every cell
        values = {value: some for value, some in frame.groupby(name, sort=False)}
        usual = done.frame[name].iloc[0]
        for value in (value for value in values if value != usual):
            for cell in CELLS:
                pair = pd.concat([of(values[one], cell) for one in (value, usual)], axis=1, join="inner").to_numpy(
                    float
                )
                if len(pair) > 1:
                    away = pair[:, 0] - pair[:, 1]
                    once = np.isin(away, (-1, 0, 1)).all()  # t would take a few who turn round for too much
                    difference = of_mean(away, rng, (-1.0, 1.0) if once else None, str(cell))
                    found.append(Change(name, value, usual, cell, difference))
    return found


@captioned(
    "By how many points the share of agents that do it changes when one parameter takes another value, all else as "
    "usual: the same agents, seeds alike. Framed where the 95 % interval over agents leaves 0 out; of so many, one in "
    "twenty is framed by chance."
)
def sensitivity_figure(found: Sequence[Change]) -> Figure:
    """Values down, what stands beside infants across."""
    lines = list(dict.fromkeys((one.parameter, one.value, one.usual) for one in found))
    cells = [cell for cell in CELLS if any(one.cell == cell for one in found)]
    figure = Figure(figsize=(2.6 + 0.42 * len(cells), 2.2 + 0.26 * len(lines)), layout="constrained")
    axes, table = figure.subplots(), np.full((len(lines), len(cells)), np.nan)
    for one in found:
        row, column = lines.index((one.parameter, one.value, one.usual)), cells.index(one.cell)
        table[row, column] = 100 * one.difference.value
        told = not one.difference.low <= 0 <= one.difference.high
        said = f"{table[row, column]:+.0f}" if abs(table[row, column]) >= 0.5 else "0" if one.difference.value else ""
        axes.text(column, row, said, ha="center", va="center", fontsize=6,
                  bbox={"boxstyle": "square,pad=0.35", "fc": "none", "lw": 0.8} if told else None)  # fmt: skip
    picture = axes.imshow(table, cmap=LESS_TO_MORE, vmin=-100, vmax=100, aspect="auto")
    named = [f"{name.replace('_', ' ')} {_short(value)} (usually {_short(usual)})" for name, value, usual in lines]
    axes.set_yticks(range(len(lines)), named, fontsize=7)
    axes.set_xticks(range(len(cells)), [str(cell) for cell in cells], rotation=60, ha="right", fontsize=7)
    figure.colorbar(picture, ax=axes, shrink=0.6, label="change of the share of agents [points]")
    return figure


def _short(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"
