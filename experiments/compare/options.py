"""Options of `imitate compare`."""

from pathlib import Path
from typing import Annotated

import tyro

from experiments.shared.options import Options, options


@options
class Config(Options):
    """Options of `imitate compare`."""

    runs: Annotated[tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="RUN RUN ...")] = ()
    """Folders that earlier runs left, two to twelve."""
