"""Options of `imitate objects`."""

from typing import Annotated, Any, Literal

from experiments.errors import ExperimentError
from experiments.shared.options import Category, Flag, M, N, Options, ToRead, choices, one_of, options, within, written
from imitation.acting.primitives import NAMES
from models.objects import TOYS

CONDITIONS = ("live", "week", "room", "television", "peer", "none", "handled")


@options
class Config(Options):
    """Options of `imitate objects`."""

    object: Annotated[str, one_of("object", TOYS), written(choices(TOYS))] = "panel"
    """What the act is done with."""
    act: Annotated[str, one_of("act", NAMES), written(choices(NAMES))] = "press with the head"
    """What the teacher does."""
    condition: Literal["live", "week", "room", "television", "peer", "none", "handled"] = "live"
    """How it is seen: live from across the table; a week before, recalled in a new process; in another room (place of
    the eyes, height of the table); on television (one image, no depth); done by a smaller peer; not at all; only
    handled."""
    seeing: Literal["points", "pixels"] = "points"
    """How the teacher is seen: as points with 3 mm of noise, or on images of two cameras (one for television)."""
    play: Annotated[ToRead | None, written("FILE.nc", "plays for 38 body-minutes first")] = None
    """What the imitator learned in play (`imitate play`)."""
    further_m: Annotated[float, within(-0.05, 0.5, "m"), M] = 0.0
    """How much further away the object stands than usual."""
    acts: Annotated[int, within(1, 20), N] = 3
    """Acts that there is time for."""
    selection: Category = "matching"
    """How an action is chosen from its posterior."""
    workers: Annotated[int, within(1, 256), N] = 2
    """Processes; the result does not depend on it."""
    study: Flag = False
    """Every figure over agents and plays (minutes)."""
    plays: Annotated[tuple[ToRead, ...], written("FILE.nc ...", "--play's alone")] = ()
    """Independent plays to study (`imitate play --seed 0`, 1, ...)."""
    agents: Annotated[int, within(2, 10_000), N] = 200
    """Agents of the study, shared out over the plays."""

    def check(self) -> None:
        """See `Options`."""
        if self.plays and not self.study:
            raise ExperimentError("--plays: several plays are for --study; one imitator takes --play")
        if self.selection == "mean":
            raise ExperimentError("--selection mean: primitives are categories and have no mean; use map or matching")
        super().check()


def words(config: Any) -> str:
    """What happens, for people."""
    return f"{config.act!r} with the {config.object}, {config.condition}"
