"""Figures of `imitate gesture`."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from babbling.axes import FloatArray
from babbling.explanations import EXPLANATIONS
from experiments.gesture.found import Performed
from experiments.shared.figures import captioned, learning_curve, legend_above, spaced
from experiments.shared.judging import LearningCurve
from experiments.shared.palette import CYCLE, DARK, OURS, PLAIN, THEIRS, glowing

DECADE = 10.0
REACH = 6.0
"""Standard deviations to either side of where a posterior lies."""


def figures(done: Performed, metrics: Mapping[str, Any]) -> dict[str, Figure]:
    """File stem -> figure."""
    made = {"imitation": imitation(done, metrics), "ringing": ringing(done), "beliefs": beliefs(done)}
    made |= {"body_schema": body_schema(done), "explanations": explanations(done)}
    if done.learned.curve is not None:
        made["learning_curve"] = babbling_curve(done.learned.curve)
    return made


@captioned(
    "What every joint missed of its sub-goals, worst on top, and all of them through time (band: from the "
    "best to the worst attempt). Where a teacher was watched, below: how far the limbs point beside the "
    "teacher's, and the least that this body's joints allow."
)
def imitation(done: Performed, metrics: Mapping[str, Any]) -> Figure:
    """Error of every joint beside its peers'; of all joints through time, attempt by attempt; and of the limbs."""
    limbs_too = done.seen.oracle is not None
    figure = Figure(figsize=(12, 3 + 0.17 * max(len(done.body.joints), 20) + 3 * limbs_too), layout="constrained")
    below: Figure | SubFigure = figure
    if limbs_too:
        below, last = figure.subfigures(2, 1, squeeze=False, height_ratios=(1.9, 1))[:, 0]
        limbs(last, done)
    left, right = below.subplots(1, 2, width_ratios=(1, 1.25))
    by_joint(left, done)
    through_time(right, done)
    units = sorted({*done.body.shown_units})
    told = "; ".join(
        f"imitated {metrics[f'joint_rmse_{unit}']:.3g} {unit}, direct replay "
        f"{metrics[f'direct_replay_rmse_{unit}']:.3g} {unit}"
        for unit in units
    )
    figure.suptitle(f"{done.title}: root mean square of all joints, {told}", fontsize=11)
    return figure


def by_joint(axes: Axes, done: Performed) -> None:
    """Root mean square error of each joint, the worst of them on top."""
    whose = {"direct replay": (done.replayed, PLAIN, "s"), "a line, same loop": (done.peer.truth[:, 0], DARK, "|")}
    whose["imitated"] = (done.imitated, OURS, "o")
    errors = {who: np.sqrt(np.mean(done.away(angles) ** 2, 0)) for who, (angles, _, _) in whose.items()}
    order = np.argsort(errors["imitated"])
    rows = np.arange(len(order))
    axes.hlines(rows, errors["imitated"][order], errors["direct replay"][order], color="#cccccc", lw=1.5, zorder=0)
    for who, (_, ink, mark) in whose.items():
        axes.scatter(errors[who][order], rows, color=ink, marker=mark, s=26, label=who)
    axes.set_yticks(rows, [spaced(done.body.joints[j]) for j in order], fontsize=7)
    axes.set(
        xscale="log",
        xlabel=f"root mean square error [{' or '.join(sorted({*done.body.shown_units}))}]",
        ylim=(-1, len(rows)),
    )
    axes.grid(alpha=0.25, axis="x")
    legend_above(axes)


def through_time(axes: Axes, done: Performed) -> None:
    """Root mean square over joints of one unit at every tick; the band is from the least to the greatest attempt."""
    time, alike = np.arange(len(done.seen.angles)) * done.body.tick_s, done.joints_in(done.usual)

    def away(angles: FloatArray) -> FloatArray:
        return np.asarray(np.sqrt(np.mean(done.away(angles)[:, alike] ** 2, 1)))

    axes.plot(time, away(done.replayed), color=PLAIN, lw=1.2, label="direct replay")
    axes.plot(time, away(done.peer.truth[:, 0]), color=DARK, lw=1, ls=":", label="a line, same loop")
    tries = [away(attempt.truth[:, 0]) for attempt in done.attempts]
    if len(tries) > 1:
        whole = np.stack([one for one in tries if len(one) == len(time)])
        axes.fill_between(time, whole.min(0), whole.max(0), color=OURS, alpha=0.25, lw=0, label="all attempts")
    axes.plot(time[: len(tries[-1])], tries[-1], color=OURS, lw=1.4, label=f"imitated, attempt {len(tries)}")
    axes.set(yscale="log", xlabel="time [s]", ylabel=f"error of all joints, root mean square [{done.usual}]")
    axes.grid(alpha=0.25)
    legend_above(axes)


