"""Colours, each said once: inks on white paper, and lights on the dark ground of a recording."""

from matplotlib.colors import to_rgb

Light = tuple[int, int, int]

OURS, THEIRS, PLAIN, DARK = "#e8722a", "#3b6fd4", "#8a8a8a", "#222222"
"""Inks: what the imitator learned or did; the demonstration or another way; what is compared; the truth."""
INKS = {"red": "#d62728", "blue": "#1f4fd8", "green": "#2ca02c", "yellow": "#d4b400", "magenta": "#c218c2",
        "orange": "#e07b00", "lime": "#7bbf00", "cyan": "#00a5a5", "violet": "#7a2fd0"}  # fmt: skip
"""Of features and toys that have these colours."""

DEMONSTRATED, IMITATED, REPLAYED = (120, 170, 255), (255, 140, 40), (150, 150, 150)
EARLIER = (150, 95, 50)
"""Attempts before the last."""
ESTIMATED = (110, 220, 150)
FOUND, EXPECTED = (255, 255, 255), (255, 150, 40)
"""Places on a retina."""
SERIES = (IMITATED, (110, 200, 120), (200, 120, 230), DEMONSTRATED, (230, 210, 90))
"""Lights for one thing after the other."""
GROUND, GRID = (74, 81, 93), (110, 118, 130, 90)
"""Behind what is seen in space, and the lines of its floor."""


def light(ink: str) -> Light:
    """An ink as red, green, blue of 0 to 255."""
    r, g, b = to_rgb(ink)
    return round(255 * r), round(255 * g), round(255 * b)
