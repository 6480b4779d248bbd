"""Options of `imitate robot`."""

from pathlib import Path
from typing import Annotated

import tyro

from experiments.errors import ExperimentError
from experiments.shared.options import ROBOT, Flag, Options, known, options, written
from models.robots import find as find_robot


def a_new_csv(option: str, path: Path) -> None:
    """A file that can be begun: nothing is overwritten."""
    if path.suffix.lower() != ".csv":
        raise ExperimentError(f"{option} {path}: a movement of joints is a .csv; name it {path.stem or 'wave'}.csv")
    if path.exists() or path.is_symlink():
        raise ExperimentError(f"{option} {path}: this is there already and would be lost; choose another name")


@options
class Config(Options):
    """Options of `imitate robot`."""

    robot: Annotated[str, known(find_robot), tyro.conf.Positional, written(f"[{ROBOT}]")] = "hoap2"
    """A robot that `imitate list` names, or the path of an MJCF."""
    servos: Flag = False
    """Give motors that know only torques, or speeds, position servos, as `imitate gesture --servos` does."""
    template: Annotated[Path | None, a_new_csv, written("FILE.csv", "none")] = None
    """Also a gentle movement of every joint, out and back, that this robot can be shown: a start for one's own."""

    def check(self) -> None:
        """See `Options`; nothing but the template is left."""
        super().check()
        if self.out is not None:
            raise ExperimentError(f"--out {self.out}: a card is printed, not kept; --template FILE.csv leaves a file")