def limbs(figure: SubFigure, done: Performed) -> None:
    """How far off the teacher's the limbs point: through time, and part by part."""
    assert done.seen.oracle is not None
    parts = done.seen.oracle.found.parts
    left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
    time = np.arange(len(done.imitated)) * done.body.tick_s
    shown = {"replayed": PLAIN, "imitated": OURS, "least": DARK}
    for number, (who, colour) in enumerate(shown.items()):
        error = done.limb_errors_deg[who]
        left.plot(time, error.mean(1), color=colour, label=who.replace("least", "the joints' limit"), lw=1.1)
        right.bar(np.arange(error.shape[1]) + 0.27 * (number - 1), error.mean(0), 0.27, color=colour)
    left.set(xlabel="time [s]", ylabel="limbs off the teacher's, mean [deg]")
    legend_above(left)
    right.set_xticks(range(len(parts)), [spaced(part) for part in parts], rotation=90, fontsize=7)
    right.set_ylabel("the same, mean of frames [deg]")


@captioned(
    "Amplitude spectra of the joints' errors over the whole movement (Hann window). A body that chatters has "
    "a hump near half of the control rate, which a root mean square over time hides."
)
def ringing(done: Performed) -> Figure:
    """Amplitude spectrum of every joint's error: what shakes stands out on the right."""
    figure = Figure(figsize=(8, 4.4), layout="constrained")
    axes = figure.subplots()
    count, alike = len(done.imitated), done.joints_in(done.usual)
    window = np.hanning(count)[:, None]
    hertz = np.fft.rfftfreq(count, done.body.tick_s)
    for who, angles, ink in (("direct replay", done.replayed, PLAIN), ("imitated", done.imitated, OURS)):
        error = done.away(angles)[:, alike]
        height = 2 * np.abs(np.fft.rfft((error - error.mean(0)) * window, axis=0)) / window.sum()
        axes.plot(hertz[1:], np.median(height, 1)[1:], color=ink, lw=1.2, label=f"{who}, median of joints")
        axes.plot(
            hertz[1:], height.max(1)[1:], color=ink, lw=0.9, ls=":", label=f"{who}, worst joint at each frequency"
        )
    axes.set(xlabel="frequency [Hz]", ylabel=f"amplitude of the error [{done.usual}]", yscale="log")
    axes.set_title(f"{done.title}: does it shake?")
    axes.grid(alpha=0.25)
    legend_above(axes, 2)
    return figure


@captioned(
    "How sure every joint was of its next command, how likely its sub-goal was at all, and how often babbling "
    "had been in the row that was chosen (0: never tried), at every tick of the last attempt."
)
def beliefs(done: Performed) -> Figure:
    """Entropy and evidence of Eq. (1) and what was never tried, of every joint at every tick of the last attempt."""
    last, order = done.attempts[-1], done.factors
    evidence = np.log10(np.maximum(last.evidence[:, 0], 1e-30))
    maps = {
        "entropy of P(action) [bit]": (last.entropy[:, 0], "magma"),
        "evidence of Eq. (1) [log10]": (evidence, "viridis"),
        "visits of the chosen row [log10(1 + n)]": (np.log10(1 + last.familiarity), "cividis"),
    }
    rows, names = np.flatnonzero(order >= 0), [spaced(joint) for joint in done.body.joints]
    figure = Figure(figsize=(12, 1.6 + 0.13 * max(len(rows), 12)), layout="constrained")
    end = len(last.entropy) * done.body.tick_s
    for axes, (title, (values, colours)) in zip(figure.subplots(1, 3, sharey=True), maps.items(), strict=True):
        shown = values[:, order[rows]].T
        picture = axes.imshow(
            shown, aspect="auto", cmap=colours, extent=(0, end, len(rows) - 0.5, -0.5), interpolation="nearest"
        )
        axes.set(xlabel="time [s]")
        axes.set_title(title, fontsize=9)
        figure.colorbar(picture, ax=axes, pad=0.01)
    figure.axes[0].set_yticks(range(len(rows)), [names[j] for j in rows], fontsize=6)
    return figure


@captioned(
    "P(command | sub-goal) of Eq. (1), the brighter the likelier, by how far beside its sub-goal (blue) one commands; "
    "white: the command that was chosen."
)
def posterior(done: Performed, joint: int) -> Figure:
    """P(command | sub-goal) of a joint through time, by how far beside its sub-goal one commands."""
    places, mass = beside_target(done, joint)
    end, unit = len(mass) * done.body.tick_s, done.body.shown_units[joint]
    figure = Figure(figsize=(7.5, 3), layout="constrained")
    axes = figure.subplots()
    extent = (0, end, places[0], places[-1])
    axes.imshow(mass.T**0.5, origin="lower", aspect="auto", cmap=glowing(OURS), extent=extent)
    time = np.arange(len(mass)) * done.body.tick_s
    axes.plot(time, chosen_beside(done, joint), color="white", lw=0.7)
    axes.axhline(0, color=THEIRS, lw=1)
    axes.set(xlabel="time [s]", ylabel=f"command - sub-goal [{unit}]", ylim=(places[0], places[-1]))
    return figure


def chosen_beside(done: Performed, joint: int) -> FloatArray:
    """(T,) commanded posture less the sub-goal it serves, in what people read."""
    last, factor = done.attempts[-1], done.factors[joint]
    return np.asarray(done.body.shown_scale[joint] * (last.commands[:, 0, factor] - _served(done, joint)))


