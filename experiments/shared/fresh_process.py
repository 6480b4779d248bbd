"""A process of its own, that knows nothing but files and arguments: for what has to work from memory alone."""

import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.errors import ExperimentError

Files = Mapping[str, Callable[[Path], object]]
"""Name and writer of each."""
RESULT = "result.npz"


def in_new_process(module: str, files: Files, *words: object) -> dict[str, NDArray[Any]]:
    """The arrays that `python -m MODULE FOLDER WORDS ...` leaves in FOLDER/result.npz; `files` are written there first.

    Raises:
        ExperimentError: the process failed; its last line is told.
    """
    with tempfile.TemporaryDirectory() as folder:
        for name, write in files.items():
            write(Path(folder) / name)
        command = [sys.executable, "-m", module, folder, *map(str, words)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).resolve().parents[2])
        if done.returncode:
            last = (done.stderr.strip() or "no reason given").splitlines()[-1]
            raise ExperimentError(f"deferred imitation failed: {last}")
        with np.load(Path(folder) / RESULT, allow_pickle=False) as stored:
            return dict(stored)
