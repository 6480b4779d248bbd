"""Options of `imitate gesture`."""

from pathlib import Path
from typing import Annotated, Literal

from experiments.errors import ExperimentError
from experiments.shared.options import (
    BABBLING_MINUTES,
    DEMONSTRATION,
    BodyOptions,
    Demonstration,
    Film,
    Flag,
    Minutes,
    MirrorOptions,
    N,
    Selection,
    TableOptions,
    ToRead,
    WatchingOptions,
    a_push,
    must_stand,
    options,
    within,
    written,
)


@options
class Config(BodyOptions, MirrorOptions, WatchingOptions, TableOptions):
    """Options of `imitate gesture`."""

    demonstration: Demonstration = "icub-wave"
    """A demonstration that `imitate list` names, or a file: .amc, .bvh (motion capture), .csv, .tsv, .txt or .npz
    (joint angles; those not named rest), or .urdf (a robot that performs --motion)."""
    motion: Annotated[ToRead | None, written("FILE", "none")] = None
    """Joint angles (.csv, .tsv, .txt, .npz) that a .urdf teacher performs."""
    correspondence: Literal["learned", "ik"] = "learned"
    """How limb directions become own postures: learned in front of a mirror, or by inverse kinematics (the oracle)."""
    selection: Selection = "map"
    """How an action is taken out of Eq. (1)'s posterior."""
    attempts: Annotated[int, within(1, 1_000), N] = 1
    """How often to try; each attempt corrects what the one before missed."""
    babbling_minutes: Minutes = BABBLING_MINUTES
    """Body-minutes of babbling in all: over all copies, the pilot counted."""
    forward_model: Annotated[ToRead | None, written("FILE.nc", "babbles anew")] = None
    """A forward model that `imitate babble` left."""
    body_image: Annotated[ToRead | None, written("FILE.nc", "looks into a mirror")] = None
    """A body image that `imitate correspondence` left."""
    film: Annotated[Film | None, written("{mp4,gif}", "no film")] = None
    """Also a film: the imitator, and a ghost where the demonstration has it otherwise; mp4 (extra `film`) or gif."""
    stand: Flag = False
    """On its own feet: on a floor, free to fall. Balance is learned first, a minute or two, or taken."""
    balance: Annotated[ToRead | None, written("FILE.nc", "learned anew")] = None
    """What `imitate babble --stand` left of balance."""
    balance_weight: Annotated[float, within(0, 100), written("EXPONENT")] = 4.0
    """Exponent of "stay balanced" beside "match the teacher" in Eq. (1); 0 leaves it out."""
    speed: Annotated[float, within(0.2, 4), written("TIMES")] = 1.0
    """How many times as fast the movement is done on one's feet."""
    push: Annotated[str | None, a_push, written("T,FX,FY,FZ", "nobody pushes")] = None
    """Somebody pushes the torso for a tenth of a second: seconds of the movement, and newtons forward, left and up."""
    study: Flag = False
    """With --stand: twenty individuals, faster, pushed, on slopes, laden, beside other ways to stand (ten minutes and
    more)."""
    clips: Annotated[tuple[Demonstration, ...], written(f"{DEMONSTRATION} ...", "all that `imitate list` names")] = ()
    """Demonstrations of the study."""

    def check(self) -> None:
        """See `Options`; and what goes together."""
        super().check()
        given = {
            "balance": self.balance is not None,
            "push": self.push is not None,
            "study": self.study,
            "speed": self.speed != 1,
            "clips": bool(self.clips),
        }
        for name, there in given.items():
            if there and not self.stand:
                raise ExperimentError(f"--{name}: this is for a body on its own feet; add --stand")
        if self.unit is not None and Path(self.demonstration).suffix.lower() in ("", ".amc", ".bvh"):
            raise ExperimentError(f"--unit: this is for files of joint angles; {self.demonstration} is none")
        if self.stand:
            must_stand(self.robot)
