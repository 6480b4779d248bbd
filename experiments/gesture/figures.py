"""Figures of `imitate gesture`."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure, SubFigure

from babbling.explanations import EXPLANATIONS
from experiments.gesture.found import Performed
from experiments.shared.figures import learning_curve
from experiments.shared.judging import LearningCurve
from experiments.shared.palette import DARK, INKS, OURS, PLAIN, THEIRS


def figures(done: Performed, metrics: Mapping[str, float]) -> dict[str, Figure]:
    """File stem -> figure."""
    made = {"imitation": imitation(done, metrics), "body_schema": body_schema(done), "explanations": explanations(done)}
    if done.learned.curve is not None:
        made["learning_curve"] = babbling_curve(done.learned.curve)
    return made


def imitation(done: Performed, metrics: Mapping[str, float]) -> Figure:
    """Limb directions against the teacher's; the joints that move most: sub-goals, imitated, replayed, and errors."""
    chosen = done.busiest[:4]
    time = np.arange(len(done.seen.angles)) * done.body.tick_s
    figure = Figure(figsize=(11, 9), layout="constrained")
    below: Figure | SubFigure = figure
    if done.seen.oracle is not None:
        top, below = figure.subfigures(2, 1, squeeze=False, height_ratios=(1, 3))[:, 0]
        limbs(top, done, done.seen.oracle.found.parts)
    axes = below.subplots(len(chosen), 2, sharex=True, width_ratios=(1.5, 1), squeeze=False)
    for (left, right), joint in zip(axes, chosen, strict=True):
        wanted, scale = done.body.shown_scale[joint] * done.seen.angles[:, joint], done.body.shown_scale[joint]
        for values, colour, label, width in (
            (scale * done.replayed[:, joint], PLAIN, "replayed", 1.0),
            (wanted, THEIRS, "sub-goals", 2.6),
            (scale * done.imitated[:, joint], OURS, "imitated", 1.1),
        ):
            left.plot(time, values, color=colour, label=label, lw=width)
            if label != "sub-goals":
                right.plot(time, values - wanted, color=colour, lw=0.9)
        left.set_ylabel(f"{done.body.joints[joint]}\n[{done.body.shown_units[joint]}]", fontsize=8)
        right.axhline(0, color="black", lw=0.4)
    axes[0, 0].legend(frameon=False, ncols=3, fontsize=8)
    axes[0, 0].set_title(f"{done.seen.movement.name}: joint angles")
    axes[0, 1].set_title(f"error [{' or '.join(sorted({*done.body.shown_units}))}]")
    for axis in axes[-1]:
        axis.set_xlabel("time [s]")
    told = "RMSE of all joints against sub-goals: " + "; ".join(
        f"imitated {metrics[f'joint_rmse_{shown}']:.3f} {shown}, "
        f"direct replay {metrics[f'direct_replay_rmse_{shown}']:.3f} {shown}"
        for shown in sorted({*done.body.shown_units})
    )
    if done.seen.oracle is not None:
        told = (
            f"limb directions off by {metrics['limb_error_deg']:.2f} deg, where this body's joints allow no less than "
            f"{metrics['limb_reachable_deg']:.2f}; slowed {metrics['slowed_factor']:.2f} times\n{told}"
        )
    figure.suptitle(told, fontsize=11)
    return figure


def limbs(figure: SubFigure, done: Performed, parts: Sequence[str]) -> None:
    """How far off the teacher's the limbs point: through time, and part by part."""
    left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
    time = np.arange(len(done.imitated)) * done.body.tick_s
    shown = {"replayed": PLAIN, "imitated": OURS, "least": DARK}
    for number, (who, colour) in enumerate(shown.items()):
        error = done.limb_errors_deg[who]
        left.plot(time, error.mean(1), color=colour, label=who.replace("least", "the joints' limit"), lw=1.1)
        right.bar(np.arange(error.shape[1]) + 0.27 * (number - 1), error.mean(0), 0.27, color=colour)
    left.set_title("limb directions off the teacher's [deg]")
    left.legend(frameon=False, ncols=3, fontsize=8)
    right.set_xticks(range(len(parts)), [part.replace("_", " ") for part in parts], rotation=90, fontsize=6)


def explanations(done: Performed) -> Figure:
    """How probable each explanation of each joint's movements has become."""
    weights = done.learned.mind.forward_model.weights[done.factors]
    figure = Figure(figsize=(11, 3.8), layout="constrained")
    axis = figure.subplots()
    below = np.zeros(len(weights))
    for name, colour, share in zip(EXPLANATIONS, (PLAIN, THEIRS, DARK, INKS["green"], OURS), weights.T, strict=True):
        axis.bar(range(len(share)), share, bottom=below, color=colour, label=name)
        below += share
    axis.set_xticks(
        range(len(weights)), [joint.replace("_", " ") for joint in done.body.joints], rotation=90, fontsize=7
    )
    axis.set_ylabel("P(explanation | babbling)")
    axis.set_title("What explains each joint best: a line, posture, plays, what weighs on it, or the table beyond")
    axis.legend(frameon=False, ncols=5, fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.08))
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
        {"average of explanations": curve.table, "least-squares line, same experience": curve.line},
        ("babbling [body-minutes]", f"error of predicted posture, one tick ahead [{curve.unit}]"),
        "Learning curve on held-out babbling",
        None if floor is None else (f"table after {floor[0]:.0f} body-minutes", floor[1]),
    )
