"""Memories act only where they were made: another body, thing or list of states is refused in words."""

import numpy as np
import pytest

from imitation.deferred import ActMemory, IntentMemory
from imitation.errors import ImitationError

ACT = ActMemory("mine", "panel", np.array([0, 6]), np.array([0.2, 0.8]))
INTENT = IntentMemory("mine", "cup", np.array([0.2, 0.8]), 0.9, np.array([0, 3]))


def test_what_fits_is_taken() -> None:
    assert ACT.check("mine", 7) is None and INTENT.check("mine", "cup", 2, 2) is None


def test_an_act_of_another_body_or_of_states_that_are_not_known_is_refused() -> None:
    with pytest.raises(ImitationError, match=r"another body \(fingerprint mine, this body has other\)"):
        ACT.check("other", 7)
    with pytest.raises(ImitationError, match="knows of state 6; 0 to 5 are possible"):
        ACT.check("mine", 6)


@pytest.mark.parametrize("goals, states", [(3, 2), (2, 3), (1, 2)])
def test_an_intention_of_another_body_thing_or_list_is_refused(goals: int, states: int) -> None:
    with pytest.raises(ImitationError, match="another body"):
        INTENT.check("other", "cup", 2, 2)
    with pytest.raises(ImitationError, match="this memory is of a cup, not of a panel"):
        INTENT.check("mine", "panel", 2, 2)
    with pytest.raises(ImitationError, match=f"2 goals and 2 states; {goals} and {states} are needed"):
        INTENT.check("mine", "cup", goals, states)
    nothing = IntentMemory("mine", "cup", np.zeros(2), 0.9, np.array([0, 3]))
    with pytest.raises(ImitationError, match="goals that sum to something"):
        nothing.check("mine", "cup", 2, 2)
