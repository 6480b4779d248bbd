"""Options of `imitate battery`."""

from typing import Annotated, Any, Literal

from experiments.battery.parameters import ELSE, QUICK, Parameters
from experiments.battery.vary import around, parse
from experiments.errors import ExperimentError
from experiments.shared.options import Flag, ShardOptions, options, some, within, written

Stage = Literal["movements", "gaze", "face", "objects"]
STAGES: tuple[Stage, ...] = ("movements", "gaze", "face", "objects")
QUICK_AGENTS, AGENTS = 20, 200


@options
class Config(ShardOptions):
    """Options of `imitate battery`."""

    quick: Flag = False
    """Shorter lives, fewer things, 20 agents: a first look."""
    agents: Annotated[int | None, within(2, 100_000), written("N", "200, or 20 with --quick")] = None
    """Agents in every cell of the design, each with a seed of its own."""
    stages: Annotated[tuple[Stage, ...], some] = STAGES
    """What agents go through beside babbling: movements, gaze, face, objects (and what somebody meant to do)."""
    vary: Annotated[tuple[str, ...], written("NAME=a,b,c ...", "nothing")] = ()
    """A parameter of agents and the values it takes; several are crossed, with the same seeds in all cells. NAME is one
    of babbling_minutes, rehearsal_s, mirror_minutes, movements, looking_minutes, gaze_lessons, face_acts, play_rounds,
    acts, shown, exponent, trust, own_weight, gives_up, goes_on, repeats, all_somebody, as_itself, even_goals, forgets,
    aim_deg, seeing_noise_deg."""
    one_by_one: Flag = False
    """Vary one parameter at a time, instead of crossing them; where --vary names none, every one of them, to half and
    twice what it is: how much results depend on each."""
    only: Annotated[int | None, within(0, 100_000_000), written("N", "all of them")] = None
    """One agent alone, by its number: its rows, no figures."""

    without_films: Flag = False
    """No films of the first agent and of whom it watches in the report."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        parse(self.vary, Parameters)
        if self.only is not None and self.out is None:
            raise ExperimentError(f"--only {self.only}: name a folder of its own for it, with --out")

    @property
    def films(self) -> bool:
        """Whether any are taken."""
        return not self.without_films and self.only is None

    @property
    def varied(self) -> dict[str, tuple[Any, ...]]:
        """Parameters, and the values that each takes."""
        said = parse(self.vary, Parameters)
        return around(self.parameters, ELSE) if self.one_by_one and not said else said

    @property
    def parameters(self) -> Parameters:
        """Of who is not varied."""
        return QUICK if self.quick else Parameters()

    @property
    def population(self) -> int:
        """Agents in every cell."""
        return self.agents or (QUICK_AGENTS if self.quick else AGENTS)
