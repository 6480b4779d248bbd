"""What every experiment is: a configuration, a run, and what it leaves behind.

An experiment is a folder of this package with `options.py` (a dataclass `Config`, light to load), `run.py` (a function
`run(config) -> Result`), and an entry in `experiments.registry.EXPERIMENTS`.
"""

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from babbling.errors import BabblingError
from babbling.files import is_kind
from babbling.whole import sweep, try_place, whole
from experiments.errors import ExperimentError
from experiments.shared.options import Options
from experiments.shared.progress import progress
from experiments.shared.provenance import MAKES_NO_DIFFERENCE, provenance
from experiments.shared.report import drawn, page
from experiments.stopping import say
from models.files import text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Result:
    """What a run found, before anything is written."""

    metrics: dict[str, Any]
    """Numbers, by name; keys that end in _s, _ms, _factor or _mb may differ between runs."""
    summary: str
    """Markdown: the result as a table, for the terminal and the recording."""
    figures: Mapping[str, "Figure"] = field(default_factory=dict)
    """File stem -> figure."""
    record: Callable[[Path], None] | None = None
    """Writes the recording to the path it is given."""
    files: Mapping[str, Callable[[Path], None]] = field(default_factory=dict)
    """Further files: name -> writer."""
    words: Mapping[str, str] = field(default_factory=dict)
    """Markdown that stands before a figure in the report, by its file stem."""
    failed: tuple[str, ...] = ()
    """What came to nothing while all else went on, a line each."""


class Described(NamedTuple):
    """What a recording says of the run that made it."""

    identity: str
    """The same for the same experiment and options alone: two runs that differ in any stay apart in one viewer."""
    properties: Mapping[str, Mapping[str, Any]]
    """Options and single numbers, by section and name."""


RUN: ContextVar[Described | None] = ContextVar("RUN", default=None)
"""Whose recording is being written."""
LARGEST_NOTES = 1 << 20


def publish(name: str, config: Options, result: Result) -> Path:
    """Write config.json, metrics.json, recording.rrd and figures; everything appears at once, or nothing does.

    An older folder is replaced only once the new one is complete; a folder that holds anything but an older result is
    never touched.

    Raises:
        ExperimentError: the folder cannot be written, or is not one of ours.
    """
    shown = folder(name, config)
    check_out(shown)
    with writing(shown), whole(shown.resolve()) as beside, progress("drawing and writing") as report:
        beside.mkdir()
        try:
            (beside / "metrics.json").write_text(as_json(result.metrics))
            for number, (stem, figure) in enumerate(result.figures.items(), 1):
                (beside / f"{stem}.png").write_bytes(drawn(figure))
                report(0.5 * number / len(result.figures))
            for file, write in result.files.items():
                write(beside / file)
            told = provenance(name, config)
            if result.record is not None:
                copy_context().run(_recorded, result.record, beside / "recording.rrd", told, result.metrics)
            report(0.7)
            html = page(name, config, result.summary, result.figures, beside, told, result.words)
            (beside / "report.html").write_text(html, encoding="utf-8")
        except BabblingError as error:  # a writer's, of a place that nobody knows
            raise ExperimentError(str(error).replace(str(beside), str(shown))) from error
        files = sorted(["config.json", *(file.name for file in beside.iterdir())])
        (beside / "config.json").write_text(as_json({**told, "files": files}))
    return shown


def _recorded(record: Callable[[Path], None], path: Path, told: Mapping[str, Any], metrics: Mapping[str, Any]) -> None:
    options = {key: value for key, value in told["options"].items() if key not in MAKES_NO_DIFFERENCE}
    digest = hashlib.sha256(as_json([told["experiment"], options]).encode()).hexdigest()[:12]
    asked = {key: str(value) for key, value in options.items()}  # Rerun wants one type of a name, whatever the section
    numbers = {
        key: float(value) for key, value in metrics.items() if isinstance(value, float | int) and key not in asked
    }
    RUN.set(Described(f"{told['experiment']}-{digest}", {"options": asked, "metrics": numbers}))
    record(path)


