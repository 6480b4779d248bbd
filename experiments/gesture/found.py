"""What one run of `imitate gesture` produced, for its figures and its recording."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.gesture.options import Config
from experiments.shared.minds import Learned, factors_of
from experiments.shared.mirrors import limbs_off_deg
from experiments.shared.oracle import at_ticks
from experiments.shared.trajectories import trajectories
from experiments.shared.watching import Seen
from imitation.acting.loop import Attempt
from imitation.acting.movement import slowed
from models.body import SimulatedBody
from models.mirror import Mirror
from models.teachers.performance import unit

if TYPE_CHECKING:
    import xarray as xr


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

    def away(self, angles: FloatArray) -> FloatArray:
        """(t, J) how far (t, J) joint angles are from the sub-goals, each joint in what people read."""
        return np.asarray(self.body.shown_scale * (angles - self.seen.angles[: len(angles)]))

    def joints_in(self, unit: str) -> BoolArray:
        """(J,) which joints people read in this unit."""
        return np.array([own == unit for own in self.body.shown_units])

    @property
    def usual(self) -> str:
        """The unit in which several joints are shown as one: never hinges beside slides."""
        return "deg" if "deg" in self.body.shown_units else self.body.shown_units[0]

    @cached_property
    def limb_errors_deg(self) -> dict[str, FloatArray]:
        """Who -> (T, P) degrees between where the body points and where the teacher pointed, at the imitation's pace;
        "steadied": imitated, against what the imitator took the teacher to show; "least": see `Retargeted.best_deg`.
        Nothing when joint angles were given."""
        oracle, teacher, frames = self.seen.oracle, self.seen.teacher, len(self.imitated)
        if oracle is None or teacher is None:
            return {}
        mirror, showed, took = (
            Mirror(self.body),
            at_ticks(teacher, self.body.tick_s),
            (self.seen.learned or oracle).found,
        )
        wanted = {part: showed[part][:frames] for part in oracle.found.parts}
        steadied = dict(zip(took.parts, unit(slowed(took.wanted, self.seen.slowed)).swapaxes(0, 1), strict=True))
        compared = {"imitated": (self.imitated, wanted), "replayed": (self.replayed, wanted)}
        compared |= {"line": (self.peer.truth[:, 0], wanted), "steadied": (self.imitated, steadied)}
        found = {"least": slowed(oracle.best_deg, self.seen.slowed).clip(0)}
        for who, (angles, aims) in compared.items():
            found[who] = limbs_off_deg(mirror, angles, aims)
        return found

    @cached_property
    def trajectories(self) -> "xr.Dataset":
        """Labelled arrays; see `experiments.shared.trajectories`."""
        shown = {
            "demonstrated": (self.seen.angles, "sub-goals: the demonstration in the imitator's own joints"),
            "replayed": (self.replayed, "true posture where the sub-goals are simply sent"),
            "linear": (self.peer.truth[:, 0], "true posture with the inverse of a line in the same loop"),
        }
        attempts = [(attempt.truth[:, 0], vars(attempt)) for attempt in self.attempts]
        return trajectories(self.body, self.factors, shown, attempts, title=self.title)

    @property
    def title(self) -> str:
        """Whose movement, by whom."""
        return f"{self.seen.movement.name} by {self.config.robot}, seed {self.config.seed}"

    @property
    def factors(self) -> IntArray:
        """(J,) see `factors_of`."""
        return factors_of(self.body, self.learned.mind)

    @property
    def busiest(self) -> NDArray[np.intp]:
        """Joints by how much they move, most first; beside slides, by shares of their ranges."""
        span = np.ptp(self.body.joint_range, axis=1) if "m" in self.body.units else 1.0
        return np.argsort(-self.seen.angles.std(0) / span, kind="stable")

    @property
    def worst(self) -> list[int]:
        """Joints that babbling found, by their error in the last attempt, greatest first; hinges before slides."""
        error = np.sqrt(np.mean((self.imitated - self.seen.angles) ** 2, axis=0))
        order = np.lexsort((-error, np.array(self.body.units) != "rad"))
        return [int(j) for j in order if self.factors[j] >= 0]
