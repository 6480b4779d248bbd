"""Markdown tables, how they reach the terminal, and how what was left is opened."""

import os
import shlex
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from shutil import which

from rich.console import Console
from rich.markdown import Markdown


def table(rows: Iterable[Sequence[object]], header: Sequence[object] = ("what", "result")) -> str:
    """Rows of cells under a header."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def show(markdown: str) -> None:
    """Print for people."""
    Console().print(Markdown(markdown))


def opened(out: Path) -> str:
    """What was left in a folder, and in the last line how to open it."""
    names = sorted(path.name for path in out.iterdir())
    beside = Path(sys.executable).with_name("rerun")
    rerun = "rerun" if which("rerun") or not beside.exists() else shlex.quote(os.path.relpath(beside))
    ways = [f"{rerun} {shlex.quote(str(out / name))}" for name in names if name == "recording.rrd"]
    ways += [f"{shlex.quote(str(out / name))} in a browser" for name in names if name == "report.html"]
    return f"written to {out}: {', '.join(names)}\nto open it: {'; '.join(ways)}"
