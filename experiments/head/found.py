"""Head movements as they were shown, watched and imitated."""

from typing import NamedTuple

from babbling.axes import BoolArray, FloatArray
from babbling.mind import Mind
from experiments.head.distractor import Crossed
from experiments.head.options import Config
from experiments.shared.caregiver import Search
from imitation.seeing.pose import Appearance, Watched
from models.retina import Image


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
