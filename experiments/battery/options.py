"""Options of `imitate battery`."""

from typing import Annotated, Literal

from experiments.shared.options import Options, options, some, within

Stage = Literal["movements", "gaze", "face", "objects"]
STAGES: tuple[Stage, ...] = ("movements", "gaze", "face", "objects")
QUICK_AGENTS, AGENTS = 20, 200


@options
class Config(Options):
    """Options of `imitate battery`."""

    quick: bool = False
    """Shorter lives, fewer things, 20 agents: a first look."""
    agents: Annotated[int, within(2, 100_000)] | None = None
    """Agents in every cell of the design, each with a seed of its own; none given is 200, or 20 with --quick."""
    stages: Annotated[tuple[Stage, ...], some] = STAGES
    """What agents go through beside babbling: movements, gaze, face, objects (and what somebody meant to do)."""
    vary: tuple[str, ...] = ()
    """NAME=a,b,c: a parameter of agents and the values it takes; several are crossed, with the same seeds in all
    cells."""
    workers: Annotated[int, within(1, 256)] = 2
    """Processes; the result does not depend on it."""

    @property
    def population(self) -> int:
        """Agents in every cell."""
        return self.agents or (QUICK_AGENTS if self.quick else AGENTS)
