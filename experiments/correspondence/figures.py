"""Figures of `imitate correspondence`."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from experiments.correspondence.acts import HARDER
from experiments.correspondence.found import Studied
from experiments.shared.figures import learning_curve, sweeps
from experiments.shared.palette import OURS, PLAIN, THEIRS


def figures(done: Studied) -> dict[str, Figure]:
    """File stem -> figure."""
    return {
        "structure": structure(done),
        "teachers": teachers(done),
        "learning_curve": mirror_curve(done),
        "tries": tries(done),
        "harder_acts": sweeps(
            {HARDER[name][0]: sweep for name, sweep in done.harder.items()},
            1 / len(done.acts.parts),
            "put to the right part [%]",
            f"Which part moved? {done.config.harder_acts} acts for each learner and point; all are told that one did",
        ),
    }


def structure(done: Studied) -> Figure:
    """What each joint tells about each part, with noisy eyes."""
    organs, body = done.noisy.image.organs, done.noisy.body
    labels = [body.sense_labels[line] for line in done.noisy.pilot.schema.posture]
    order = [labels.index(joint) for joint in body.joints if joint in labels]
    figure = Figure(figsize=(11, 5.4), layout="constrained")
    axis = figure.subplots()
    picture = axis.imshow(organs.information[:, order], aspect="auto", cmap="magma", vmin=0, interpolation="nearest")
    for row, column in np.argwhere(organs.moves[:, order]):
        axis.plot(column, row, "o", color="white", mec="black", ms=4)
    axis.set_xticks(range(len(order)), [labels[i] for i in order], rotation=90, fontsize=7)
    axis.set_yticks(range(len(organs.parts)), organs.parts, fontsize=8)
    axis.set_xlabel("joint that acted (labels for people; the imitator knows numbers only)")
    axis.set_title(f"Organ identification: dots mark what moves what, {done.config.seeing_noise_deg:g} deg of noise")
    figure.colorbar(picture, ax=axis, label="mutual information of act and turning [bit]")
    return figure


def teachers(done: Studied) -> Figure:
    """Error of every teacher: oracle, clean eyes, noisy eyes."""
    names = [name if len(name) < 30 else Path(name).stem for name in done.rows]
    figure = Figure(figsize=(10, 0.55 * len(names) + 2.2), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    place = np.arange(len(names))
    errors = [[row.error_deg(who) for who in (row.oracle, row.clean, row.noisy)] for row in done.rows.values()]
    oracle, clean, noisy = np.array(errors).T
    left.barh(place - 0.2, oracle, 0.38, color=PLAIN, label="inverse kinematics")
    left.barh(place + 0.2, clean, 0.38, color=THEIRS, label="learned, clean eyes")
    left.plot(oracle + 0.3, place, "|", color="black", ms=16, label="oracle + 0.3 deg")
    right.barh(place, noisy, 0.5, color=OURS, label=f"learned, {done.config.seeing_noise_deg:g} deg of noise")
    right.plot(oracle + 2.5, place, "|", color="black", ms=16, label="oracle + 2.5 deg")
    left.set_yticks(place, names)
    left.invert_yaxis()
    for axis in (left, right):
        axis.set_xlabel("mean limb-direction error where it can be reached [deg]")
        axis.legend(frameon=False, fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
        axis.spines[["top", "right"]].set_visible(False)
    return figure


def mirror_curve(done: Studied) -> Figure:
    """Error against body time in front of the mirror."""
    minutes, clean, noisy = done.curve.T
    figure = learning_curve(
        minutes,
        {"clean eyes": np.maximum(clean, 1e-3), f"{done.config.seeing_noise_deg:g} deg of noise": noisy},
        ("in front of the mirror [body-minutes]", "limb-direction error [deg]"),
        f"{done.shown.performance.name}: how long must one look into the mirror?",
        ("inverse kinematics", done.shown.error_deg(done.shown.oracle)),
        log=True,
    )
    figure.axes[0].set_xticks(minutes, [f"{m:.2g}" for m in minutes])
    return figure


def tries(done: Studied) -> Figure:
    """First the right part, then the right way to move it."""
    figure = Figure(figsize=(10.5, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1, 1.15))
    parts = [*done.acts.parts, "nothing"]
    table = np.zeros((len(parts) - 1, len(parts)))
    np.add.at(table, (done.acts.truth, done.acts.said), 1)
    left.imshow(table / np.maximum(table.sum(1, keepdims=True), 1), cmap="Blues", vmin=0, vmax=1)
    for row, column in np.argwhere(table > 0):
        share = table[row, column] / table[row].sum()
        left.text(column, row, f"{int(table[row, column])}", ha="center", va="center", fontsize=7,
                  color="white" if share > 0.5 else "black")  # fmt: skip
    left.set_xticks(range(len(parts)), parts, rotation=90, fontsize=7)
    left.set_yticks(range(len(parts) - 1), parts[:-1], fontsize=7)
    left.set_xlabel("identified")
    left.set_ylabel("moved")
    left.set_title(f"which part: {done.acts.rate:.1%} of {len(done.acts.truth)} acts", fontsize=10)
    errors = done.acts.errors_deg
    number = np.arange(errors.shape[1])
    for low, high, shade in ((0.1, 0.9, 0.15), (0.25, 0.75, 0.3)):
        right.fill_between(number, np.quantile(errors, low, axis=0), np.quantile(errors, high, axis=0), color=OURS,
                           alpha=shade, lw=0, label=f"{round(100 * (high - low))} % of acts")  # fmt: skip
    right.plot(number, np.median(errors, axis=0), "o-", color=OURS, label="median")
    right.set_xticks(number, ["at rest", *map(str, number[1:])])
    right.set_xlabel("try")
    right.set_ylabel("the part points off by [deg]")
    right.set_title("then how to move it: error against tries", fontsize=10)
    right.set_ylim(bottom=0)
    right.legend(frameon=False)
    return figure
