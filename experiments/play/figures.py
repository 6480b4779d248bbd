"""What play taught, as a picture."""

from matplotlib.figure import Figure

from babbling.play import HANDS, Play
from experiments.shared.figures import captioned


@captioned(
    "P(state of the thing | kind, hands, primitive), and right of each row how often the primitive was done. "
    "Where nothing was tried, the prior is seen."
)
def outcomes(play: Play) -> Figure:
    """Heat maps of P(state | kind, hands, primitive) with the evidence of every row."""
    acts, states = play.outcomes.action.labels, play.outcomes.outcome.labels
    visits = play.outcomes.visits[0]
    shown = [(k, h) for k in range(len(play.kinds)) for h in range(len(HANDS)) if visits[k, h].any()]
    shown = shown or [(0, 0)]
    columns = min(4, len(shown))
    rows = -(-len(shown) // columns)
    figure = Figure(figsize=(3.1 * columns + 1.4, 4.0 * rows + 0.6), layout="constrained")
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for number in range(len(shown), grid.size):
        grid.flat[number].axis("off")
        grid.flat[number - columns].tick_params(labelbottom=True)
    for axes, (k, h) in zip(grid.flat, shown, strict=False):
        picture = axes.imshow(play.outcomes.predictive[0, k, h], vmin=0, vmax=1, cmap="Oranges", aspect="auto")
        axes.set_title(f"{play.kinds[k]}" + (", hands bound" if h else ""), fontsize=10, loc="left")
        axes.set_xticks(range(len(states)), states, rotation=60, ha="right", fontsize=8)
        axes.set_yticks(range(len(acts)), acts, fontsize=8)
        for a, count in enumerate(visits[k, h]):
            axes.text(len(states) - 0.35, a, f"{count:.0f}", fontsize=7, va="center", color="#444444")
        axes.set_xlim(-0.5, len(states) + 0.6)
    figure.colorbar(picture, ax=grid, label="probability", shrink=0.6)
    figure.suptitle(f"What {play.minutes:.0f} body-minutes of play taught of each kind of thing", fontsize=11)
    return figure
