"""Figures of gaze following."""

from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from babbling.axes import FloatArray
from experiments.gaze.found import Found
from experiments.gaze.scene import FRAME_S, Following
from experiments.gaze.trials import TOYS
from experiments.shared.figures import captioned, legend_above, rates, sweeps
from experiments.shared.judging import interval_95
from experiments.shared.palette import BALLS, PLAIN


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
        told = "How often the bead that a teacher looks at was taken among four that lie close, with 95 % intervals "
        told += "over learners, beside readers that expect something else of the teacher. Dashed: chance."
        draw = captioned(told)(sweeps)
        drawn["crowds"] = draw(found.crowds.sweeps, 1 / len(TOYS), "share that took the bead looked at", caption)
    return drawn


@captioned(
    "Which toy does the teacher look at? The posterior over toys while the head turns, and the head's way "
    "beside how one's own head would look at each."
)
def episode(one: Following) -> Figure:
    """P(object) through time, the teacher's head on its way, and the poses expected "like me"."""
    figure = Figure(figsize=(11, 4.6), layout="constrained")
    belief, poses = figure.subplots(1, 2, width_ratios=[1.4, 1])
    watched = int(np.isfinite(one.estimated[:, 0]).sum())
    time = np.arange(watched) * FRAME_S
    for k, name in enumerate(one.names):
        mark = " (looked at)" if k == one.target else ""
        belief.plot(time, one.probability[:watched, k], color=BALLS[name], lw=2.2, label=name + mark)
    belief.set(
        xlabel="time [s]", ylabel="P(toy | pose of the head)", ylim=(-0.02, 1.02), title="Eq. (2) while the head turns"
    )
    legend_above(belief)
    poses.plot(*np.rad2deg(one.teacher[:watched]).T, color="k", lw=3, alpha=0.25, label="the teacher's head")
    poses.plot(*np.rad2deg(one.estimated[:watched]).T, color="k", lw=0.9, label="estimated")
    for name, pose in zip(one.names, np.rad2deg(one.expected), strict=True):
        poses.plot(*pose, "o", color=BALLS[name], ms=11, label=name)
    poses.invert_yaxis()
    poses.invert_xaxis()
    poses.margins(0.15)
    poses.set(xlabel="pan [deg], to its left", ylabel="tilt [deg], down", title='how I would look at each, "like me"')
    legend_above(poses, 3)
    return figure


@captioned(
    "How often the most probable toy was right, against how probable it was said to be; intervals are exact "
    "(95 %). On the diagonal, beliefs are worth what they say."
)
def calibration(bins: FloatArray, error: float) -> Figure:
    """How often the most probable object was right, against how probable it was."""
    sure, right, count = bins[bins[:, 2] > 0].T
    ends = [interval_95(round(hits), int(n)) for hits, n in zip(right * count, count, strict=True)]
    curve = {"confidence": sure, "share": right, "interval": ends}
    labels = "P(most probable toy)", "share that was right"
    figure = rates({f"calibration error {error:.3f}": {f"{count.sum():.0f} trials": curve}}, labels, line="")
    figure.axes[0].plot([0, 1], [0, 1], color=PLAIN, lw=1)
    return figure


@captioned(
    "How often the imitator looks where the head of a teacher with covered eyes points, by its age and what "
    "it has worn itself; intervals are exact (95 %). Above: what follows of it, where that many looks can tell."
)
def covered(result: dict[str, Any]) -> Figure:
    """Following of teachers with covered eyes, by age and own experience."""
    names = [fill(name, 10) for name in result["rates"]]
    panels = {}
    for cloth in ("blindfold", "headband"):
        found = {kind: [one[cloth][kind] for one in result["rates"].values()] for kind in ("rate", "interval_95")}
        panels[f"teacher wears a {cloth}"] = {"rate and 95 % interval": {"who": names, **found}}
    told = "\n".join(f"{sign}: {verdict['said']}" for sign, verdict in result["signs"].items())
    return rates(panels, ("", "share that looks where the head points"), ("chance", result["chance"]), told, line="")
