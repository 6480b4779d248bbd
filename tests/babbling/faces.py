"""A face mind of few numbers."""

import numpy as np

from babbling.axes import Axis
from babbling.dark import FaceMind
from babbling.forward_model import ForwardModel
from babbling.relations import RELATIONS, Landmarks


def small_mind() -> FaceMind:
    """Every relation is what its own motor is told, whatever the gap."""
    one, rng = np.ones(len(RELATIONS)), np.random.default_rng(0)
    axes = Axis("gap", "W", -0.1 * one, one, 2), Axis("command", "1", -one, one, 5), Axis("amount", "W", -one, one, 5)
    model = ForwardModel([axes[0]], *axes[1:], factors=RELATIONS, prior_strength=1.0, fingerprint="f")
    told = rng.uniform(-1, 1, (100, len(RELATIONS)))
    model.observe([rng.uniform(0, 1, told.shape)], told, told)
    return FaceMind("f", model, np.arange(len(RELATIONS)), 0 * one, 0 * one, Landmarks(0.01, 0.006))
