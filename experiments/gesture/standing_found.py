"""What one run of `imitate gesture --stand` produced, for its figures and its recording."""

from dataclasses import dataclass

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.balance import Balance
from experiments.gesture.options import Config
from experiments.shared.judging import lately
from experiments.shared.minds import Learned
from experiments.shared.standing import LET_GO_S, Performance
from experiments.shared.watching import Seen
from imitation.acting.balancing import Balancer
from models.standing import StandingBody


def touches(done: Performance, copy: int, during: slice, judge: StandingBody) -> tuple[BoolArray, BoolArray]:
    """(T,) ticks at which parts of this copy touch each other; those at which it is upright and nothing touches, nor
    did `LET_GO_S` before."""
    touching = judge.touching(done.configurations[during, copy])
    return touching, done.upright[during, copy] & ~lately(touching, LET_GO_S / judge.tick_s)


@dataclass(frozen=True)
class Stands:
    """What one run of `imitate gesture --stand` produced, for its figures and its recording."""

    config: Config
    body: StandingBody
    learned: Learned
    balance: Balance
    balancer: Balancer
    seen: Seen
    wanted: FloatArray
    """(T, J) joint angles to come to, at this pace, in the body's own order."""
    done: dict[str, Performance]
    """By who did it."""
    order: IntArray
    """(J,) the factor of each joint."""

    @property
    def sides(self) -> FloatArray:
        """(2,) signs by which people call forward and left positive; the mind does not know which is which."""
        labels = self.body.senses["touch"].labels
        front = [1.0 if "front" in label else -1.0 for label in labels]
        left = [1.0 if label.startswith("left") else -1.0 for label in labels]
        return np.asarray(np.sign(np.sum(self.balance.pressing * np.array([front, left]), 1)))

    def pressed(self, loads: FloatArray) -> FloatArray:
        """(..., 2) pressure as people look at it."""
        return self.sides * self.balance.pressed(loads)

    @property
    def ours(self) -> Performance:
        """What the imitator did."""
        return self.done["ours"]
