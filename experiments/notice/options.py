"""Options of `imitate notice`."""

from typing import Annotated

from experiments.shared.options import (
    BABBLING_MINUTES,
    DEMONSTRATION,
    BodyOptions,
    Demonstration,
    Minutes,
    N,
    ToRead,
    WatchingOptions,
    options,
    within,
    written,
)


@options
class Config(BodyOptions, WatchingOptions):
    """Options of `imitate notice`; the robot is one with a left_hand and a right_hand."""

    cases: Annotated[int, within(2, 1000), N] = 40
    """How often a motor jams, a hand takes up 200 g, and two wires are swapped."""
    healthy_minutes: Minutes = 4.0
    """Body-minutes of imitation without any change, for false alarms."""
    rehearsal_minutes: Minutes = 6.0
    """Body-minutes of rehearsal, from which chance is known."""
    demonstrations: Annotated[tuple[Demonstration, ...], written(f"{DEMONSTRATION} ...")] = ("icub-wave", "human-raise")
    """What is imitated with 200 g in the right hand while counting on."""
    learners: Annotated[int, within(1, 1_000), N] = 1
    """Seeds of those that count on; HOAP-2 only."""
    babbling_minutes: Minutes = BABBLING_MINUTES
    """Body-minutes of babbling in all: over all copies, the pilot counted."""
    forward_model: Annotated[ToRead | None, written("FILE.nc", "babbles anew")] = None
    """A forward model that `imitate babble` left; those that count on babble all the same."""
