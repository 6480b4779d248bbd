"""Figures of head imitation: demonstrated, estimated and imitated angles; what a head at a posture looks like."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from babbling.axes import BoolArray, FloatArray
from experiments.head.distractor import INKS as WAYS
from experiments.head.distractor import Crossed
from experiments.head.found import Found, Imitation
from experiments.shared.caregiver import FACE
from experiments.shared.figures import captioned, legend_above
from experiments.shared.judging import rmse_deg
from experiments.shared.palette import DARK, FEATURES, OURS, PLAIN, THEIRS
from experiments.shared.views import AXES
from imitation.deferred import HeadMemory
from imitation.seeing.pose import Appearance
from models.biclops.movements import TICK_S

RAW = "#bbbbbb"


def figures(found: Found) -> dict[str, Figure]:
    """All of them, by file stem."""
    drawn = {"movement": movement(found.sequences[0]), "appearance": looks(found.appearance)}
    if len(found.sequences) > 1:
        drawn["errors"] = errors(found.sequences)
    if found.crossed is not None:
        drawn["distractor"] = distractor(found.crossed)
    return drawn


@captioned(
    "One sequence: the head as it was, as each frame alone shows it, as it was believed and as it was "
    "imitated; errors below. Shaded: the face was hidden by a card."
)
def movement(one: Imitation) -> Figure:
    """One sequence: what was demonstrated, each frame's own estimate, the estimate, what was imitated; errors below."""
    figure = Figure(figsize=(10.5, 6.4), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True, height_ratios=[1.2, 1.2, 1])
    time = np.arange(len(one.truth), dtype=float) * TICK_S
    frames = np.isfinite(one.truth[:, 0])
    for i, name in enumerate(AXES):
        axes = panels[i]
        _hide(axes, time, one.hidden)
        middle, half = np.rad2deg(one.watched.pose[:, i]), 2 * np.rad2deg(one.watched.deviation[:, i])
        axes.fill_between(time, middle - half, middle + half, color=THEIRS, alpha=0.25, lw=0, label="two deviations")
        axes.plot(time[frames], np.rad2deg(one.watched.raw[frames, i]), ".", color=RAW, ms=3, label="each frame alone")
        axes.plot(time[frames], np.rad2deg(one.truth[frames, i]), color=DARK, lw=3.2, alpha=0.35, label="demonstrated")
        axes.plot(time, middle, color=THEIRS, lw=1.3, label="estimated")
        axes.plot(time, np.rad2deg(one.imitated[:, i]), color=OURS, lw=1.0, ls="--", label="imitated")
        axes.set_ylabel(f"{name} [deg]")
        ends = np.rad2deg([one.truth[frames, i].min(), one.truth[frames, i].max()])
        axes.set_ylim(ends[0] - 4, ends[1] + 4)
    legend_above(panels[0], 5)
    _hide(panels[2], time, one.hidden)
    for values, colour, label in (
        (one.watched.raw, RAW, "each frame alone"),
        (one.watched.pose, THEIRS, "estimated"),
        (one.imitated, OURS, "imitated"),
    ):
        away = np.hypot(*np.rad2deg(values - one.truth)[frames].T)
        panels[2].plot(time[frames], away, color=colour, lw=1.2, label=label)
    panels[2].set(yscale="log", ylim=(0.01, 30), ylabel="error [deg]", xlabel="time [s]")
    return figure


@captioned(
    "Things of the face's own colours cross the view. Below, by how much each way of tracking loses the head meanwhile."
)
def distractor(crossed: Crossed) -> Figure:
    """Error of the pose by way of tracking, of every sequence and through the first one; the wrong things followed."""
    figure = Figure(figsize=(11.5, 4.2), layout="constrained")
    over, through, wrong = figure.subplots(1, 3, width_ratios=[1, 1.5, 0.8])
    found = crossed.metrics
    truth = crossed.truths[0]
    frames = np.isfinite(truth[:, 0])
    time = np.arange(len(truth), dtype=float) * TICK_S
    passing = crossed.strays.when[0]
    through.axvspan(
        max(passing.min() - 1, 0), min(passing.max() + 1, time[-1]), color="#f0e6f5", lw=0, label="things cross"
    )
    for number, (name, ink) in enumerate(WAYS.items()):
        each, interval = crossed.sequence_deg[name], found["distractor_interval_95_deg"][name]
        over.plot(np.full(len(each), number), each, ".", color=ink, alpha=0.6)
        over.plot(number, found["distractor_rmse_deg"][name], "_", color=ink, ms=22, mew=2.5)
        if interval is not None:
            over.plot([number, number], interval, color=ink, lw=1.5)
        away = np.hypot(*np.rad2deg(crossed.kept[name][0].watched.pose - truth)[frames].T)
        through.plot(time[frames], np.maximum(away, 1e-3), color=ink, lw=1.2, label=name)
        wrong.bar(number, 100 * (found["distractor_wrong_share"][name] or 0.0), color=ink)
    over.set(yscale="log", ylabel="pose error, RMS [deg]", title="every sequence")
    through.set(yscale="log", xlabel="time [s]", ylabel="pose error [deg]", title="the first one")
    legend_above(through, 3)
    wrong.set(ylabel="wrong thing followed [% of sightings]", title="parts of the face")
    for axes in (over, wrong):
        axes.set_xticks(range(len(WAYS)), [*WAYS], rotation=30, ha="right")
    return figure


