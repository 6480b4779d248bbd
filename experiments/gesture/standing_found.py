"""What one run of `imitate gesture --stand` produced, for its figures and its recording."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.balance import Balance
from experiments.gesture.options import Config
from experiments.shared.judging import lately
from experiments.shared.minds import Learned
from experiments.shared.standing import LET_GO_S, Performance
from experiments.shared.trajectories import trajectories
from experiments.shared.watching import Seen
from imitation.acting.balancing import Balancer
from imitation.acting.loop import through_time
from models.standing import StandingBody

if TYPE_CHECKING:
    import xarray as xr


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
    """(J,) the factor of each joint; see `factors_of`."""

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

    def during(self, who: str = "ours") -> slice:
        """The ticks of the movement itself."""
        first = self.done[who].first
        return slice(first, first + len(self.wanted))

    @property
    def title(self) -> str:
        """Whose movement, by whom."""
        return f"{self.config.demonstration} by {self.config.robot} on its feet, seed {self.config.seed}"

    @property
    def trajectories(self) -> "xr.Dataset":
        """Labelled arrays; see `experiments.shared.trajectories`."""
        said = {"linear": "with the line of the same experience", "replay": "where the sub-goals are simply sent"}
        shown = {"demonstrated": (self.wanted, "sub-goals: the demonstration in the imitator's own joints")} | {
            who.replace("replay", "replayed"): (self.done[who].angles[self.during(who), 0], f"true posture {words}")
            for who, words in said.items()
        }
        ours, during = self.ours, self.during()
        info = {name: values[during] for name, values in through_time(ours.infos).items()}
        found = trajectories(self.body, self.order, shown, [(ours.angles[during, 0], info)], title=self.title)
        carries, upright = self.balance.carries[self.order] > 0, ours.upright[during, 0]
        told = "whether balance commands it, whatever Eq. (1) says of this joint alone"
        found["carries"] = ("joint", carries.astype("i1"), {"units": "1", "long_name": told})
        found["upright"] = ("time", upright.astype("i1"), {"units": "1", "long_name": "whether it has not fallen"})
        return found

    @property
    def demonstrated(self) -> FloatArray:
        """(T, nq) the sub-goals where the imitator stands, to draw them."""
        ours = self.ours.configurations[self.during(), 0]
        free = (self.body.configurations(self.wanted + 1) == self.body.configurations(self.wanted)).all(0)
        return np.where(free, ours, self.body.configurations(self.wanted))

    @property
    def ours(self) -> Performance:
        """What the imitator did."""
        return self.done["ours"]
