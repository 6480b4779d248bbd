"""What somebody meant to do with a thing, when perhaps nobody meant anything (chapter, sections 2.4 and 3.5).

Two explanations of what is seen, in up to n presentations of a movement m, a state o that the thing ended in, and
whether it was done again at once, r:

    somebody pursues a goal g    P(m, o, r | g) = P(r | o in g) sum_a P(m | a) P(o | a) P(a | g)      Eq. (2), a unseen
    something just moves         P(m, o, r of all | moves) = sum_a P(a) prod_i [REPEATS P(m_i | a) P(o_i | a)
                                                             + (1 - REPEATS) mean_b P(m_i | b) P(o_i | b)] / 2

with P(a | g) by Eq. (1): what one would do oneself to bring g about, were one in the other's place. A thing mostly does
one and the same, whatever it is; somebody goes on until the goal is reached, or gives up. P(somebody) from how it looks
(`imitation.seeing.somebody`) and P(g) from one's own play are the priors; the two explanations share one evidence.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray
from imitation.inference.bayes import action_posterior, unobserved_action

GIVES_UP: Final = 0.1
"""P(it is not done again | the goal is not reached)."""
GOES_ON: Final = 0.02
"""P(it is done again at once | the goal is reached)."""
REPEATS: Final = 0.8
"""P(a thing does what it did before)."""


class Presentation(NamedTuple):
    """What was seen once."""

    movement: FloatArray
    """(A,) P(movement | primitive), up to a factor."""
    state: int | None
    """What became of the thing; None: that is not yet seen."""
    again: bool
    """Whether it was taken up again at once, as it then was."""


@dataclass(frozen=True)
class Knowing:
    """What is known of one kind of thing: one's own experience, or another's, as one imagines it."""

    outcomes: FloatArray
    """(A, O) P(o | a)."""
    habit: FloatArray
    """(A,) P(a)."""
    members: BoolArray
    """(G, O) which states each goal is reached in."""

    @property
    def brings(self) -> FloatArray:
        """(G, A) P(goal is reached | a)."""
        return np.asarray(self.members @ self.outcomes.T)

    @property
    def means(self) -> FloatArray:
        """(G, A) P(a | g) by Eq. (1); zeros for a goal that nothing brings about."""
        return action_posterior(self.brings, self.habit).probability


class Meant(NamedTuple):
    """What is believed after 0, 1 .. n presentations."""

    goal: FloatArray
    """(n + 1, G) P(g | somebody pursues one)."""
    somebody: FloatArray
    """(n + 1,) P(somebody pursues a goal)."""


def wanted(ends: FloatArray, came: BoolArray, members: BoolArray) -> FloatArray:
    """(G,) P(g) of one's own play: how one's acts end; of a goal that several states reach, nothing unless each of them
    ever came about.

    Args:
        ends: (O,) P(state) of one's own acts.
        came: (O,) whether a state ever came about.
        members: see `Knowing`.
    """
    several = members.sum(1) > 1
    possible = ~several | ((members & came).sum(1) == members.sum(1))
    weight = (members @ ends) * possible
    return np.asarray(weight / weight.sum())


def meant(
    seen: Sequence[Presentation],
    other: Knowing,
    prior: FloatArray,
    somebody: float,
    *,
    gives_up: float = GIVES_UP,
    goes_on: float = GOES_ON,
    repeats: float = REPEATS,
) -> Meant:
    """Eq. (2) over presentations, mixed with "it just moves".

    Args:
        seen: what was seen.
        other: the thing as the other knows it.
        prior: (G,) P(g).
        somebody: P(somebody) before, by the looks.
        gives_up, goes_on, repeats: see `GIVES_UP`, `GOES_ON`, `REPEATS`.
    """
    goals, moves = np.asarray(prior, float) * somebody, np.full(len(other.habit), (1 - somebody) / len(other.habit))
    means, after = other.means, [(goals, moves)]
    for one in seen:
        likely, stays = one.movement, np.ones(len(goals))
        if one.state is not None:
            likely = likely * other.outcomes[:, one.state]
            stops = np.where(other.members[:, one.state], 1 - goes_on, gives_up)
            stays = 1 - stops if one.again else stops
            moves = moves / 2
        moves = moves * (repeats * likely + (1 - repeats) * likely.mean())
        goals = goals * unobserved_action(likely, means) * stays
        total = goals.sum() + moves.sum()
        if total > 0:
            goals, moves = goals / total, moves / total
        else:  # what nothing explains leaves all as it was
            goals, moves = after[-1]
        after.append((goals, moves))
    pursued = np.array([one.sum() for one, _ in after])
    rows = [one / one.sum() if one.sum() > 0 else np.asarray(prior, float) for one, _ in after]
    return Meant(np.array(rows), pursued)
