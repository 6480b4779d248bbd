"""The chapter's Figures 5, 6 and 7, and the learning curve, panel by panel as its captions describe them."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from experiments.maze.drawing import GOAL_COLOURS, GOAL_SHADES, draw_maze, draw_walks
from experiments.maze.found import BLOCK, Found
from experiments.maze.learning import Convergence
from experiments.maze.mind import places_of
from experiments.shared.figures import captioned, legend_above
from experiments.shared.figures import learning_curve as draw_curve
from experiments.shared.palette import PLAIN
from imitation.inference.intent import in_blocks
from models.maze import ACTIONS, STEPS, TRUE_DYNAMICS


def figures(done: Found) -> dict[str, Figure]:
    """All of them, by file stem."""
    drawn = {"figure_5": figure_5(done), "figure_6": figure_6(done), "figure_7": figure_7(done)}
    if done.curve is not None and len(done.curve.steps):
        drawn["learning_curve"] = learning_curve(done.curve)
    return drawn


@captioned(
    "The maze, its start and goals; the five actions; and the true and the learned forward model, as in the "
    "chapter's Figure 5. Rows sum to one."
)
def figure_5(done: Found) -> Figure:
    """(a) the maze, (b) the five actions, (c) true and learned forward model side by side."""
    maze = done.maze
    figure = Figure(figsize=(11.8, 5.9), layout="constrained")
    grid = figure.add_gridspec(2, 3, width_ratios=[2.05, 1, 1], height_ratios=[0.82, 1])
    place = figure.add_subplot(grid[:, 0])
    draw_maze(place, maze, range(1, len(maze.goals) + 1))
    place.set_anchor("N")
    place.set_title("(a)  maze, start (*) and goals", loc="left")
    for number, (x, y) in enumerate(maze.goals, 1):
        right = x > 0.8 * maze.width
        place.annotate(
            f"Goal {number}", (x, y), xytext=(-9 if right else 9, -3), textcoords="offset points", fontsize=8,
            ha="right" if right else "left",
        )  # fmt: skip
    actions = figure.add_subplot(grid[0, 1:])
    _draw_actions(actions)
    actions.set_title("(b)  actions", loc="left")
    tables = [figure.add_subplot(grid[1, 1 + column]) for column in range(2)]
    titles = ("(c)  actual", f"learned from {done.experience.forward_model.transitions} transitions")
    for axes, title, table in zip(tables, titles, (TRUE_DYNAMICS, done.table), strict=True):
        picture = axes.imshow(table, cmap="gray", vmin=0, vmax=1)
        for (row, col), value in np.ndenumerate(table):
            shade = "white" if value < 0.5 else "black"
            axes.text(col, row, f"{value:.2f}".lstrip("0"), ha="center", va="center", fontsize=8, color=shade)
        axes.set(xticks=range(5), yticks=range(5), xticklabels=ACTIONS, yticklabels=ACTIONS)
        axes.set_xlabel("$s_{t+1}$ relative to $s_t$")
        axes.set_title(title, loc="left", fontsize=10)
        axes.tick_params(length=0)
    tables[0].set_ylabel("$a_t$")
    figure.colorbar(picture, ax=tables, shrink=0.85, label="$P(s_{t+1} \\mid s_t, a_t)$")
    return figure


def _draw_actions(axes: Axes) -> None:
    for name, (dx, dy) in zip(ACTIONS, STEPS, strict=True):
        axes.add_patch(Rectangle((dx - 0.5, dy - 0.5), 1, 1, facecolor="none", edgecolor="0.75", lw=0.8))
        if dx or dy:
            arrow = {"arrowstyle": "-|>", "lw": 2, "color": "k"}
            axes.annotate("", (0.86 * dx, 0.86 * dy), (0.22 * dx, 0.22 * dy), arrowprops=arrow)
        axes.text(1.28 * dx, 1.28 * dy, name, ha="center", va="center", fontsize=12, weight="bold")
    axes.set(xlim=(-2.6, 2.6), ylim=(-1.65, 1.65), aspect="equal")
    axes.set_axis_off()


@captioned(
    "What imitation is made of, as in the chapter's Figure 6: learned priors over actions on the way to one "
    "goal (white 1, black 0), the teacher's walks, and an imitation; of walks grey tells time, from light to dark."
)
def figure_6(done: Found) -> Figure:
    """(a) learned priors for N, S, E, W, (b) the teacher's trajectories, (c) an imitation; time in grey."""
    maze, journey, goal = done.maze, done.journey, done.config.goal
    priors = done.experience.priors[0].action()
    figure = Figure(figsize=(14.2, 5.6), layout="constrained")
    grid = figure.add_gridspec(2, 4, width_ratios=[1, 1, 2, 2])
    for i, name in enumerate("NSEW"):
        axes = figure.add_subplot(grid[i // 2, i % 2])
        probability = priors[goal - 1, :, ACTIONS.index(name)].reshape(maze.height, maze.width)
        axes.imshow(
            probability, cmap="gray", vmin=0, vmax=1, origin="lower",
            extent=(0.5, maze.width + 0.5, 0.5, maze.height + 0.5),
        )  # fmt: skip
        draw_maze(axes, maze, colour="#5f86a8", width=0.7)
        axes.set(xlim=(0.4, maze.width + 0.6), ylim=(0.4, maze.height + 0.6), xticks=[], yticks=[])
        axes.set_xlabel(name, weight="bold", fontsize=10)
        axes.set_ylabel("")
        if i == 0:
            axes.set_title(f"(a)  $P(a_t \\mid s_t, s_G)$, Goal {goal}", loc="left", fontsize=11)
    teacher = figure.add_subplot(grid[:, 2])
    draw_maze(teacher, maze, [goal], width=2.2)
    shown = [walk for walk in done.walks if walk.goal == goal][:6]
    draw_walks(teacher, [walk.places for walk in shown], dashed=True)
    lengths = " and ".join(str(walk.steps) for walk in shown)
    teacher.set_title(f"(b)  teacher, {lengths} steps", loc="left", fontsize=11)
    imitator = figure.add_subplot(grid[:, 3])
    draw_maze(imitator, maze, [goal], width=2.2)
    cells = journey.states[: journey.steps[0] + 1, 0]
    draw_walks(imitator, [places_of(maze).place(cells)], dashed=False, width=2.0)
    end = f"{journey.steps[0]} steps" if journey.reached[0] else f"not there after {journey.steps[0]} steps"
    imitator.set_title(f"(c)  imitator ({done.config.selection}), {end}", loc="left", fontsize=11)
    return figure


@captioned(
    "Whose goal is it? An unseen walk and the posterior over goals as it is watched, as in the chapter's "
    "Figure 7; beside it a uniform goal prior and a filter through time."
)
def figure_7(done: Found) -> Figure:
    """(a) the unseen walk, (b) inferred intent in blocks, and beside it what the chapter only mentions:
    a uniform prior over goals, and a filter over time.
    """
    maze, walk, inferred, even = done.maze, done.unseen, done.inferred, done.even[done.config.actions]
    figure = Figure(figsize=(13.2, 5.8), layout="constrained")
    grid = figure.add_gridspec(2, 3, width_ratios=[1.55, 1.15, 1.15])
    place = figure.add_subplot(grid[:, 0])
    draw_maze(place, maze, [walk.goal], width=2.2)
    draw_walks(place, [walk.places], dashed=True, width=2.0)
    place.set_title(f"(a)  test walk to Goal {walk.goal}, {walk.steps} steps", loc="left", fontsize=11)
    told = ", ".join(f"{p:g}" for p in done.goal_prior.round(3))
    edges = np.append(np.arange(0, walk.steps, BLOCK), walk.steps)
    means = f"step (means over {BLOCK}, the last over {edges[-1] - edges[-2]})"
    panels = (
        (f"(b)  inferred intent, Eq. (2), goal prior {told}", means, inferred.by_step),
        ("goal prior uniform", means, even.by_step),
        (f"Bayes filter, goal prior {told}", "step", inferred.filtered),
        ("Bayes filter, goal prior uniform", "step", even.filtered),
    )
    for i, (title, below, intent) in enumerate(panels):
        blocks = i < 2
        at = (edges[:-1] + edges[1:]) / 2 if blocks else np.arange(1, walk.steps + 1)
        values = in_blocks(intent.probability, BLOCK) if blocks else intent.probability
        axes = figure.add_subplot(grid[i % 2, 1 + i // 2])
        for goal in range(len(maze.goals)):
            axes.plot(
                at, values[:, goal], "-o" if blocks else "-", color=GOAL_COLOURS[goal], markersize=6, lw=1.6,
                markerfacecolor=GOAL_SHADES[goal], markeredgecolor=GOAL_COLOURS[goal], label=f"Goal {goal + 1}",
            )  # fmt: skip
        axes.set(ylim=(-0.03, 1.03), xlim=(0, walk.steps + 1), xlabel=below, ylabel="$P(s_G)$")
        axes.set_title(title, loc="left", fontsize=10)
        axes.grid(alpha=0.25)
        legend_above(axes)
    return figure


@captioned(
    "How far the learned forward model is from the true one (total variation), against wandering and against visits. "
    "The broken line is no limit but an expectation, for so many throws of a die: 95 % of runs that only count lie in "
    "the band about it."
)
def learning_curve(curve: Convergence) -> Figure:
    """Total variation of the learned rows against wandering steps and against counted visits, with what counting is
    expected to give and its band."""
    wide = len(curve.per_visit) >= 3
    figure = Figure(figsize=(10.5 if wide else 6, 4.4), layout="constrained")
    axes = figure.add_subplot(1, 2 if wide else 1, 1)
    lines = {"learned rows": curve.tv, "expected of counting (multinomial)": curve.bound}
    axes.fill_between(curve.steps, *curve.band, color=PLAIN, alpha=0.3, lw=0, label="95 % of runs that count")
    labels = ("wandering steps", "mean total variation per row")
    draw_curve(curve.steps.astype(float), lines, labels, log="xy", onto=axes)
    if wide:
        visits, tv = curve.per_visit.T
        lines = {f"rows, slope {curve.slope:.3f}": tv, "slope -1/2": tv[0] * np.sqrt(visits[0] / visits)}
        labels, beside = ("counted visits of the row", labels[1]), figure.add_subplot(1, 2, 2, sharey=axes)
        draw_curve(visits, lines, labels, log="xy", onto=beside)
    return figure
