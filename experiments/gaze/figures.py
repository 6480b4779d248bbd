"""Figures of gaze following."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from babbling.axes import FloatArray
from experiments.gaze.found import Found
from experiments.gaze.scene import FRAME_S, Following
from experiments.gaze.trials import TOYS
from experiments.shared.figures import sweeps
from experiments.shared.palette import INKS, OURS


def figures(found: Found) -> dict[str, Figure]:
    """All of them, by file stem."""
    drawn = {
        "episode": episode(found.episode),
        "calibration": calibration(found.calibration, found.calibration_error),
        "covered_eyes": covered(found.covered),
    }
    if found.crowds is not None:
        aim = f"a head that points at it within {found.who.config.aim_deg:g} deg (standard deviation, each axis)"
        caption = f"Which of four beads is looked at? {aim}, and how it differs from what a reader expects"
        drawn["crowds"] = sweeps(found.crowds.sweeps, 1 / len(TOYS), "took the bead looked at [%]", caption)
    return drawn


def episode(one: Following) -> Figure:
    """P(object) through time, the teacher's head on its way, and the poses expected "like me"."""
    figure = Figure(figsize=(11, 4.6), layout="constrained")
    belief, poses = figure.subplots(1, 2, width_ratios=[1.4, 1])
    watched = int(np.isfinite(one.estimated[:, 0]).sum())
    time = np.arange(watched) * FRAME_S
    for k, name in enumerate(one.names):
        mark = " (looked at)" if k == one.target else ""
        belief.plot(time, one.probability[:watched, k], color=INKS[name], lw=2.2, label=name + mark)
    belief.set(
        xlabel="s", ylabel="P(object | pose of the head)", ylim=(-0.02, 1.05), title="Eq. (2) while the head turns"
    )
    belief.legend(frameon=False, fontsize=9)
    poses.plot(*np.rad2deg(one.teacher[:watched]).T, color="k", lw=3, alpha=0.25, label="the teacher's head")
    poses.plot(*np.rad2deg(one.estimated[:watched]).T, color="k", lw=0.9, label="estimated")
    for k, name in enumerate(one.names):
        poses.plot(*np.rad2deg(one.expected[k]), "o", color=INKS[name], ms=11)
        poses.annotate(
            name, np.rad2deg(one.expected[k]), xytext=(0, 9), textcoords="offset points", ha="center", fontsize=8
        )
    poses.invert_yaxis()
    poses.invert_xaxis()
    poses.margins(0.15)
    poses.set(xlabel="pan [deg], to its left", ylabel="tilt [deg], down", title='how I would look at each, "like me"')
    poses.legend(frameon=False, fontsize=8)
    return figure


def calibration(bins: FloatArray, error: float) -> Figure:
    """How often the most probable object was right, against how probable it was."""
    figure = Figure(figsize=(5.2, 4.8), layout="constrained")
    axes, counts = figure.subplots(2, 1, height_ratios=[3, 1], sharex=True)
    sure, right, count = bins[bins[:, 2] > 0].T
    half = np.sqrt(np.maximum(right * (1 - right), 0.02) / count) * 1.96
    axes.plot([0, 1], [0, 1], color="0.7", lw=1)
    axes.errorbar(sure, right, half, fmt="o", color=OURS, capsize=3, lw=1)
    axes.set(ylabel="share that was right", title=f"calibration error {error:.3f}", ylim=(0, 1.1))
    counts.bar(sure, count, 0.05, color="0.6")
    counts.set(xlabel="P of the most probable object", ylabel="trials", xlim=(0.2, 1.02))
    return figure


def covered(result: dict[str, Any]) -> Figure:
    """Following of teachers with covered eyes, by age and own experience."""
    figure = Figure(figsize=(9.5, 4.2), layout="constrained")
    axes = figure.subplots()
    names = list(result["rates"])
    for offset, (cloth, colour) in enumerate((("blindfold", "#333333"), ("headband", "#c2a15a"))):
        rates = [result["rates"][name][cloth] for name in names]
        x = np.arange(len(names)) + 0.36 * offset - 0.18
        y = np.array([r["rate"] for r in rates])
        ends = np.abs(np.array([r["interval_95"] for r in rates]).T - y)
        axes.bar(x, 100 * y, 0.34, color=colour, label=f"teacher wears a {cloth}", yerr=100 * ends, capsize=3,
                 error_kw={"lw": 0.9, "ecolor": "#888888"})  # fmt: skip
    axes.axhline(100 * result["chance"], color="0.5", ls=":", lw=1)
    axes.annotate("chance", (-0.55, 100 * result["chance"] + 1), fontsize=8, color="0.4")
    axes.set_xticks(range(len(names)), [name.replace(", ", "\n") for name in names], fontsize=8)
    axes.set(ylabel="looks where the teacher's head points [%]", ylim=(0, 118))
    axes.legend(frameon=False, fontsize=9, ncols=2, loc="upper center")
    return figure