def folder(name: str, config: Options) -> Path:
    """Where the results go."""
    return Path(config.out) if config.out is not None else Path("runs") / name


def check_out(out: Path) -> None:
    """Refuse early what `publish` could not write.

    Raises:
        ExperimentError: see `publish`.
    """
    with writing(out):
        have_back(out)
        if out.exists() and not out.is_dir():
            raise ExperimentError(f"--out {out}: this is a file; name a folder")
        if out.exists() and os.path.ismount(out):
            raise ExperimentError(f"--out {out}: this is a whole disk or mount; name a folder in it")
        strangers = _strangers(out) if out.exists() else []
        if strangers:
            raise ExperimentError(
                f"--out {out}: this folder holds other things than a result ({strangers[0]!r}); name another"
            )
        try_place(out)


@contextmanager
def writing(out: Path, kind: str = "folder") -> Iterator[None]:
    """A block in which `out` is looked at or written.

    Raises:
        ExperimentError: it cannot be.
    """
    try:
        yield
    except OSError as error:
        why = error.strerror or error
        raise ExperimentError(f"--out {out}: cannot be written ({why}); name a {kind} that can") from error


def have_back(out: Path) -> None:
    """Sweep what dead processes left of writing `out`, and say so where that brought back an older result.

    Raises:
        ExperimentError: its name has letters that not all libraries could write here.
    """
    try:
        str(out.absolute()).encode()
    except UnicodeEncodeError as error:
        raise ExperimentError(
            f"--out {out}: this name is not text in this locale; set PYTHONUTF8=1, or choose a plainer name"
        ) from error
    if sweep(out.absolute().resolve()):
        say(f"{out}: whoever was replacing this was killed; the older result is back")


def check_file(out: Path, holds: type, what: str, beside: Sequence[Path] = (), *, new: bool = False) -> None:
    """Refuse early a file that could not be written, or should not be overwritten.

    Args:
        out: the file.
        holds: the kind of thing that it may hold already.
        what: its name, for people.
        beside: files that are left beside it.
        new: whether it may not be there at all.

    Raises:
        ExperimentError: a directory, another kind of file, strangers beside it, a place that cannot be written.
    """
    with writing(out, "file"):
        have_back(out)
        if out.is_dir():
            raise ExperimentError(f"--out {out}: this is a directory; name a file such as {out / 'learned.nc'}")
        if out.suffix != ".nc":
            raise ExperimentError(f"--out {out}: a {what}'s file ends in .nc; name it {out.stem or 'learned'}.nc")
        if out.exists() and (new or not is_kind(out, holds)):
            said = "is there already" if new else f"is no {what}"
            raise ExperimentError(f"{out}: this {said} and would be lost; choose another name")
        if not out.exists() and (taken := [file.name for file in beside if file.exists()]):
            raise ExperimentError(f"--out {out}: {taken[0]} is there already and would be lost; choose another name")
        try_place(out)


def _strangers(out: Path) -> list[str]:
    """Names in a folder that no earlier result put there."""
    found = sorted(entry.name for entry in out.iterdir())
    notes = out / "config.json"
    try:
        listed = json.loads(text(notes, LARGEST_NOTES))["files"]
        ours = set(listed) if all(isinstance(file, str) for file in listed) else set()
    except (ValueError, KeyError, TypeError, RecursionError):  # BodyError among them
        ours = set()
    return [name for name in found if name not in ours or (out / name).is_dir()]


def as_json(value: Any) -> str:
    """Readable JSON of numbers, NumPy arrays and paths; refuses NaN and infinity."""

    def plain(x: Any) -> Any:
        return x.tolist() if hasattr(x, "tolist") else str(x)

    return json.dumps(value, indent=2, allow_nan=False, default=plain) + "\n"
