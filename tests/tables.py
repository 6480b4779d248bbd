"""Tables of trials as files."""

from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from experiments.battery.table import files


def write(frame: pd.DataFrame, folder: Path, factors: Mapping[str, str] | None = None) -> None:
    """All that a battery leaves of a table, into a folder that is there."""
    for name, writer in files(frame, factors).items():
        writer(folder / name)
