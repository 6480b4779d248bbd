"""A recording inside a notebook."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from experiments.shared.experiment import Result


def inline(found: Result, height: int = 600) -> Any:
    """The recording of a result in Rerun's viewer, to be the last value of a cell; a line where it is not installed.

    The viewer's parts come from the address that the environment variable RERUN_NOTEBOOK_ASSET names, unless it is set
    before the first call from the maker's; "serve-local" is this machine.
    """
    if find_spec("rerun_notebook") is None:
        return "no viewer here: pip install 'imitation-laboratory[notebook]', or open the recording.rrd of a run"
    if found.record is None:
        return "this result has no recording"
    with TemporaryDirectory() as folder:
        path = Path(folder) / "recording.rrd"
        found.record(path)
        viewer = import_module("rerun_notebook").Viewer(width="auto", height=height)
        viewer.send_rrd(path.read_bytes())
    return viewer
