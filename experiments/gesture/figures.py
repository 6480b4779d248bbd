"""Figures of `imitate gesture`."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from experiments.gesture.found import Performed
from experiments.shared.figures import learning_curve
from experiments.shared.judging import LearningCurve
from experiments.shared.palette import OURS, PLAIN, THEIRS


def figures(done: Performed, metrics: Mapping[str, float]) -> dict[str, Figure]:
    """File stem -> figure."""
    made = {"imitation": imitation(done, metrics), "body_schema": body_schema(done)}
    if done.learned.curve is not None:
        made["learning_curve"] = babbling_curve(done.learned.curve)
    return made


def imitation(done: Performed, metrics: Mapping[str, float]) -> Figure:
    """The joints that move most: demonstrated, imitated, replayed; and what either missed by."""
    chosen = done.busiest[:4]
    time = np.arange(len(done.seen.angles)) * done.body.tick_s
    figure = Figure(figsize=(11, 8), layout="constrained")
    axes = figure.subplots(len(chosen), 2, sharex=True, width_ratios=(1.5, 1), squeeze=False)
    for (left, right), joint in zip(axes, chosen, strict=True):
        wanted = np.rad2deg(done.seen.angles[:, joint])
        for values, colour, label, width in (
            (np.rad2deg(done.replayed[:, joint]), PLAIN, "replayed", 1.0),
            (wanted, THEIRS, "demonstrated", 2.6),
            (np.rad2deg(done.imitated[:, joint]), OURS, "imitated", 1.1),
        ):
            left.plot(time, values, color=colour, label=label, lw=width)
            if label != "demonstrated":
                right.plot(time, values - wanted, color=colour, lw=0.9)
        left.set_ylabel(f"{done.body.joints[joint]}\n[deg]", fontsize=8)
        right.axhline(0, color="black", lw=0.4)
    axes[0, 0].legend(frameon=False, ncols=3, fontsize=8)
    axes[0, 0].set_title(f"{done.seen.movement.name}: joint angles")
    axes[0, 1].set_title("error [deg]")
    for axis in axes[-1]:
        axis.set_xlabel("time [s]")
    figure.suptitle(
        f"RMSE over all joints: imitated {metrics['joint_rmse_deg']:.3f} deg, "
        f"direct replay {metrics['direct_replay_rmse_deg']:.3f} deg",
        fontsize=11,
    )
    return figure


def body_schema(done: Performed) -> Figure:
    """Mutual information of every motor line and every sense line."""
    information = done.learned.mind.pilot.schema.information
    figure = Figure(figsize=(11, 6.5), layout="constrained")
    axis = figure.subplots()
    picture = axis.imshow(information, aspect="auto", cmap="magma", interpolation="nearest")
    axis.set_xticks(range(information.shape[1]), done.body.sense_labels, rotation=90, fontsize=5.5)
    axis.set_yticks(range(information.shape[0]), done.body.motor_labels, fontsize=6)
    axis.set_xlabel("sense lines (labels for people; the mind does not know them)")
    axis.set_ylabel("motor lines")
    axis.set_title("Body schema: what each sense tells about each motor")
    figure.colorbar(picture, ax=axis, label="mutual information [bit]")
    return figure


def babbling_curve(curve: LearningCurve, floor: tuple[float, float] | None = None) -> Figure:
    """Held-out prediction error against body time; `floor` is (minutes, degrees) of a far longer babble."""
    return learning_curve(
        curve.minutes,
        {"forward model (table)": curve.table, "least-squares line, same experience": curve.line},
        ("babbling [body-minutes]", "error of predicted posture, one tick ahead [deg]"),
        "Learning curve on held-out babbling",
        None if floor is None else (f"table after {floor[0]:.0f} body-minutes", floor[1]),
    )
