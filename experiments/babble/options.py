"""Options of `imitate babble`."""

from pathlib import Path
from typing import Annotated

from experiments.shared.options import (
    BABBLING_MINUTES,
    BodyOptions,
    Flag,
    Minutes,
    N,
    Robot,
    ShardOptions,
    options,
    within,
    written,
)
from models.robots import ROBOTS


@options
class Config(BodyOptions, ShardOptions):
    """Options of `imitate babble`."""

    robot: Robot = "hoap2"
    """A robot that `imitate list` names, or the path of an MJCF; biclops babbles with its eyes, as `imitate saccades`
    does, and leaves a folder."""
    babbling_minutes: Minutes = BABBLING_MINUTES
    """Body-minutes of babbling in all: over all copies, the pilot counted."""
    out: Annotated[Path | None, written("FILE.nc", "runs/ROBOT.nc")] = None
    """The file; its learning curve is drawn beside it. One that these options made is left as it is, one of other
    options is replaced."""

    shards: Annotated[int, within(1, 100_000), N] = 1
    """After the pilot, to how many shards its bouts are dealt; from 2 on --workers or --scheduler do them. FILE does
    not depend on it."""

    stand: Flag = False
    """Afterwards, also learn to stand on one's own feet; FILE.balance.nc is left beside FILE.nc."""

    @property
    def sees(self) -> bool:
        """Whether it is a head that babbles with its eyes."""
        return self.robot in ROBOTS and ROBOTS[self.robot].babbles == "eyes"