def _hide(axes: Axes, time: FloatArray, hidden: BoolArray) -> None:
    """Shade what a card hid."""
    if hidden.any():
        axes.axvspan(time[hidden][0], time[hidden][-1], color="#f3e2c7", lw=0)
        axes.annotate(
            "face hidden", (time[hidden].mean(), 0.03), xycoords=("data", "axes fraction"), ha="center", fontsize=7,
            color="#9a7b45",
        )  # fmt: skip


@captioned(
    "Where each feature of a face (in its own colour) is expected on the retina, over all poses of its head; learned "
    "while a caregiver mirrored one's own head."
)
def looks(appearance: Appearance) -> Figure:
    """What was learned of a head's looks: where its features are seen as it pans and tilts."""
    figure = Figure(figsize=(10.5, 4.2), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    sweep = np.linspace(-0.9, 0.9, 25)
    grid = appearance.expect(np.stack(np.meshgrid(*[sweep * s for s in appearance.scale]), -1))  # tilt, pan, M
    numbers = grid.reshape(*grid.shape[:2], len(FACE), 2, 3)
    for eye, axes in enumerate(panels):
        for feature, name in enumerate(FACE):
            u, v = numbers[..., feature, eye, 0], numbers[..., feature, eye, 1]
            for row in range(0, 25, 6):
                axes.plot(u[row], v[row], color=FEATURES[name], lw=1.3)
                axes.plot(u[:, row], v[:, row], color=FEATURES[name], lw=0.6, alpha=0.7)
        axes.set(title=f"{('left', 'right')[eye]} eye", xlabel="u [px]", aspect="equal")
    panels[0].set_ylabel("v [px]")
    panels[0].invert_yaxis()
    figure.suptitle(
        "what a head looks like as it pans (thick) and tilts (thin): learned from being mirrored", fontsize=10
    )
    return figure


@captioned(
    "Error of every sequence, by what was known: the filter with and without the future, each frame alone, "
    "and the imitation."
)
def errors(sequences: list[Imitation]) -> Figure:
    """Every sequence's error, by kind of estimate."""
    figure = Figure(figsize=(8, 3.8), layout="constrained")
    axes = figure.subplots()
    rows: dict[str, tuple[list[FloatArray], str, str]] = {
        "each frame alone": ([o.watched.raw for o in sequences], RAW, "s"),
        "raw, replayed": ([o.replayed for o in sequences], PLAIN, "x"),
        "filter (past only)": ([o.watched.live for o in sequences], "#7fa7d9", "v"),
        "estimated": ([o.watched.pose for o in sequences], THEIRS, "o"),
        "imitated": ([o.imitated for o in sequences], OURS, "D"),
    }
    for label, (poses, colour, mark) in rows.items():
        values = [rmse_deg(pose, one.truth) for pose, one in zip(poses, sequences, strict=True)]
        axes.plot(np.arange(1, len(values) + 1), values, mark, color=colour, ms=5, label=label)
    axes.axhline(0.8, color=THEIRS, lw=0.8, ls=":")
    axes.axhline(1.0, color=OURS, lw=0.8, ls=":")
    axes.set(yscale="log", xlabel="sequence", ylabel="RMS error [deg]")
    legend_above(axes, 5)
    return figure


@captioned("A movement that was remembered, and its performance later, in another room.")
def recalled(memory: HeadMemory, imitated: FloatArray) -> Figure:
    """A remembered movement and its performance."""
    figure = Figure(figsize=(9, 4.2), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    time = np.arange(len(memory.pose)) * memory.tick_s
    for i, (axes, name) in enumerate(zip(panels, AXES, strict=True)):
        axes.plot(time, np.rad2deg(memory.pose[:, i]), color=THEIRS, lw=3, alpha=0.4, label="remembered")
        axes.plot(time, np.rad2deg(imitated[:, i]), color=OURS, lw=1.2, label="imitated")
        axes.set_ylabel(f"{name} [deg]")
    legend_above(panels[0])
    panels[1].set_xlabel("time [s]")
    return figure
