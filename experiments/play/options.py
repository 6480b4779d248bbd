"""Options of `imitate play`."""

from pathlib import Path
from typing import Annotated, Literal

import tyro

from experiments.errors import ExperimentError
from experiments.shared.options import Minutes, Options, ToRead, options, within

PLAY_MINUTES = 300.0


@options
class Config(Options):
    """Options of `imitate play`."""

    minutes: Minutes = PLAY_MINUTES
    """Body-minutes of play, over all children that play at once; a file that holds fewer goes on."""
    things: tuple[str, ...] = ()
    """What to play with (`imitate play --things loop cup`); none named is dumbbell, outsized, panel, panel:busy, box,
    loop and cup, `busy` being hands that are bound."""
    seeing: Literal["points", "pixels"] = "points"
    """How things are seen: as points with 3 mm of noise, or by one's own two retinas, which one first learns to use by
    watching one's hands; a file that is gone on with keeps its own way."""
    forward_model: ToRead | None = None
    """Mind that `imitate babble --robot hoap2-seated` left, instead of babbling."""
    merge: tuple[ToRead, ...] = ()
    """Plays to be added up, instead of playing: exactly as if one child had played it all."""
    workers: Annotated[int, within(1, 256)] = 2
    """Processes; the result does not depend on it."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """The file (runs/play.nc); mind, image of hands and head, table and figure are left beside it."""

    def check(self) -> None:
        """See `Options`."""
        if self.merge and (self.forward_model is not None or self.things):
            raise ExperimentError("--merge: nobody plays then; leave out --forward-model and --things")
        if len(self.merge) == 1:
            raise ExperimentError("--merge: one play; two or more are needed")
        super().check()
