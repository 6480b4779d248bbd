"""What names of joints say: their side, and plain words."""

import re

from models.teachers.performance import SIDES

FOUR_LEGS = {"rl": "left", "lh": "left", "rr": "right", "rh": "right", "fl": None, "fr": None, "lf": None, "rf": None}
"""Beginnings of a four-legged robot's joints: its hind legs correspond to legs, its fore legs to nothing."""


def side_of(name: str) -> str | None:
    """Side of a joint: the word left or right, an L or R in front (LARM, lHip, l_hip), or such a letter on its own."""
    for side in SIDES:
        if side in name.lower():
            return side
    words = re.split("[^a-z0-9]+", plain(name))
    if words[0] in FOUR_LEGS:
        return FOUR_LEGS[words[0]]
    for side in SIDES:
        if words[0] == side[0] or re.match(f"[{side[0].upper()}][A-Z]|[{side[0]}][A-Z]", name):
            return side
    return next((side for side in SIDES if side[0] in words), None)


def plain(name: str) -> str:
    """In small letters, words parted by _."""
    return re.sub(r"([a-z])([A-Z])", r"\1_\2", name).lower()
