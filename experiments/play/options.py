"""Options of `imitate play`."""

from pathlib import Path
from typing import Annotated, Literal

from experiments.errors import ExperimentError
from experiments.shared.options import Minutes, N, Options, ToRead, choices, options, within, written
from models.objects import TOYS

PLAY_MINUTES = 300.0
THINGS = f"{choices(TOYS)}[:busy] ..."


@options
class Config(Options):
    """Options of `imitate play`."""

    minutes: Minutes = PLAY_MINUTES
    """Body-minutes of play, over all children that play at once; a file that holds fewer goes on."""
    things: Annotated[tuple[str, ...], written(THINGS, "dumbbell outsized panel panel:busy box loop cup")] = ()
    """What to play with, `busy` being hands that are bound."""
    seeing: Literal["points", "pixels"] = "points"
    """How things are seen: as points with 3 mm of noise, or by one's own two retinas, which one first learns to use by
    watching one's hands; a file that is gone on with keeps its own way."""
    forward_model: Annotated[ToRead | None, written("FILE.nc", "babbles anew")] = None
    """Mind that `imitate babble --robot hoap2-seated` left."""
    merge: Annotated[tuple[ToRead, ...], written("FILE.nc FILE.nc ...", "plays, or plays on")] = ()
    """Plays to be added up: exactly as if one child had played it all."""
    workers: Annotated[int, within(1, 256), N] = 2
    """Processes; the result does not depend on it."""
    out: Annotated[Path | None, written("FILE.nc", "runs/play.nc")] = None
    """The file; mind, image of hands and head, table and figure are left beside it."""

    def check(self) -> None:
        """See `Options`."""
        if self.merge and (self.forward_model is not None or self.things):
            raise ExperimentError("--merge: nobody plays then; leave out --forward-model and --things")
        if len(self.merge) == 1:
            raise ExperimentError("--merge: one play; two or more are needed")
        super().check()
