"""Figure of power beside false positives."""

import numpy as np
from matplotlib.figure import Figure

from experiments.face.scores import LEVEL, SCORES, Powers
from experiments.shared.figures import captioned
from experiments.shared.palette import DARK, OURS, PLAIN, THEIRS

APART = 0.19
"""Rows from a score's own up to its power, and down to its false positives."""
FAINTEST = 0.25
"""Opacity of the least imitation; the most is opaque."""


@captioned(
    "How often each published score is significant in samples of so many infants: where a share of acts is "
    "imitation (orange), and where nobody imitates (blue). Intervals are 95 % over samples."
)
def power_figure(found: Powers) -> Figure:
    """Scores by infants a sample: how often each is significant where a share w of acts is imitation, and where none
    is, with 95 % intervals."""
    figure = Figure(figsize=(2.5 * len(found.ns) + 3.0, 6.4), layout="constrained")
    panels = figure.subplots(1, len(found.ns), sharex=True, sharey=True, squeeze=False)[0]
    rows, ends = np.arange(len(SCORES)), np.abs(found.interval - found.share[..., None])
    imitation = [theory.imitation for theory in found.theories.values()]
    shades = iter(np.linspace(1, FAINTEST, sum(w > 0 for w in imitation)))
    rivals, lines = iter("sDv^<>"), []
    for k, w in enumerate(imitation):
        ink, marker, shade, shift = (OURS, "o", next(shades), -APART) if w else (THEIRS, next(rivals), 1.0, APART)
        for j, axes in enumerate(panels):
            line = axes.errorbar(
                found.share[k, :, j], rows + shift, xerr=ends[k, :, j].T, fmt=marker, color=ink, alpha=shade, ms=6
            )
        lines.append(line)
    for axes, n in zip(panels, found.ns, strict=True):
        level = axes.axvline(LEVEL, color=DARK, lw=1, ls="--")
        axes.hlines(rows[1:] - 0.5, 0, 1, color=PLAIN, lw=0.5, transform=axes.get_yaxis_transform())
        axes.set(title=f"{n} infants", xlim=(-0.05, 1.05), xticks=[0, 0.5, 1], xlabel="share significant")
        axes.set_yticks(rows, list(SCORES))
    panels[0].set_ylim(len(rows) - 0.5, -0.5)
    one = next(iter(found.theories.values()))
    figure.suptitle(
        "Orange: imitation is there; further right, more often found.\n"
        "Blue: nobody imitates; right of the dashed line, taken for imitation too often.",
        fontsize=12,
    )
    assumed = (
        f"Assumed: {one.acts_a_minute:g} acts a minute before a moving face, {one.passive_interest:g} of that before "
        f"one at rest, {one.object_interest:g} before a thing; activity varies by {100 * one.activity_cv:.0f} % "
        f"between infants, its logarithm by {one.state_sd:g} between models.\n"
        f"{found.repeats} samples of each size; 95 % intervals over samples."
    )
    figure.legend(
        [*lines, level],
        [*found.theories, f"{100 * LEVEL:g} % of samples"],
        title=assumed,
        loc="outside lower center",
        ncols=len(lines) + 1,
        frameon=False,
        fontsize=9,
        title_fontsize=9,
    )
    return figure
