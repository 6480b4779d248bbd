"""What was watched, in discrete states: the chapter's s_1, s_2, ..., s_N with the actions in between."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from babbling.axes import IntArray, fixed
from babbling.kinds import Numbers
from imitation.errors import ImitationError


@dataclass(frozen=True, eq=False)
class Episode:
    """One demonstration: T steps towards one goal.

    Raises:
        ImitationError: states and actions whose numbers do not fit, or no state at all.
    """

    goal: Annotated[int, Numbers(low=0)]
    """Index k of the goal S_k, from 0."""
    states: Annotated[IntArray, Numbers(".visit", low=0)]
    """(T + 1,) state numbers, before the first step and after each."""
    actions: Annotated[IntArray, Numbers(".step", low=0)]
    """(T,) action numbers."""

    def __post_init__(self) -> None:
        states, actions = _whole("states", self.states), _whole("actions", self.actions)
        if len(states) != len(actions) + 1:
            raise ImitationError(
                f"a demonstration of {len(states)} states has {len(actions)} actions; one less than states is right"
            )
        object.__setattr__(self, "states", states)
        object.__setattr__(self, "actions", actions)

    @property
    def steps(self) -> int:
        """T."""
        return len(self.actions)


def _whole(name: str, values: ArrayLike) -> IntArray:
    array = np.array(values)
    if array.ndim != 1 or (array.size and (array.dtype.kind not in "iu" or array.min() < 0)):
        raise ImitationError(f"{name} of a demonstration: a list of whole numbers from 0 is needed")
    return fixed(array.astype(np.int64))


def check_range(episodes: Sequence[Episode], goals: int, states: int, actions: int) -> None:
    """Refuse numbers beyond what exists.

    Raises:
        ImitationError: a goal, state or action number that is too large.
    """
    for i, e in enumerate(episodes):
        for name, values, size in (
            ("goal", [e.goal], goals),
            ("state", e.states, states),
            ("action", e.actions, actions),
        ):
            top = max(values, default=0)
            if not 0 <= top < size:
                raise ImitationError(f"demonstration {i + 1}: {name} {top}; there are {size}, numbered from 0")
