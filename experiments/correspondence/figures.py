"""Figures of `imitate correspondence`."""

import numpy as np
from matplotlib.figure import Figure

from experiments.correspondence.acts import HARDER
from experiments.correspondence.found import Studied
from experiments.shared.figures import captioned, learning_curve, legend_above, spaced, sweeps
from experiments.shared.palette import DARK, OURS, PLAIN


def figures(done: Studied) -> dict[str, Figure]:
    """File stem -> figure."""
    return {
        "structure": structure(done),
        "teachers": teachers(done),
        "learning_curve": mirror_curve(done),
        "tries": tries(done),
        "harder_acts": captioned(
            "How often single acts of others were put to the right part as they get harder to see, with 95 % "
            "intervals over learners, beside simpler rules. Dashed: chance."
        )(sweeps)(
            {HARDER[name][0]: sweep for name, sweep in done.harder.items()},
            1 / len(done.acts.parts),
            "put to the right part",
            f"Which part moved? {done.config.harder_acts} acts for each learner and point; all are told that one did",
        ),
    }


@captioned(
    "What each joint's acts tell about where each part points, found in front of a mirror with noisy eyes. "
    "Dots mark what was taken to move what."
)
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
    axis.set_xticks(range(len(order)), [spaced(labels[i]) for i in order], rotation=90, fontsize=8)
    axis.set_yticks(range(len(organs.parts)), map(spaced, organs.parts), fontsize=9)
    axis.set(xlabel="joint that acted (names for people; the imitator knows numbers only)", ylabel="part that turned")
    axis.set_title(f"Organ identification: dots mark what moves what, {done.config.seeing_noise_deg:g} deg of noise")
    figure.colorbar(picture, ax=axis, label="mutual information of act and turning [bit]")
    return figure


@captioned(
    "How far the imitator's limbs would point beside each teacher's where it can reach them, learned in a "
    "mirror and by inverse kinematics, means over limbs and time. Marks: the error that the learned way may have, "
    "inverse kinematics' and so much more."
)
def teachers(done: Studied) -> Figure:
    """Error of every teacher: oracle, clean eyes, noisy eyes."""
    names = [row.label for row in done.rows.values()]
    figure = Figure(figsize=(10, 0.55 * len(names) + 2.2), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    place = np.arange(len(names))
    errors = [[row.error_deg(who) for who in (row.oracle, row.clean, row.noisy)] for row in done.rows.values()]
    oracle, clean, noisy = np.array(errors).T
    left.set_yticks(place, names)
    left.invert_yaxis()
    noise = f"{done.config.seeing_noise_deg:g} deg of noise"
    for axis, ours, allowed, title in ((left, clean, 0.3, "clean eyes"), (right, noisy, 2.5, noise)):
        for values, way, ink, name in ((oracle, -0.2, PLAIN, "inverse kinematics"), (ours, 0.2, OURS, "learned")):
            axis.bar_label(axis.barh(place + way, values, 0.38, color=ink, label=name), fmt=" %.3f", fontsize=7)
        axis.plot(oracle + allowed, place, "|", color=DARK, ms=12, label="asked for")
        axis.set(xlabel="limb-direction error [deg]", title=f"{title}: at most {allowed} deg more")
        legend_above(axis)
        axis.spines[["top", "right"]].set_visible(False)
    return figure


@captioned(
    "Error of the learned correspondence against body time in front of the mirror, with clean and with noisy "
    "eyes. The dashed line is inverse kinematics, which knows the body."
)
def mirror_curve(done: Studied) -> Figure:
    """Error against body time in front of the mirror."""
    minutes, clean, noisy = done.curve.T
    figure = learning_curve(
        minutes,
        {"clean eyes": np.maximum(clean, 1e-3), f"{done.config.seeing_noise_deg:g} deg of noise": noisy},
        ("in front of the mirror [body-minutes]", "limb-direction error [deg]"),
        f"{done.shown.performance.name}: how long must one look into the mirror?",
        ("inverse kinematics", done.shown.error_deg(done.shown.oracle)),
        log="xy",
    )
    figure.axes[0].set_xticks(minutes, [f"{m:.2g}" for m in minutes])
    figure.axes[0].set_xticks([], minor=True)
    return figure


@captioned(
    "First which part: how many single acts of others were put to which part. Then how: error of one's own act "
    "from try to try, of those acts whose part was right (median, and from the tenth to the ninetieth of a hundred)."
)
def tries(done: Studied) -> Figure:
    """First the right part, then the right way to move it."""
    figure = Figure(figsize=(10.5, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1, 1.15))
    parts = [*done.acts.parts, "nothing"]
    table = np.zeros((len(parts) - 1, len(parts)))
    np.add.at(table, (done.acts.truth, done.acts.said), 1)
    left.imshow(table / np.maximum(table.sum(1, keepdims=True), 1), cmap="Oranges", vmin=0, vmax=1)
    for row, column in np.argwhere(table > 0):
        share = table[row, column] / table[row].sum()
        left.text(column, row, f"{int(table[row, column])}", ha="center", va="center", fontsize=7,
                  color="white" if share > 0.5 else "black")  # fmt: skip
    left.set_xticks(range(len(parts)), map(spaced, parts), rotation=90, fontsize=7)
    left.set_yticks(range(len(parts) - 1), map(spaced, parts[:-1]), fontsize=7)
    left.set_xlabel("part that was taken to have moved")
    left.set_ylabel("part that moved")
    left.set_title(f"which part: {done.acts.rate:.1%} of {len(done.acts.truth)} acts", fontsize=10)
    number = np.arange(float(done.acts.errors_deg.shape[1]))
    low, median, high = np.quantile(done.acts.errors_deg, (0.1, 0.5, 0.9), axis=0)
    right.fill_between(number, low, high, color=OURS, alpha=0.2, lw=0, label="80 % of acts")
    labels = "try (0: at rest)", "the part points off by [deg]"
    learning_curve(number, {"median": median}, labels, "then how to move it: error against tries", onto=right)
    right.set_ylim(0, 1.05 * high.max())
    right.title.set_fontsize(10)
    right.set_xticks(number)
    return figure
