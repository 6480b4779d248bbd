"""Peers of the forward model that come from elsewhere."""

from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from babbling.loop import Transitions
from babbling.mind import Mind
from imitation.inference.inverse import Choice, Term, single


def have_sklearn() -> bool:
    """Whether scikit-learn (extra `peers`) is installed."""
    return find_spec("sklearn") is not None


class MLPInverse:
    """scikit-learn's multilayer perceptron: all rates and wanted outcomes in, all actions out, on the same babbling.

    It sees every factor at once (the tables and the line see one each), standardised by the axes' ranges.
    """

    def __init__(self, mind: Mind, seen: Transitions, seed: int, rows: int = 30_000) -> None:
        from sklearn.neural_network import MLPRegressor

        model = mind.forward_model
        self.scale = (model.contexts[0].high, model.outcome.high, model.action.high)
        self.line = model.linear()
        step = max(1, len(seen.action) // rows)
        x = np.concatenate([seen.context[0] / self.scale[0], seen.outcome / self.scale[1]], 1)[::step]
        net: Any = MLPRegressor(
            hidden_layer_sizes=(128,), learning_rate_init=3e-3, max_iter=60, early_stopping=True, random_state=seed
        )
        self.net = net.fit(x, (seen.action / self.scale[2])[::step])

    def choose(self, terms: Sequence[Term], rng: np.random.Generator) -> Choice:
        """See `imitation.inference.inverse.InverseModel`."""
        term = single(terms)
        x = np.concatenate([term.context[0] / self.scale[0], term.outcome / self.scale[1]], -1)
        action: FloatArray = self.net.predict(x).reshape(term.outcome.shape) * self.scale[2]
        return Choice(action, None, np.zeros(action.shape, np.int8))

    def expect(self, context: tuple[FloatArray, ...], action: FloatArray) -> FloatArray:
        """See `imitation.inference.inverse.InverseModel`: the line's expectation; the net has no forward model."""
        return self.line.predict(*context, action)[..., 0]
