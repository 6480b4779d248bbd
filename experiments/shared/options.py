"""Options of the command line: blocks that experiments share, and the checks that all options have in common.

What stands here and in every `experiments/NAME/options.py` is light to load: help and refusals are quick.
"""

import re
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass
from importlib.util import find_spec
from inspect import get_annotations
from itertools import islice
from math import inf
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal, TypeVar, dataclass_transform, get_args, get_type_hints

import tyro

from babbling.errors import unknown
from experiments.errors import ExperimentError
from experiments.shared.explained import explained
from imitation.inference.selection import SELECTION, selection_rule
from models.files import checked
from models.robots import ROBOTS, head_of
from models.robots import find as find_robot
from models.teachers.demonstrations import DEMONSTRATIONS
from models.teachers.demonstrations import find as find_demonstration

BABBLING_MINUTES = 12.333
"""Body-minutes in all: HOAP-2's pilot takes the first 2 1/3 of them."""
LOCAL = "local"
"""Instead of a scheduler's address: a cluster of processes of this machine."""
LONGEST_MINUTES, LARGEST_FILE, MOST_PUSH, MOST_NAMES, LARGEST_SEED = 1e5, 1 << 40, 500.0, 1000, 4_000_000_000
MIRROR_MINUTES = 6.0
"""Body-minutes in front of the mirror; `imitate correspondence` shows what fewer and more would give."""

Kind = TypeVar("Kind")
Rule = Callable[[str, Any], object]
"""Raises for a value that cannot be meant; it is told the option's name too. Rules stand in the type of an option."""


def within(low: float, high: float = inf, unit: str = "", *, above: bool = False) -> Rule:
    """A range of numbers; `above` leaves out `low` itself."""
    possible = f"be {low:g} or more" if high == inf else f"lie between {low:g} and {high:.12g}"
    if above:
        possible = f"be more than {low:g} and at most {high:.12g}"

    def rule(option: str, value: float) -> None:
        said = f"{value:g}" if isinstance(value, float) else str(value)[:24]
        if not ((low < value if above else low <= value) and value <= high):
            raise ExperimentError(f"{option} {said}: it must {possible} {unit}".rstrip())

    return rule


def some(option: str, names: tuple[object, ...]) -> None:
    """A list of at least one."""
    if not names:
        raise ExperimentError(f"{option} 0: at least 1 is needed")


def one_of(what: str, names: Collection[str]) -> Rule:
    """A name that there is."""

    def rule(option: str, name: str) -> None:
        if name not in names:
            raise ExperimentError(f"{option} {unknown(what, name, names)}")

    return rule


def file(option: str, path: Path | str) -> None:
    """A file that can be read."""
    checked(path, LARGEST_FILE)


def a_push(option: str, told: str) -> None:
    """ "t,fx,fy,fz": t not below 0, no force beyond all bounds."""
    try:
        when, *force = map(float, told.split(","))
    except ValueError:
        when, force = -1.0, []
    if len(force) != 3 or not 0 <= when < inf or not all(-MOST_PUSH <= one <= MOST_PUSH for one in force):
        raise ExperimentError(
            f'{option} {told[:60]!r}: it must be "t,fx,fy,fz", seconds from 0 on and newtons, {MOST_PUSH:g} at most'
        )


def must_stand(robot: str) -> None:
    """Refuse a robot that cannot stand on its own feet.

    Raises:
        ExperimentError: see above; those that can are listed.
    """
    if robot not in ROBOTS or ROBOTS[robot].stance is None:
        able = ", ".join(name for name, one in ROBOTS.items() if one.stance)
        raise ExperimentError(f"--stand --robot {robot}: it has no soles or balance organ; these have: {able}")


def known(find: Callable[[str], object]) -> Rule:
    """What `find` finds, or else, where it finds None, a file."""
    return lambda option, name: file(option, name) if find(name) is None else None


def a_film(option: str, kind: str) -> None:
    """A kind of film that can be written here."""
    if kind == "mp4" and find_spec("av") is None:
        raise ExperimentError(
            f"{option} mp4: the package av is not installed; pip install 'imitation-laboratory[film]', or {option} gif"
        )


