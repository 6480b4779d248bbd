"""Options of `imitate gesture`."""

from typing import Annotated, Literal

from experiments.shared.options import (
    BABBLING_MINUTES,
    BodyOptions,
    Demonstration,
    Minutes,
    MirrorOptions,
    Selection,
    ToRead,
    options,
    some,
)


@options
class Config(BodyOptions, MirrorOptions):
    """Options of `imitate gesture`."""

    demonstration: Demonstration = "icub-wave"
    """A built-in demonstration's name, or a file: .amc, .bvh (motion capture), .csv or .npz (joint angles), or .urdf (a
    robot that performs --motion)."""
    motion: ToRead | None = None
    """Joint angles (.csv, .npz) that a .urdf teacher performs."""
    correspondence: Literal["learned", "ik"] = "learned"
    """How limb directions become own postures: learned in front of a mirror, or by inverse kinematics (the oracle)."""
    selection: Selection = "map"
    """How an action is taken out of Eq. (1)'s posterior: mean, map or matching."""
    attempts: Annotated[int, some] = 1
    """How often to try; each attempt corrects what the one before missed."""
    babbling_minutes: Minutes = BABBLING_MINUTES
    """Body-minutes of babbling, over all copies."""
    forward_model: ToRead | None = None
    """A forward model that `imitate babble` left; no babbling then."""
    body_image: ToRead | None = None
    """A body image that `imitate correspondence` left; no mirror then."""
