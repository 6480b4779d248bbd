"""What a study of correspondences came to."""

from dataclasses import dataclass

from babbling.axes import FloatArray
from experiments.correspondence.acts import Acts
from experiments.correspondence.options import Config
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

    def error_deg(self, who: Retargeted) -> float:
        """Mean over the parts and frames that inverse kinematics can reach."""
        return who.mean_error_deg(self.oracle.found.reachable)


@dataclass(frozen=True)
class Hidden:
    """One part hidden for a second while it moved most, with noisy eyes."""

    demonstration: str
    part: str
    error_deg: float
    """Mean over all parts and frames."""
    seen_error_deg: float
    """The same when nothing was hidden."""
    worst_speed: float
    """Fastest joint of the sub-goals, rad/s."""


@dataclass(frozen=True)
class Studied:
    """Everything one run found."""

    config: Config
    clean: Pupil
    noisy: Pupil
    rows: dict[str, Row]
    curve: FloatArray
    """(K, 3) body-minutes, error with clean and with noisy eyes, degrees."""
    hidden: list[Hidden]
    acts: Acts

    @property
    def shown(self) -> Row:
        """The teacher of the recording."""
        return shown(self.config, self.rows)


def shown(config: Config, rows: dict[str, Row]) -> Row:
    """The teacher that is asked for, or else the first."""
    return rows.get(config.shown) or next(iter(rows.values()))