def beside_target(done: Performed, joint: int, bars: int = 121) -> tuple[FloatArray, FloatArray]:
    """(bars,) how far beside the sub-goal, and (T, bars) the probability mass of Eq. (1) there."""
    last, factor, scale = done.attempts[-1], done.factors[joint], done.body.shown_scale[joint]
    origin = last.origin[:, 0, factor] - _served(done, joint)
    away = scale * (last.candidates[:, factor] + origin[:, None])
    chance = last.posterior[:, factor]
    middle = (away * chance).sum(1)
    spread = np.sqrt((chance * (away - middle[:, None]) ** 2).sum(1))
    reach = float(max(np.abs(middle).max(), np.abs(chosen_beside(done, joint)).max()) + REACH * np.median(spread))
    places = np.linspace(-reach, reach, bars)
    density = chance / np.gradient(away, axis=1)
    mass = np.stack([np.interp(places, *tick, left=0, right=0) for tick in zip(away, density, strict=True)])
    return places, np.asarray(mass / np.maximum(mass.sum(1, keepdims=True), 1e-300))


def _served(done: Performed, joint: int) -> FloatArray:
    """(T,) the sub-goal that a command of tick t is for: the one after it."""
    count = len(done.attempts[-1].commands)
    ahead = np.minimum(np.arange(count) + 1, len(done.seen.angles) - 1)
    return np.asarray(done.seen.angles[ahead, joint])


@captioned(
    "What babbling made of every joint: the probability of five rival explanations of its movements, given "
    "what was felt. Eq. (1) asks all of them, each as much as it is believed."
)
def explanations(done: Performed) -> Figure:
    """How probable each explanation of each joint's movements has become."""
    weights = done.learned.mind.forward_model.weights[done.factors]
    figure = Figure(figsize=(11, 3.8), layout="constrained")
    axis = figure.subplots()
    below = np.zeros(len(weights))
    for name, colour, share in zip(EXPLANATIONS, (PLAIN, THEIRS, DARK, CYCLE[2], OURS), weights.T, strict=True):
        axis.bar(range(len(share)), share, bottom=below, color=colour, label=name)
        below += share
    axis.set_xticks(range(len(weights)), [spaced(joint) for joint in done.body.joints], rotation=90, fontsize=7)
    axis.set(ylabel="P(explanation | babbling)", xlim=(-0.6, len(weights) - 0.4))
    axis.set_title("What explains each joint best: a line, posture, plays, what weighs on it, or the table beyond")
    legend_above(axis, 5)
    return figure


@captioned(
    "Mutual information of every motor line and every sense line, found by moving. The brightest cell of a "
    "row is the sense that its motor moves; names are for people, the imitator knows numbers only."
)
def body_schema(done: Performed) -> Figure:
    """Mutual information of every motor line and every sense line."""
    information = done.learned.mind.pilot.schema.information
    figure = Figure(figsize=(11, 6.5), layout="constrained")
    axis = figure.subplots()
    picture = axis.imshow(information, aspect="auto", cmap="magma", interpolation="nearest")
    axis.set_xticks(range(information.shape[1]), map(spaced, done.body.sense_labels), rotation=90, fontsize=6)
    axis.set_yticks(range(information.shape[0]), map(spaced, done.body.motor_labels), fontsize=7)
    axis.set_xlabel("sense lines (labels for people; the mind does not know them)")
    axis.set_ylabel("motor lines")
    axis.set_title("Body schema: what each sense tells about each motor")
    figure.colorbar(picture, ax=axis, label="mutual information [bit]")
    return figure


@captioned(
    "Error of predicting the posture one tick ahead, on babbling that was held out, against body time (the pilot "
    "counts; before its end, on the axes that all of it found). The line is the least-squares fit of the same "
    "experience. Floor: what the simulator itself would miss, told the true state, as noise and pulses of the next "
    "senses cannot be foretold."
)
def babbling_curve(curve: LearningCurve) -> Figure:
    """Held-out prediction error against body time, with the line's and the floor; the end of the pilot is marked."""
    floor = curve.floor or None  # senses without noise have none
    drawn = [*curve.table, *curve.line, *([floor] if floor else [])]
    figure = learning_curve(
        curve.minutes,
        {"average of explanations": curve.table, "least-squares line, same experience": curve.line},
        ("body-minutes, pilot included", f"error of predicted posture, one tick ahead [{curve.unit}]"),
        "Learning curve on held-out babbling",
        None if floor is None else (f"floor, the senses' own: {floor:.2g} {curve.unit}", floor),
        log="xy" if max(drawn) > DECADE * min(drawn) else "x",
    )
    if curve.piloted is not None:
        axes = figure.axes[0]
        axes.axvline(curve.piloted, color=PLAIN, lw=0.8, ls=":")
        axes.text(curve.piloted, 0.02, " end of the pilot", transform=axes.get_xaxis_transform(), fontsize=8)
    return figure
