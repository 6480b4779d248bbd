"""Options of the command line: blocks that experiments share, and the checks that all options have in common.

What stands here and in every `experiments/NAME/options.py` is light to load: help and refusals are quick.
"""

from dataclasses import dataclass, fields
from inspect import get_annotations
from math import inf
from pathlib import Path
from typing import Annotated, TypeVar, dataclass_transform

import tyro

from experiments.errors import ExperimentError
from imitation.inference.selection import selection_rule
from models.robots import find as find_robot
from models.robots import head_of
from models.teachers.demonstrations import find as find_demonstration

BABBLING_MINUTES = 20.0
LONGEST_MINUTES = 1e5
MIRROR_MINUTES = 6.0
"""Body-minutes in front of the mirror; `imitate correspondence` shows what fewer and more would give."""

Kind = TypeVar("Kind")


@dataclass_transform(frozen_default=True, kw_only_default=True)
def options(kind: type[Kind]) -> type[Kind]:
    """A frozen dataclass whose own fields come before those it inherits: help begins with what is special."""
    made = dataclass(frozen=True, kw_only=True)(kind)
    first = {name: number for number, base in enumerate(kind.__mro__) for name in get_annotations(base)}
    entries = vars(made)["__dataclass_fields__"].items()
    made.__dataclass_fields__ = dict(sorted(entries, key=lambda entry: first[entry[0]]))  # type: ignore[attr-defined]
    return made


@options
class Options:
    """What every experiment is asked."""

    seed: int = 0
    """Seed of everything random."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """Folder for the results; default runs/NAME."""

    def check(self) -> None:
        """Refuse options that cannot be meant, before anything is loaded or spent.

        Raises:
            ExperimentError, BodyError, BabblingError: the option, what is wrong with it and what is possible.
        """
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name != "out" and isinstance(value, Path):
                check_file(value)
        self.check_range("seed", 0)
        if hasattr(self, "selection"):
            selection_rule(self.selection)
        if hasattr(self, "babbling_minutes"):
            self.check_range("babbling_minutes", 0, LONGEST_MINUTES, above=True)

    def check_range(self, name: str, low: float, high: float = inf, unit: str = "", *, above: bool = False) -> None:
        """Refuse a number out of its range; `above` excludes `low` itself."""
        value = getattr(self, name)
        if value is None or ((low < value if above else low <= value) and value <= high):
            return
        if above:
            possible = f"be more than {low:g} and at most {high:.12g}"
        else:
            possible = f"be {low:g} or more" if high == inf else f"lie between {low:g} and {high:.12g}"
        raise ExperimentError(f"--{name.replace('_', '-')} {value:g}: it must {possible} {unit}".rstrip())

    def check_some(self, name: str) -> None:
        """Refuse a count of nothing."""
        value = getattr(self, name)
        if (value if isinstance(value, int) else len(value)) < 1:
            raise ExperimentError(f"--{name.replace('_', '-')} {value or 0}: at least 1 is needed")


def check_file(path: Path) -> None:
    """Refuse a path that cannot be read.

    Raises:
        ExperimentError: there is none, or it is no file.
    """
    try:
        if path.is_file():
            return
        if path.is_dir():
            raise ExperimentError(f"{path}: this is a directory; name a file in it")
        wrong = "this is no regular file" if path.exists() else "there is no such file"
    except OSError as error:
        wrong = f"it cannot be looked up ({error.strerror or error})"
    raise ExperimentError(f"{path}: {wrong}; give the path of an existing one")


def check_demonstration(name_or_path: str) -> None:
    """Refuse a demonstration that is neither built in nor a file.

    Raises:
        ExperimentError, BodyError: see `check_file` and `models.teachers.demonstrations.find`.
    """
    if find_demonstration(name_or_path) is None:
        check_file(Path(name_or_path))


@options
class WiredOptions(Options):
    """A body whose wiring is learned."""

    scramble: int | None = None
    """Seed of an unknown wiring between mind and body."""
    threads: int = 2
    """Worker threads; the result does not depend on it."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        self.check_range("scramble", 0)
        self.check_range("threads", 1, 256)


@options
class BodyOptions(WiredOptions):
    """Which body, and what it feels like."""

    robot: str = "hoap2"
    """hoap2, hoap2-worn, or the path of an MJCF file with position actuators."""
    sensor_noise_deg: float = 0.0
    """Standard deviation of every angle sense, degrees."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        self.check_range("sensor_noise_deg", 0, 30, "degrees")
        self.check_robot()

    def check_robot(self) -> None:
        """Refuse a robot that is neither registered nor a file."""
        if find_robot(self.robot) is None:
            check_file(Path(self.robot))


@options
class MirrorOptions(WiredOptions):
    """How well one sees, and how long one looks into the mirror."""

    seeing_noise_deg: float = 0.0
    """Standard deviation of every seen direction across the line of sight, degrees: in the mirror and of the teacher;
    for the learned correspondence."""
    mirror_minutes: float = MIRROR_MINUTES
    """Body-minutes in front of the mirror."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        self.check_range("seeing_noise_deg", 0, 30, "degrees")
        self.check_range("mirror_minutes", 0, 600, above=True)


@options
class EyeOptions(Options):
    """How the eyes see."""

    robot: str = "biclops"
    """biclops or hoap2."""
    noise: float = 0.02
    """Pixel noise, standard deviation as a share of full scale."""
    width: int = 160
    """Pixels of each retina, across."""
    height: int = 120
    """Pixels of each retina, down."""
    blur: float = 0.0
    """Standard deviation of a blur, pixels."""
    fovy_deg: float | None = None
    """Vertical field of view; None is the robot's own."""
    renderer: str = "rays"
    """rays (no graphics needed) or mujoco (EGL or OSMesa)."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        head_of(self.robot)
