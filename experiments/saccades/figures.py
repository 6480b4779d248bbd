"""Figures of oculomotor babbling: what was learned, how well it predicts, how well it looks."""

import numpy as np
from matplotlib.figure import Figure

from babbling.axes import FloatArray
from babbling.looking import LookingMind
from experiments.saccades.trials import Fixated, Predicted
from experiments.shared.figures import captioned, learning_curve, legend_above
from experiments.shared.judging import LearningCurve
from experiments.shared.palette import OURS, THEIRS
from experiments.shared.views import AXES


def figures(
    mind: LookingMind, trials: Predicted, guess: FloatArray, fixated: Fixated, curve: LearningCurve
) -> dict[str, Figure]:
    """All of them, by file stem."""
    return {
        "prediction": prediction(mind, trials, guess),
        "fixation": fixation(mind, fixated),
        "learning_curve": captioned(
            "Error of where things are expected after an unseen saccade, against body time of babbling. Below it, "
            "the efference copy alone: what a line fitted by the pilot makes of it."
        )(learning_curve)(
            curve.minutes,
            {"forward model": curve.table, "efference copy alone (least squares of the pilot)": curve.line},
            ("babbling, pilot included [body-minutes]", "error after an unseen saccade [px]"),
        ),
        "forward_model": forward_model(mind),
    }


@captioned(
    "Where things stood before and after saccades that were never made before, and where they were expected; "
    "the distribution of errors beside the efference copy alone. A sighting counts once."
)
def prediction(mind: LookingMind, trials: Predicted, guess: FloatArray) -> Figure:
    """Where things went and where they were expected; the errors' distribution."""
    half = mind.pilot.retina.half
    figure = Figure(figsize=(11, 4.6), layout="constrained")
    field, errors = figure.subplots(1, 2, width_ratios=[1.25, 1])
    seen = np.flatnonzero(np.isfinite(trials.before[:, 0] + trials.after[:, 0]))[:60]
    for i in seen:
        (u, v), (x, y) = trials.before[i, :2], trials.after[i, :2]
        field.annotate("", (x, y), (u, v), arrowprops={"arrowstyle": "-", "color": "0.8", "lw": 0.8})
    field.plot(*trials.before[seen, :2].T, "o", color="0.7", ms=3, label="before")
    field.plot(*trials.after[seen, :2].T, "o", color="k", ms=5, mfc="none", label="after the saccade")
    field.plot(*guess[seen, :2].T, "x", color=OURS, ms=5, label="expected")
    field.set(xlim=(-half[0], half[0]), ylim=(half[1], -half[1]), aspect="equal")
    field.set(xlabel="u from the middle [px]", ylabel="v from the middle [px]", title="unseen saccades, left eye")
    field.legend(loc="upper center", ncols=3, fontsize=8, bbox_to_anchor=(0.5, -0.14), frameon=False)
    bins = np.geomspace(0.01, 10, 50)
    peer = trials.error(mind.expect(trials.before, trials.posture, trials.change, table=False))
    for values, colour, name in ((trials.error(guess), OURS, "forward model"), (peer, THEIRS, "efference copy alone")):
        errors.hist(values, bins, histtype="step", color=colour, lw=1.8, label=f"{name}: {values.mean():.3f} px")
        errors.axvline(values.mean(), color=colour, lw=1, ls=":")
    errors.axvline(0.5, color="0.5", lw=1, ls="--")
    errors.annotate("0.5 px", (0.5, 1.0), xycoords=("data", "axes fraction"), xytext=(4, 2), va="bottom",
                    textcoords="offset points", fontsize=8, color="0.4")  # fmt: skip
    errors.set(xscale="log", xlabel="error of the expected position [px]", ylabel="sightings [number]")
    legend_above(errors, 1)
    return figure


@captioned(
    "Where things were when they drew the eye, by how near to the middle one saccade brought them, and shares "
    "of trials within so many pixels after one and two saccades."
)
def fixation(mind: LookingMind, fixated: Fixated) -> Figure:
    """Where trials began and where things stood after one saccade; shares within so many pixels."""
    half = mind.pilot.retina.half
    figure = Figure(figsize=(11, 4.4), layout="constrained")
    field, share = figure.subplots(1, 2, width_ratios=[1.25, 1])
    reached = np.minimum(fixated.once, 3.0)
    dots = field.scatter(*fixated.start.T, c=reached, s=14, cmap="viridis", vmin=0, vmax=max(0.5, reached.max()))
    figure.colorbar(dots, ax=field, label="after one saccade, from the middle [px]", shrink=0.85)
    field.plot(0, 0, "+", color="k", ms=12)
    field.set(xlim=(-half[0], half[0]), ylim=(half[1], -half[1]), aspect="equal")
    field.set(
        xlabel="u from the middle [px]",
        ylabel="v from the middle [px]",
        title=f"where {len(reached)} things were when they drew the eye",
    )
    for values, colour, name in ((fixated.once, OURS, "one saccade"), (fixated.twice, THEIRS, "two saccades")):
        share.step(np.sort(values), 100 * np.arange(1, len(values) + 1) / len(values), color=colour, label=name)
    share.axvline(1.5, color="0.5", ls="--", lw=1)
    share.set(
        xlim=(0, 2),
        ylim=(0, 101),
        xlabel="distance from the middle [px]",
        ylabel="share of trials [%]",
        title="fixated within",
    )
    legend_above(share)
    return figure


@captioned(
    "What babbling taught: where the picture goes when either motor moves, over the whole retina. On the "
    "right what the table adds to the efference copy, enlarged fifty times."
)
def forward_model(mind: LookingMind) -> Figure:
    """What babbling taught: displacement fields of a pan and a tilt saccade, and what the table adds to the copy."""
    half = mind.pilot.retina.half
    figure = Figure(figsize=(12, 7), layout="constrained")
    axes = figure.subplots(2, 2)
    u, v = np.meshgrid(np.linspace(-0.85, 0.85, 9) * half[0], np.linspace(-0.85, 0.85, 7) * half[1])
    things = np.stack([u.ravel(), v.ravel()] * 2, axis=-1)
    for row, name in enumerate(AXES):
        change = np.zeros((len(things), 2))
        change[:, row] = np.deg2rad((10.0, 8.0)[row])
        posture = np.zeros((len(things), 2))
        posture[:, 1 - row] = 0.3 if row == 0 else 0.0
        whole = mind.expect(things, posture, change)[:, :2] - things[:, :2]
        copy = mind.expect(things, posture, change, table=False)[:, :2] - things[:, :2]
        where = f"motor {row} ({name}) by {np.rad2deg(change[0, row]):.0f} deg"
        where += f", tilt at {np.rad2deg(0.3):.0f} deg" if row == 0 else ""
        note = f"the table's share (x 50, at most {np.hypot(*(whole - copy).T).max():.2f} px)"
        for shown, field, scale, ink, title in (
            (axes[row, 0], whole, 1.0, "k", "displacement"),
            (axes[row, 1], whole - copy, 0.02, OURS, note),
        ):
            places = things[:, :2].T
            shown.quiver(*places, *field.T, angles="xy", scale_units="xy", scale=scale, width=0.003, color=ink)
            shown.set(xlabel="u from the middle [px]", ylabel="v from the middle [px]", aspect="equal")
            shown.set_title(f"{where}: {title}", fontsize=10)
            shown.set(xlim=(-1.15 * half[0], 1.15 * half[0]), ylim=(1.15 * half[1], -1.15 * half[1]))
    return figure
