"""Figures of `imitate gesture --stand`."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from experiments.gesture.standing_found import Stands
from experiments.shared.figures import captioned, legend_above, rates
from experiments.shared.judging import interval_95
from experiments.shared.palette import CYCLE, DARK, OURS, PLAIN, THEIRS

DIRECTIONS = ("forward and back", "sideways")
"""What people call the two directions of pressure."""
INK = {
    "ours": OURS, "linear": THEIRS, "replay": PLAIN, "pd": CYCLE[2], "blind": CYCLE[3], "both": CYCLE[4]
}  # fmt: skip


def figures(stands: Stands, metrics: Mapping[str, Any]) -> dict[str, Figure]:
    """File stem -> figure."""
    made = {"standing": standing(stands), "learning_to_stand": learning(metrics)}
    if "falls" in metrics:
        made["falls"] = falls(metrics)
        made["pushes"] = pushes(metrics)
    return made


@captioned(
    "Pressure under the soles through time and between their edges, of the imitator and of simpler ways to "
    "stand. Whoever leaves the square falls."
)
def standing(stands: Stands) -> Figure:
    """Pressure felt and foretold, offsets, and where the pressure went between the edges of the soles."""
    figure = Figure(figsize=(11, 6.5), layout="constrained")
    grid = figure.add_gridspec(3, 2, width_ratios=(1.7, 1))
    tick = stands.body.tick_s
    axes = figure.add_subplot(grid[2, 0])
    for k, name in enumerate(DIRECTIONS):
        offset = np.rad2deg(stands.ours.plan.offset[:, 0, k])
        axes.plot((np.arange(len(offset)) - stands.ours.first) * tick, offset, color=(OURS, THEIRS)[k], label=name)
    axes.set(
        xlabel="time since the movement began [s]", ylabel="offset [deg]", title="What Eq. (1) adds to the posture"
    )
    legend_above(axes)
    for k, name in enumerate(DIRECTIONS):
        axes = figure.add_subplot(grid[k, 0], sharex=axes)
        for who, one in stands.done.items():
            time = (np.arange(len(one.loads)) - one.first) * tick
            felt = np.where(one.upright[:, 0], stands.pressed(one.loads[:, 0])[:, k], np.nan)
            axes.plot(time, felt, color=INK[who], lw=1.1, label=f"felt, {who}")
        time = (np.arange(len(stands.ours.foretold)) - stands.ours.first) * tick
        axes.plot(
            time,
            stands.sides[k] * stands.ours.foretold[:, 0, k],
            color=DARK,
            lw=1,
            ls="--",
            label="foretold, ours",
        )
        axes.axhspan(1, 1.3, color=PLAIN, alpha=0.3)
        axes.axhspan(-1.3, -1, color=PLAIN, alpha=0.3)
        axes.set(ylabel="pressure [1 = edge]", ylim=(-1.3, 1.3), title=f"Pressure {name}")
        if k == 0:
            legend_above(axes)
    axes = figure.add_subplot(grid[:, 1])
    for who, one in reversed(stands.done.items()):
        felt = stands.pressed(one.loads[one.upright[:, 0], 0])
        axes.plot(-felt[:, 1], felt[:, 0], color=INK[who], lw=0.8, label=who)
    axes.plot([-1, 1, 1, -1, -1], [-1, -1, 1, 1, -1], color=DARK, lw=1)
    axes.set(
        xlabel="left and right [1 = edge]",
        ylabel="forward and back [1 = edge]",
        title="Pressure between the soles' edges",
        aspect="equal",
    )
    legend_above(axes)
    fell = [who for who, one in stands.done.items() if one.fell[0]]
    figure.suptitle(f"{stands.config.demonstration}, standing; fell: {', '.join(fell) or 'nobody'}", fontsize=11)
    return figure


@captioned(
    "Falls in every body-minute of learning to stand, stage by stage, with how many there were. Later stages "
    "move further about."
)
def learning(metrics: Mapping[str, Any]) -> Figure:
    """Falls in a body-minute, stage by stage."""
    figure = Figure(figsize=(6.5, 3.8), layout="constrained")
    axes = figure.subplots()
    minutes, fell = np.array(metrics["balance_stage_minutes"]), np.array(metrics["balance_stage_falls"])
    moves = [f"moves {n + 1}" for n in range(len(minutes) - 4)]
    bars = axes.bar(["rocked", "wiggles", *moves, "tries a leg", "on one leg"], fell / minutes, color=OURS)
    axes.bar_label(bars, [f"{n:g} in {m:.1f}" for n, m in zip(fell, minutes, strict=True)], fontsize=8)
    axes.tick_params("x", labelrotation=30)
    axes.set(ylabel="falls in a body-minute", title=f"Learning to stand: {minutes.sum():.1f} body-minutes")
    axes.set_xlabel("moves go further about stage by stage; falls in body-minutes of each")
    return figure


@captioned(
    "Share of runs that fell, by how many times as fast the movement was done; intervals are exact (95 %). "
    "Twenty individuals of other masses and friction in every cell."
)
def falls(metrics: Mapping[str, Any]) -> Figure:
    """Share of runs that fell, by speed; intervals are exact (Clopper and Pearson)."""
    curves = {}
    for who, by_speed in metrics["falls"].items():
        runs = metrics["runs"][who]
        curves[who] = {
            "at": [float(speed) for speed in by_speed],
            "share": [n / runs[speed] for speed, n in by_speed.items()],
            "interval": [interval_95(n, runs[speed]) for speed, n in by_speed.items()],
        }
    return rates({"": curves}, ("times as fast", "share of runs that fell"), title="Falls, twenty individuals a cell")


@captioned(
    "Impulse of a push of a tenth of a second that half of the runs survive, by its direction, at rest and in "
    "mid-movement. Further out is better."
)
def pushes(metrics: Mapping[str, Any]) -> Figure:
    """Impulse that half of the runs survive, by direction."""
    figure = Figure(figsize=(9, 4.6), layout="constrained")
    row = figure.subplots(1, 2, subplot_kw={"projection": "polar"})
    for axes, (when, all_) in zip(row, metrics["push_impulse_ns"].items(), strict=True):
        for who, impulses in all_.items():
            angle = np.arange(len(impulses) + 1) * 2 * np.pi / len(impulses)
            axes.plot(angle, [*impulses, impulses[0]], color=INK[who], label=who)
        axes.set_theta_zero_location("N")
        axes.set_title(f"{when} [N s]")
    row[0].legend(frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(-0.2, -0.1))
    figure.suptitle("Pushes of a tenth of a second that half of the runs survive (up: forward)", fontsize=11)
    return figure