def a_scheduler(option: str, told: str) -> None:
    """`local`, or the address of a Dask scheduler; where Dask is installed."""
    if told != LOCAL and not re.fullmatch(r"(tcp|tls)://(\[[0-9a-fA-F:]+\]|[\w.-]+):\d{1,5}", told):
        raise ExperimentError(f"{option} {told[:60]}: it must be tcp://HOST:PORT of a Dask scheduler, or {LOCAL}")
    if find_spec("distributed") is None:
        raise ExperimentError(
            f"{option}: the package distributed is not installed; pip install 'imitation-laboratory[cluster]', "
            "or leave it out"
        )


def choices(names: Iterable[str], most: int = 20) -> str:
    """Names as help shows them; beyond so many, dots."""
    first = [f'"{name}"' if " " in name else name for name in islice(names, most + 1)]
    return "{" + ",".join(first if len(first) <= most else [*first[:most], "..."]) + "}"


def written(metavar: str, default: str | None = None) -> Any:
    """How help shows an option: what stands for its value, and in words what holds without it; "" says nothing."""
    return tyro.conf.arg(metavar=metavar, help_behavior_hint=f"(default: {default})" if default else default)


DEG, M, N, S = map(written, ("DEG", "METRES", "N", "SECONDS"))
"""How help shows numbers: their unit, or a count."""
DEMONSTRATION, ROBOT = f"{choices(DEMONSTRATIONS, 2)}|FILE", f"{choices(ROBOTS, 2)}|FILE.xml"
Demonstration = Annotated[str, known(find_demonstration), written(DEMONSTRATION)]
Film = Annotated[Literal["mp4", "gif"], a_film]
Flag = Annotated[bool, tyro.conf.arg(help_behavior_hint="(default: no)")]
Minutes = Annotated[float, within(0, LONGEST_MINUTES, above=True), written("MINUTES")]
Robot = Annotated[str, known(find_robot), written(ROBOT)]
Scheduler = Annotated[str, a_scheduler, written("ADDRESS|local")]
Seed = Annotated[int, within(0, LARGEST_SEED), written("SEED")]
Selection = Annotated[str, known(selection_rule), written(choices(SELECTION))]
Category = Annotated[str, known(selection_rule), written(choices(name for name in SELECTION if name != "mean"))]
"""A selection rule for actions that are categories and have no mean."""
ToRead = Annotated[Path, file]


@dataclass_transform(frozen_default=True, kw_only_default=True)
def options(kind: type[Kind]) -> type[Kind]:
    """A frozen dataclass whose own fields come before those it inherits: help begins with what is special."""
    made = dataclass(frozen=True, kw_only=True)(kind)
    first = {name: number for number, base in enumerate(kind.__mro__) for name in get_annotations(base)}
    entries = vars(made)["__dataclass_fields__"].items()
    made.__dataclass_fields__ = dict(sorted(entries, key=lambda entry: first[entry[0]]))  # type: ignore[attr-defined]
    for name, line in explained(kind).items():
        made.__dataclass_fields__[name].metadata = MappingProxyType({"help": line})  # type: ignore[attr-defined]
    return made


def obey(option: str, kind: Any, value: Any) -> None:
    """Hold a value to the rules in its type; None is held to none."""
    if isinstance(value, tuple) and len(value) > MOST_NAMES:
        raise ExperimentError(f"{option}: {len(value)} are named; at most {MOST_NAMES} are possible")
    if isinstance(value, str | Path):
        try:
            str(value).encode()
        except UnicodeEncodeError:
            raise ExperimentError(f"{option} {value}: this name is not text here; choose a plainer one") from None
    for rule in getattr(kind, "__metadata__", ()):
        if callable(rule) and value is not None:
            rule(option, value)
    for inner in get_args(kind):
        for one in value if isinstance(value, tuple) else (value,):
            obey(option, inner, one)


def obey_all(config: object) -> None:
    """Hold every option to the rules in its type."""
    for name, kind in get_type_hints(type(config), include_extras=True).items():
        obey(f"--{name.replace('_', '-')}", kind, getattr(config, name))


