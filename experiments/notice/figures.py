"""Figure of `imitate notice`."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from experiments.notice.trials import KINDS, Changed
from experiments.shared.figures import captioned, legend_above
from experiments.shared.palette import DARK, OURS, PLAIN

AROUND_S = 1.0
"""Seconds shown before and after a change."""


def figures(found: Mapping[str, Changed], limit: float, tick_s: float, joints: Sequence[str]) -> dict[str, Figure]:
    """File stem -> figure."""
    return {"noticing": noticing(found, limit, tick_s, joints)}


@captioned(
    "Surprise of the joints that changed (orange), of the others (grey) and of the whole body (black) about the "
    "moment of the change; dashed, the alarm. Below, how many were noticed by when, by simpler signals too."
)
def noticing(found: Mapping[str, Changed], limit: float, tick_s: float, joints: Sequence[str]) -> Figure:
    """The first case of each kind: surprise of every joint and of the body through time, and the moment of the change;
    below, of all cases, how many were noticed by when."""
    figure = Figure(figsize=(11, 6.5), layout="constrained")
    rows = figure.subplots(2, len(found), sharey="row")
    around = round(AROUND_S / tick_s)
    for (top, below), (kind, done) in zip(rows.T, found.items(), strict=True):
        at = int(done.at[0])
        shown = slice(max(at - around, 0), at + around)
        time = (np.arange(shown.start, min(shown.stop, len(done.whole["average"]))) - at) * tick_s
        surprise = done.surprise["average"][shown, 0]
        for joint in np.argsort(surprise.max(0)):
            right = joint in done.joints[0]
            top.plot(time, surprise[:, joint], color=OURS if right else PLAIN, lw=1.6 if right else 0.7)
        top.plot(time, done.whole["average"][shown, 0], color=DARK, lw=1.4)
        top.axhline(limit, color=DARK, lw=0.8, ls="--")
        named = sorted(joints[j] for j in done.joints[0])
        where = named[0].split("_joint")[0] if kind == "carry" else " and ".join(named)
        top.set(
            title=f"{KINDS[kind]}\n{where.replace('_', ' ')}",
            yscale="symlog",
            xlim=(-AROUND_S, AROUND_S),
            xlabel="time after the change [s]",
        )
        for way, (ink, style) in {"average": (OURS, "-"), "line": (DARK, ":"), "error": (PLAIN, "--")}.items():
            window = done.at[:, None] + 1 + np.arange(around // 2)
            over = done.whole[way][window, np.arange(len(done.at))[:, None]] > limit
            share = 100 * np.maximum.accumulate(over, 1).mean(0)
            below.plot((1 + np.arange(around // 2)) * tick_s, share, style, color=ink, label=way)
        below.set(xlabel="time after the change [s]", ylim=(0, 103))
    rows[0, 0].set_ylabel(
        "surprise [nat]: joints that changed (orange),\nothers (grey), the body (black); alarm dashed"
    )
    rows[1, 0].set_ylabel("noticed by then, % of all cases")
    legend_above(rows[1, 0])
    return figure
