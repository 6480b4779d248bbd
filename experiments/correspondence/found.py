"""What a study of correspondences came to."""

from dataclasses import dataclass
from pathlib import Path

from babbling.axes import FloatArray
from experiments.correspondence.acts import Acts
from experiments.correspondence.options import Config
from experiments.shared.judging import Sweep
from experiments.shared.mirrors import Pupil
from experiments.shared.oracle import Retargeted
from models.teachers.performance import Performance


@dataclass(frozen=True)
class Row:
    """One teacher: the oracle, and the learned correspondence with clean and with noisy eyes."""

    performance: Performance
    oracle: Retargeted
    clean: Retargeted
    noisy: Retargeted

    @property
    def label(self) -> str:
        """Who is seen, for people; of a file its name."""
        name = self.performance.name
        return f"{name if len(name) < 30 else Path(name).stem} ({self.performance.teacher})"

    def error_deg(self, who: Retargeted) -> float:
        """Mean over the parts and frames that inverse kinematics can reach."""
        return who.mean_error_deg(self.oracle.found.reachable)


@dataclass(frozen=True)
class Studied:
    """Everything one run found."""

    config: Config
    clean: Pupil
    noisy: Pupil
    rows: dict[str, Row]
    shown: Row
    """The teacher of the recording: who is asked for, or else the first."""
    curve: FloatArray
    """(K, 3) body-minutes, error with clean and with noisy eyes, degrees."""
    hidden: FloatArray
    """(K, 2) of each teacher, one part hidden for a second while it moved most, with noisy eyes: mean error over all
    parts and frames, as a multiple of that with nothing hidden; and the fastest joint of the sub-goals, rad/s."""
    acts: Acts
    harder: dict[str, Sweep]
    """By what makes acts hard to put to a part."""
