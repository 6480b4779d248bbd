"""Colours that have to be told apart are far apart, for the colour-blind too."""

import itertools
from collections.abc import Mapping

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from experiments.shared import palette

SEEN_BY = {
    "all": np.eye(3),
    "protanopes": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopes": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopes": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
"""Matrices on linear RGB, of no working cones of one kind (Machado, Oliveira and Fernandes 2009)."""
XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
GROUPS: Mapping[str, list[str]] = {
    "one after the other": [*palette.CYCLE, palette.PLAIN],
    "who does it": [palette.OURS, palette.THEIRS, palette.PLAIN, palette.DARK],
    "features": [*palette.FEATURES.values()],
    "balls": [*palette.BALLS.values()],
}
LEAST = 20
"""Of CIE 1976's difference; 2.3 is just seen."""


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIELAB (D65) of linear RGB."""
    ratio = (np.clip(rgb, 0, 1) @ XYZ.T) / XYZ.sum(1)
    f = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def difference(one: str, other: str, whose: str) -> float:
    seen = []
    for ink in (one, other):
        rgb = np.array(to_rgb(ink))
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        seen.append(lab(np.asarray(SEEN_BY[whose]) @ linear))
    return float(np.linalg.norm(seen[0] - seen[1]))


def test_the_measure_knows_published_values() -> None:
    """White and black are 100 apart; pure red is at 53.2, 80.1, 67.2; to deuteranopes these are alike."""
    assert difference("#ffffff", "#000000", "all") == pytest.approx(100, abs=0.01)
    assert lab(np.array([1.0, 0, 0])) == pytest.approx([53.24, 80.09, 67.20], abs=0.02)
    assert difference("#d62728", "#2ca02c", "deuteranopes") < 10 < 100 < difference("#d62728", "#2ca02c", "all")


@pytest.mark.parametrize("whose", SEEN_BY)
@pytest.mark.parametrize("group", GROUPS)
def test_no_two_of_a_group_are_alike(group: str, whose: str) -> None:
    for one, other in itertools.combinations(GROUPS[group], 2):
        assert difference(one, other, whose) >= LEAST, (one, other)


def test_all_are_seen_on_paper_and_names_are_what_they_say() -> None:
    assert all(difference(ink, "#ffffff", "all") > LEAST for inks in GROUPS.values() for ink in inks)
    assert not set(palette.FEATURES) & set(palette.BALLS)
