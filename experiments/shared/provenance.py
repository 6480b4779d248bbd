"""What is needed to run something again: options, versions, commit."""

import subprocess
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from experiments.shared.options import Options

LIBRARIES = ("mujoco", "dm-control", "pin", "numpy", "scipy", "h5netcdf", "rerun-sdk", "matplotlib")
MAKES_NO_DIFFERENCE = ("out", "quiet", "workers", "scheduler", "shards", "threads", "keep")
"""Options that results do not depend on."""


def provenance(name: str, config: Options) -> dict[str, Any]:
    """Resolved options, versions and commit: what is needed to run it again."""
    return {
        "experiment": name,
        "options": {k: str(v) if isinstance(v, Path) else v for k, v in asdict(config).items()},
        "versions": {library: version(library) for library in LIBRARIES},
        "project": version("imitation-laboratory"),
        "commit": commit(),
    }


def commit() -> str | None:
    """Which commit of the project runs, and whether it was changed since; None outside a repository."""
    asked = ["git", "-C", str(Path(__file__).resolve().parent), "describe", "--always", "--dirty"]
    try:
        done = subprocess.run(asked, capture_output=True, text=True, timeout=5, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() or None