@options
class Options:
    """What every experiment is asked."""

    seed: Seed = 0
    """Seed of everything random."""
    out: Annotated[Path | None, written("DIR", "runs/ and the name of the command")] = None
    """Folder for the results."""
    quiet: Flag = False
    """No progress, remarks or tables: only where the results are."""

    def check(self) -> None:
        """Refuse options that cannot be meant, before anything is loaded or spent.

        Raises:
            ExperimentError, BodyError, BabblingError: the option, what is wrong with it and what is possible.
        """
        obey_all(self)


@options
class ShardOptions(Options):
    """Who does what can be done apart."""

    workers: Annotated[int, within(1, 256), N] = 2
    """Processes; the result does not depend on it."""
    scheduler: Annotated[Scheduler | None, written("ADDRESS|local", "processes of this machine")] = None
    """tcp://HOST:PORT of a Dask scheduler, whose workers do it instead; or local, a Dask cluster of --workers processes
    of this machine. The result does not depend on it."""


@options
class TableOptions(Options):
    """What is left of movements besides trajectories.nc."""

    csv: Flag = False
    """Also trajectories.csv: a row for every attempt, time and joint."""


@options
class WiredOptions(Options):
    """A body whose wiring is learned."""

    scramble: Annotated[Seed | None, written("SEED", "wired straight")] = None
    """Seed of an unknown wiring between mind and body."""
    threads: Annotated[int, within(1, 256), N] = 2
    """Worker threads; the result does not depend on it."""


@options
class BodyOptions(WiredOptions):
    """Which body, and what it feels like."""

    robot: Robot = "hoap2"
    """A robot that `imitate list` names, or the path of an MJCF with position actuators."""
    servos: Flag = False
    """Give motors that know only torques, or speeds, position servos: of 8 Hz and damping ratio 0.9 by their joints'
    inertia, their torque limits kept."""
    sensor_noise_deg: Annotated[float, within(0, 30, "degrees"), DEG] = 0.0
    """Standard deviation of every angle sense, degrees."""


@options
class WatchingOptions(Options):
    """Watching movements that people bring."""

    unit: Annotated[Literal["rad", "deg"] | None, written("{rad,deg}", "what it declares, or radians")] = None
    """Unit of the joint angles in a demonstration's file, whatever it declares."""


@options
class MirrorOptions(WiredOptions):
    """How well one sees, and how long one looks into the mirror."""

    seeing_noise_deg: Annotated[float, within(0, 30, "degrees"), DEG] = 0.0
    """Standard deviation of every seen direction across the line of sight, degrees: in the mirror and of the teacher;
    for the learned correspondence."""
    mirror_minutes: Annotated[float, within(0, 600, above=True), written("MINUTES")] = MIRROR_MINUTES
    """Body-minutes in front of the mirror."""
    parts: Literal["named", "unnamed"] = "named"
    """Whether a teacher's parts come under the names of one's own, or shuffled and without names: then only which of
    them touch is seen, and which is which is found by the learned body image."""


@options
class EyeOptions(Options):
    """How the eyes see."""

    robot: Annotated[str, known(head_of), written(choices(name for name, one in ROBOTS.items() if one.head))] = (
        "biclops"
    )
    """Whose head."""
    scramble: Annotated[Seed | None, written("SEED", "wired straight")] = None
    """Seed of an unknown wiring between mind and neck."""
    squint: Annotated[Seed | None, written("SEED", "parallel")] = None
    """Seed of how the eyes stand out of parallel: toed in by 1 to 3 deg each, up to 1 deg nodded and rolled."""
    noise: Annotated[float, within(0, 1, "of full scale"), written("SHARE")] = 0.02
    """Pixel noise, standard deviation as a share of full scale."""
    width: Annotated[int, within(8, 2048, "pixels"), written("PIXELS")] = 160
    """Pixels of each retina, across."""
    height: Annotated[int, within(8, 2048, "pixels"), written("PIXELS")] = 120
    """Pixels of each retina, down."""
    blur: Annotated[float, within(0, 20, "pixels"), written("PIXELS")] = 0.0
    """Standard deviation of a blur, pixels."""
    fovy_deg: Annotated[Annotated[float, within(1, 150, "degrees")] | None, written("DEG", "the robot's own")] = None
    """Vertical field of view, degrees."""
    renderer: Literal["rays", "mujoco"] = "rays"
    """rays (no graphics needed) or mujoco (EGL or OSMesa)."""
