"""What one run of `imitate gesture` produced, for its figures and its recording."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray
from experiments.gesture.options import Config
from experiments.shared.minds import Learned
from experiments.shared.watching import Seen
from imitation.acting.loop import Attempt
from models.body import SimulatedBody


@dataclass(frozen=True)
class Performed:
    """Everything that one run of the experiment produced, for figures and the recording."""

    config: Config
    body: SimulatedBody
    seen: Seen
    learned: Learned
    attempts: list[Attempt]
    peer: Attempt
    """The linear inverse model in the same loop."""
    replayed: FloatArray

    @property
    def imitated(self) -> FloatArray:
        """(T, J) true joint angles of the last attempt."""
        return self.attempts[-1].truth[:, 0]

    @property
    def factors(self) -> NDArray[np.intp]:
        """(J,) factor of each joint, by the sense it moves."""
        labels = [self.body.sense_labels[line] for line in self.learned.mind.pilot.schema.posture]
        return np.array([labels.index(joint) if joint in labels else 0 for joint in self.body.joints])

    @property
    def busiest(self) -> NDArray[np.intp]:
        """Joints by how much they move, most first."""
        return np.argsort(-self.seen.angles.std(0), kind="stable")
