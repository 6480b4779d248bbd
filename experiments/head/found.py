"""Head movements as they were shown, watched and imitated."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray
from babbling.mind import Mind
from experiments.head.distractor import Crossed
from experiments.head.options import Config
from experiments.shared.caregiver import Search
from experiments.shared.trajectories import TRIES, Track, labelled
from imitation.seeing.pose import Appearance, Watched
from models.biclops.movements import TICK_S
from models.retina import Image

if TYPE_CHECKING:
    import xarray as xr


class Imitation(NamedTuple):
    """One sequence; ticks of 20 ms, angles in rad."""

    truth: FloatArray
    """(T, 2) what the teacher did, NaN between frames."""
    numbers: FloatArray
    """(T, M)"""
    hidden: BoolArray
    """(T,)"""
    watched: Watched
    imitated: FloatArray
    """(T, 2) true angles of the imitator."""
    replayed: FloatArray
    """(T, 2) the same when the raw estimate of each frame is sent to the servos."""


class Found(NamedTuple):
    """Everything one run found."""

    config: Config
    looked: Search
    appearance: Appearance
    mind: Mind
    images: list[tuple[Image, Image]]
    """What was seen of the first sequence, one pair for each frame."""
    sequences: list[Imitation]
    crossed: Crossed | None
    """What look-alikes did, if there were any."""

    def trajectories(self) -> "xr.Dataset":
        """The first sequence as labelled arrays; see `experiments.shared.trajectories`."""
        one = self.sequences[0]
        told = {
            "demonstrated": (one.watched.pose, "sub-goals: what it took the teacher to show"),
            "teacher": (one.truth, "true pose of the teacher, where there was a frame"),
            "raw": (one.watched.raw, "the pose in each frame by itself"),
            "replayed": (one.replayed, "true posture where that is simply sent"),
        }
        imitated = np.rad2deg(one.imitated[None]).astype("f4")
        tracks: dict[str, Track] = {"imitated": (TRIES, imitated, "degree", "true posture of the imitator")}
        for name, (angles, about) in told.items():
            tracks[name] = TRIES[1:], np.rad2deg(angles).astype("f4"), "degree", about
        title = f"{self.config.robot} imitates a head"
        return labelled(("pan", "tilt"), ("degree", "degree"), TICK_S, tracks, title=title)
