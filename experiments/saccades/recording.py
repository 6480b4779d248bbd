"""The recording of `imitate saccades`: what both eyes see, what was found and expected, the head in its room."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import rerun.blueprint as rrb
from numpy.typing import NDArray

from babbling.axes import FloatArray
from experiments.shared import views
from experiments.shared.eyes import SACCADE_S
from experiments.shared.eyes_recording import log_events, log_eyes, log_stage
from experiments.shared.palette import ESTIMATED, IMITATED
from experiments.shared.recording import log_series, recording
from models.onlooker import Onlooked


class Glance(NamedTuple):
    """One view of the recording."""

    images: tuple[NDArray[np.uint8], NDArray[np.uint8]]
    found: FloatArray
    """(K, 4) pixels."""
    predicted: FloatArray
    """(K, 4) pixels, where each thing was expected to be."""
    angles: FloatArray
    """(2,) true pan and tilt."""
    event: str


def record(
    path: Path, seen: Onlooked, table: tuple[float, ...], glances: list[Glance], summary: str, name: str
) -> None:
    """Write the recording."""

    def both(pixels: list[FloatArray]) -> FloatArray:
        return np.stack(pixels).reshape(len(glances), -1, 2, 2)

    with recording(path, "imitate-saccades", name, _layout(table[2], glances[0].images[0]), summary) as stream:
        found, expected = both([g.found for g in glances]), both([g.predicted for g in glances])
        log_eyes(stream, [g.images for g in glances], SACCADE_S, found, expected, (1.0, 2.2))
        log_stage(stream, seen, SACCADE_S)
        for i, (axis, colour) in enumerate(zip(views.AXES, (IMITATED, ESTIMATED), strict=True)):
            angles = np.rad2deg([g.angles[i] for g in glances])
            log_series(stream, f"head/{axis}/imitated", angles, SACCADE_S, axis, colour)
        log_events(stream, [(number * SACCADE_S, g.event) for number, g in enumerate(glances)])


def _layout(height: float, picture: NDArray[np.uint8]) -> rrb.Horizontal:
    return views.beside(
        views.world("head and toys", (-0.9, -0.9, height + 0.8), (0.35, 0.0, height + 0.2)),
        views.eyes(picture),
        views.series("pan and tilt [deg]", origin="/head"),
        views.events("fixations"),
        row_shares=[1.4, 1, 0.9],
    )
