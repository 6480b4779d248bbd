"""Options of `imitate maze`."""

from typing import Annotated, Literal

from experiments.errors import ExperimentError
from experiments.shared.options import Category, Flag, N, Options, ToRead, options, within, written

MOST_GOALS = 9
"""That a drawing can number."""


@options
class Config(Options):
    """Options of `imitate maze`."""

    maze: Annotated[ToRead | None, written("FILE.txt", "the chapter's")] = None
    """Drawing of another maze (plain text; models/maze/default.txt shows how)."""
    goal: Annotated[int, within(1, MOST_GOALS), N] = 2
    """Goal to imitate: 1, 2, 3, ..."""
    selection: Category = "map"
    """How an action is chosen from its posterior."""
    goal_prior: Annotated[str, written("P,P,...", "one half for goal 1, the rest shared")] = ""
    """P(goal) for intent inference, such as 0.5,0.25,0.25."""
    demonstrations: Annotated[int, within(1, 1000), N] = 2
    """Walks per goal that the teacher shows."""
    wander_steps: Annotated[int, within(0, 10_000_000, "steps"), N] = 5000
    """Random steps from which the forward model is learned; 0 leaves it uniform."""
    actions: Literal["seen", "unseen"] = "seen"
    """Whether intent is inferred with the teacher's actions seen, or unseen: from its places alone."""
    smoothing: Annotated[float, within(0, 1e6), written("COUNT")] = 0.1
    """Pseudo-counts on the priors of intent inference (imitation uses them bare)."""
    watch: Annotated[ToRead | None, written("FILE.csv", "the teacher's")] = None
    """Table of walks to watch (demonstrations.csv of a run shows how)."""
    memory: Annotated[ToRead | None, written("FILE.nc", "wanders and watches")] = None
    """Memory of an earlier run (memory.nc) to imitate from."""
    deferred: Flag = False
    """Store what was felt and seen, and imitate from that file in a new process."""
    study: Flag = False
    """Test the chapter's claims over many seeds (minutes)."""

    def check(self) -> None:
        """See `Options`."""
        if self.memory is not None and self.watch is not None:
            raise ExperimentError("--memory and --watch: a memory already holds what was watched; give one of them")
        super().check()
