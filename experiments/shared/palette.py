"""Colours, each said once: inks on white paper, and lights on the dark ground of a recording."""

from collections.abc import Iterable
from itertools import cycle

from matplotlib.colors import Colormap, LinearSegmentedColormap, to_rgb

Light = tuple[int, int, int]

OURS, THEIRS, PLAIN, DARK = "#e8722a", "#3b6fd4", "#8a8a8a", "#222222"
"""Inks: what the imitator learned or did; the demonstration or another way; what is compared; the truth."""
CYCLE = (OURS, THEIRS, "#30e087", "#7000ef", "#ad0000", "#ffbf0d", "#774589", "#b1c7ff")
"""One thing after the other (goals, rules, runs), on paper and on dark ground; told apart by all eyes."""
LESS_TO_MORE = LinearSegmentedColormap.from_list("less to more", [THEIRS, "white", OURS])
"""Of differences, about none."""
FEATURES = {"red": "#b50000", "blue": "#0040ff", "green": "#40b77c", "yellow": "#e5af02", "magenta": "#b01fb0"}
BALLS = {"orange": "#a8501c", "lime": "#8fbf1a", "cyan": "#04b4e0", "violet": "#9a3eff"}
"""Of features of a face, and of toys, that have these colours: each as far from the others as its name allows."""

DEMONSTRATED, IMITATED, REPLAYED = (120, 170, 255), (255, 140, 40), (150, 150, 150)
EARLIER = (150, 95, 50)
"""Attempts before the last."""
ESTIMATED = (110, 220, 150)
COMMANDED = TRUE = (255, 255, 255)
"""White on dark ground is what DARK is on paper: what no belief changes any more."""
QUIET = (84, 90, 98)
"""Where nothing goes on."""
FOUND, EXPECTED = (255, 255, 255), (255, 150, 40)
"""Places on a retina."""
GROUND, GRID = (74, 81, 93), (110, 118, 130, 90)
"""Behind what is seen in space, and the lines of its floor."""


def light(ink: str) -> Light:
    """An ink as red, green, blue of 0 to 255."""
    r, g, b = to_rgb(ink)
    return round(255 * r), round(255 * g), round(255 * b)


def glowing(ink: str) -> Colormap:
    """From darkness to an ink: a heat map of what has this colour elsewhere."""
    return LinearSegmentedColormap.from_list(ink, ["black", ink])


def inks(names: Iterable[str]) -> dict[str, str]:
    """One colour of each of some names, in bars, lines and figures; the first is what is there anyway."""
    return dict(zip(names, cycle((PLAIN, *CYCLE))))


def shades(names: Iterable[str], colour: Light) -> dict[str, Light]:
    """One colour, light and dark by turns: what the same body does, one thing after the other."""
    r, g, b = colour
    darker = round(0.7 * r), round(0.7 * g), round(0.7 * b)
    return dict(zip(dict.fromkeys(names), cycle((colour, darker))))


SERIES = tuple(map(light, CYCLE))
"""Lights for one thing after the other."""
