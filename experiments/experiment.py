"""What every experiment is: a configuration, a run, and what it leaves behind.

An experiment is a module of this package with a frozen dataclass `Config` (its first docstring line is its one-line
description), a function `run(config) -> Result`, and an entry in `experiments.registry.EXPERIMENTS`.
"""

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from matplotlib.figure import Figure

from babbling.errors import BabblingError


class ExperimentError(BabblingError):
    """Something about an experiment's options that the user can mend."""


class Config(Protocol):
    """What every configuration has."""

    @property
    def out(self) -> Path | None:
        """Folder that receives the results; None is runs/NAME."""

    @property
    def seed(self) -> int:
        """Seed of everything random."""


@dataclass(frozen=True)
class Result:
    """What a run found, before anything is written."""

    metrics: dict[str, Any]
    """Numbers, by name; keys that end in _s, _ms or _factor are timings and may differ between runs."""
    summary: str
    """Markdown: the result as a table, for the terminal and the recording."""
    figures: Mapping[str, Figure] = field(default_factory=dict)
    """File stem -> figure."""
    record: Callable[[Path], None] | None = None
    """Writes the recording to the path it is given."""
    files: Mapping[str, Callable[[Path], None]] = field(default_factory=dict)
    """Further files: name -> writer."""


LIBRARIES = ("mujoco", "dm-control", "pin", "numpy", "scipy", "xarray", "rerun-sdk", "matplotlib")


def publish(name: str, config: Config, result: Result) -> Path:
    """Write config.json, metrics.json, recording.rrd and figures; everything appears at once, or nothing does.

    An older folder is replaced only once the new one is complete; a folder that holds anything but an older result is
    never touched.

    Raises:
        ExperimentError: the folder cannot be written, or is not one of ours.
    """
    out = Path(config.out) if config.out is not None else Path("runs") / name
    check_out(out)
    out.parent.mkdir(parents=True, exist_ok=True)
    beside = Path(tempfile.mkdtemp(prefix=f".{out.name}-", dir=out.parent))
    try:
        beside.chmod(0o755)
        (beside / "config.json").write_text(as_json(provenance(name, config)))
        (beside / "metrics.json").write_text(as_json(result.metrics))
        for stem, figure in result.figures.items():
            figure.savefig(beside / f"{stem}.png", dpi=130, bbox_inches="tight")
        for file, write in result.files.items():
            write(beside / file)
        if result.record is not None:
            result.record(beside / "recording.rrd")
        _swap(beside, out)
    finally:
        shutil.rmtree(beside, ignore_errors=True)
    return out


def check_out(out: Path) -> None:
    """Refuse early what `publish` could not write.

    Raises:
        ExperimentError: see `publish`.
    """
    if out.exists():
        if not out.is_dir():
            raise ExperimentError(f"--out {out}: this is a file; name a folder")
        if any(out.iterdir()) and not (out / "metrics.json").exists():
            raise ExperimentError(
                f"--out {out}: this folder holds other things than a result; name another or empty it"
            )
    parent = next(p for p in (out, *out.absolute().parents) if p.exists())
    if not parent.is_dir() or not os.access(parent, os.W_OK):
        raise ExperimentError(f"--out {out}: {parent} cannot be written; name a folder that can")


def _swap(new: Path, out: Path) -> None:
    if not out.exists():
        new.rename(out)
        return
    old = Path(tempfile.mkdtemp(prefix=f".{out.name}-old-", dir=out.parent))
    out.rename(old / "old")
    try:
        new.rename(out)
    except OSError:
        (old / "old").rename(out)
        raise
    finally:
        shutil.rmtree(old, ignore_errors=True)


def provenance(name: str, config: Config) -> dict[str, Any]:
    """Resolved options, versions and commit: what is needed to run it again."""
    return {
        "experiment": name,
        "options": {k: str(v) if isinstance(v, Path) else v for k, v in asdict(config).items()},  # type: ignore[call-overload]
        "versions": {library: version(library) for library in LIBRARIES},
        "project": version("imitation-laboratory"),
        "commit": _commit(),
    }


def _commit() -> str | None:
    here = Path(__file__).resolve().parent
    try:
        done = subprocess.run(
            ["git", "-C", str(here), "describe", "--always", "--dirty"],
            capture_output=True,
            text=True,
            timeout=5,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() or None


def as_json(value: Any) -> str:
    """Readable JSON of numbers, NumPy arrays and paths; refuses NaN and infinity."""

    def plain(x: Any) -> Any:
        if isinstance(x, Mapping):
            return {str(k): plain(v) for k, v in x.items()}
        if isinstance(x, np.ndarray):
            return plain(x.tolist())
        if isinstance(x, list | tuple):
            return [plain(v) for v in x]
        if isinstance(x, np.generic):
            return x.item()
        return x if x is None or isinstance(x, bool | int | float | str) else str(x)

    return json.dumps(plain(value), indent=2, allow_nan=False) + "\n"
