"""Options of `imitate maze`."""

from typing import Annotated, Literal

from experiments.errors import ExperimentError
from experiments.shared.options import Options, Selection, ToRead, options, within

MOST_GOALS = 9
"""That a drawing can number."""


@options
class Config(Options):
    """Options of `imitate maze`."""

    maze: ToRead | None = None
    """Drawing of another maze (plain text; models/maze/default.txt shows how); the default is the chapter's."""
    goal: Annotated[int, within(1, MOST_GOALS)] = 2
    """Goal to imitate: 1, 2, 3, ..."""
    selection: Selection = "map"
    """How an action is chosen from its posterior: map or matching."""
    goal_prior: str = ""
    """P(goal) for intent inference, such as 0.5,0.25,0.25; by default one half for goal 1, the rest shared."""
    demonstrations: Annotated[int, within(1, 1000)] = 2
    """Walks per goal that the teacher shows."""
    wander_steps: Annotated[int, within(0, 10_000_000, "steps")] = 5000
    """Random steps from which the forward model is learned; 0 leaves it uniform."""
    actions: Literal["seen", "unseen"] = "seen"
    """Whether intent is inferred with the teacher's actions seen, or unseen: from its places alone."""
    smoothing: Annotated[float, within(0, 1e6)] = 0.1
    """Pseudo-counts on the priors of intent inference (imitation uses them bare)."""
    watch: ToRead | None = None
    """Table of walks to watch instead of the teacher's (demonstrations.csv of a run shows how)."""
    memory: ToRead | None = None
    """Memory of an earlier run (memory.nc) to imitate from, instead of wandering and watching."""
    deferred: bool = False
    """Store what was felt and seen, and imitate from that file in a new process."""
    study: bool = False
    """Test the chapter's claims over many seeds (minutes)."""

    def check(self) -> None:
        """See `Options`."""
        if self.memory is not None and self.watch is not None:
            raise ExperimentError("--memory and --watch: a memory already holds what was watched; give one of them")
        super().check()
