"""Options of `imitate gesture`."""

from pathlib import Path
from typing import Literal

from experiments.shared.options import (
    BABBLING_MINUTES,
    BodyOptions,
    MirrorOptions,
    check_demonstration,
    options,
)


@options
class Config(BodyOptions, MirrorOptions):
    """Options of `imitate gesture`."""

    demonstration: str = "icub-wave"
    """A built-in demonstration's name, or a file: .amc (CMU motion capture), .csv or .npz (joint angles), or .urdf (a
    robot that performs --motion)."""
    motion: Path | None = None
    """Joint angles (.csv, .npz) that a .urdf teacher performs."""
    correspondence: Literal["learned", "ik"] = "learned"
    """How limb directions become own postures: learned in front of a mirror, or by inverse kinematics (the oracle)."""
    selection: str = "mean"
    """How an action is taken out of Eq. (1)'s posterior: mean, map or matching."""
    attempts: int = 1
    """How often to try; each attempt corrects what the one before missed."""
    babbling_minutes: float = BABBLING_MINUTES
    """Body-minutes of babbling, over all copies."""
    forward_model: Path | None = None
    """A forward model that `imitate babble` left; no babbling then."""
    body_image: Path | None = None
    """A body image that `imitate correspondence` left; no mirror then."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        self.check_some("attempts")
        check_demonstration(self.demonstration)
