"""Which remembered state comes next: sub-goals out of several demonstrations that do not agree.

The chapter follows one memorised sequence S_7 -> S_1 -> ... -> S_12. Noisy demonstrations revisit states and
contradict each other; following a state's first or most frequent successor then runs in circles for ever. The rule
here cannot: for every state take its *last* visit in each demonstration, and of these the one whose remainder to the
goal is shortest; its successor is the sub-goal. The remainder falls with each sub-goal reached, so no sequence of
sub-goals ever returns, and staying in place is never one.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from babbling.axes import IntArray
from imitation.episodes import Episode
from imitation.errors import ImitationError


class Route(NamedTuple):
    """The next sub-goal of every state on the way to one goal."""

    successor: IntArray
    """(S,) sub-goal of each state, -1 where no demonstration went (and at the goal itself)."""
    remainder: IntArray
    """(S,) steps to the goal in the demonstration chosen, -1 where none went."""


def acyclic_subgoals(episodes: Sequence[Episode], states: int) -> Route:
    """Sub-goals from demonstrations that all end in one state; see the module.

    Raises:
        ImitationError: no demonstration, or demonstrations that end in different states.
    """
    ends = {int(e.states[-1]) for e in episodes}
    if len(ends) != 1:
        what = f"demonstrations end in {len(ends)} different states" if ends else "nothing was demonstrated"
        raise ImitationError(f"{what}; sub-goals need at least one demonstration and one common goal")
    successor, remainder = np.full((2, states), -1)
    for episode in episodes:
        last = np.full(states, -1)
        last[episode.states] = np.arange(episode.steps + 1)  # later visits overwrite earlier ones
        left = np.where(last < 0, -1, episode.steps - last)
        better = (left >= 0) & ((remainder < 0) | (left < remainder))
        remainder[better] = left[better]
        successor[better] = np.append(episode.states[1:], -1)[last[better]]
    return Route(successor, remainder)
