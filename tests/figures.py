"""What is wrong with a figure, as it was saved: no caption, axes that do not say what they are, names over the data."""

from collections.abc import Iterator

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.category import StrCategoryFormatter
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter, FuncFormatter

LEAST_POINTS = 5.5
"""Of letters that are read at all."""
NAMED = (FixedFormatter, FuncFormatter, StrCategoryFormatter)
"""Whose ticks are names that somebody gave."""


def faults(figure: Figure) -> list[str]:
    """Nothing, of a figure that stands for itself."""
    return list(_faults(figure))


def _faults(figure: Figure) -> Iterator[str]:
    if not str(figure.get_label()).strip():
        yield "no caption"
    drawn = [axes for axes in figure.axes if axes.axison and axes.has_data() and axes.name != "polar"]
    for axes in drawn:
        if axes.get_label() == "<colorbar>":
            if not (axes.get_ylabel() or axes.get_xlabel() or _titled(figure, axes)):
                yield "a colour bar without a name"
            continue
        for which in "xy":
            shared = getattr(axes, f"get_shared_{which}_axes")().get_siblings(axes)
            if not any(_told(getattr(one, f"{which}axis")) for one in shared):
                yield f"{which} axis of {axes.get_title() or axes.get_title('left')!r} says nothing"
        if axes.get_legend() and _covers(axes):
            yield f"names of lines lie over those of {axes.get_title()!r}"
        small = [label.get_fontsize() for label in (*axes.get_xticklabels(), *axes.get_yticklabels())]
        if min(small, default=LEAST_POINTS) < LEAST_POINTS:
            yield f"letters of {min(small)} points"
    for legend in figure.legends:
        box = legend.get_window_extent()
        if box.y0 < -1 or any(box.overlaps(axes.get_tightbbox()) for axes in drawn):
            yield "the figure's legend lies over something"


def _told(axis: Axis) -> bool:
    return (
        not len(axis.get_ticklocs())
        or bool(axis.get_label_text().strip())
        or isinstance(axis.get_major_formatter(), NAMED)
    )


def _titled(figure: Figure, bar: Axes) -> bool:
    """Whether what a colour bar belongs to has a title that says it."""
    return any(axes.get_title() for axes in figure.axes if axes.images and axes is not bar)


def _covers(axes: Axes) -> bool:
    legend = axes.get_legend()
    assert legend is not None
    box = legend.get_window_extent().padded(-2)
    for line in axes.lines:
        path = line.get_transform().transform_path(line.get_path()).cleaned(remove_nans=True)
        points = path.vertices[path.codes != path.STOP]
        if box.count_contains(points) or (line.get_linestyle() != "None" and path.intersects_bbox(box, filled=False)):
            return True
    return any(box.overlaps(bar.get_window_extent()) for bar in axes.patches)
