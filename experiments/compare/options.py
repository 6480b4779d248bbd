"""Options of `imitate compare`."""

from pathlib import Path
from typing import Annotated

import tyro

from experiments.shared.options import Options, options, written


@options
class Config(Options):
    """Options of `imitate compare`."""

    runs: Annotated[tuple[Path, ...], tyro.conf.Positional, written("DIR DIR ...", "")] = ()
    """Folders that earlier runs left, two to twelve."""
