"""Counting on: what is felt while imitating is experience too.

Each step is a transition as in babbling (`babbling.pilot`), foretold first and counted afterwards. What was
counted long ago may no longer hold: after a change that was noticed it fades to a share.
"""

from copy import deepcopy
from dataclasses import replace

import numpy as np

from babbling.axes import FloatArray
from babbling.mind import Mind
from imitation.acting.loop import Info, State


class CountingOn:
    """A mind of its own, learning from what it heeds (`heed` of `imitate`); the one it was given stays as it is."""

    def __init__(self, mind: Mind) -> None:
        self.mind = replace(mind, forward_model=deepcopy(mind.forward_model))
        self._columns, self._outcome = list[FloatArray](), list[FloatArray]()
        self._coasted = np.zeros(0)

    def __call__(self, state: State, senses: FloatArray, info: Info) -> None:
        """See `imitate`."""
        pilot = self.mind.pilot
        features, (posture, rate, _) = pilot.frame.features, np.moveaxis(info.believed, -1, 0)
        if state.tick:
            self._outcome.append(posture - self._coasted)
        else:
            self._columns = self._columns[: len(self._outcome)]
        self._columns.append(features.columns(posture, rate, state.echo, features.plays(state.echo, info.commands)))
        self._coasted = posture + pilot.dynamics.coasting * rate

    def count(self, keep: float = 1.0) -> tuple[FloatArray, FloatArray]:
        """Let what is known fade to this share, then foretell and count what was felt since: returns these (N, F,
        COLUMNS) features and (N, F) outcomes."""
        model, n = self.mind.forward_model, len(self._outcome)
        model.fade(keep)
        columns, outcome = (np.concatenate(x) for x in (self._columns[:n], self._outcome))
        model.observe(columns, outcome)
        self._columns, self._outcome = [], []
        return columns, outcome
