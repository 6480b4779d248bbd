"""What the command line does: `imitate NAME [options]`, `list`, `--help`, `--version`, `--completion SHELL`."""

import io
import os
import re
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from functools import partial
from importlib.metadata import version
from itertools import groupby
from pathlib import Path
from shutil import get_terminal_size
from textwrap import fill
from types import ModuleType
from typing import TYPE_CHECKING

from babbling.errors import BabblingError
from experiments.errors import ExperimentError, UnfinishedError
from experiments.registry import EXPERIMENTS, Entry, entry
from experiments.stopping import say, work
from models.errors import BodyError

if TYPE_CHECKING:
    from experiments.shared.options import Options

NARROWEST = 40
"""Columns of a terminal that help is made for."""
USAGE = """usage: imitate NAME [options] | imitate list | imitate NAME --help | imitate --version
       eval "$(imitate --completion bash)" completes names and options (zsh: the same)"""


def obey(words: list[str]) -> int:
    """Run one experiment; the exit status is 0, 1 where a part failed, or 2 for what the user can mend."""
    try:
        alone = words[:1] in (["-h"], ["--help"], ["list"], ["--version"])
        if alone and words[1:]:
            raise ExperimentError(f"{words[0]} {' '.join(words[1:])}: nothing goes with {words[0]}; leave the rest out")
        if not words or words[0] in ("-h", "--help", "list"):
            listing(full=not words or words[0] != "list")
            return 0
        if words[0] in ("--version", "--completion"):
            print(about() if words[0] == "--version" else completion(words[1:]), end="")
            return 0
        return run(words[0], words[1:])
    except (BabblingError, BodyError) as error:
        say(" ".join(str(error).split()))
        return 1 if isinstance(error, UnfinishedError) else 2


def about() -> str:
    """Version, and commit where there is one."""
    from experiments.shared.provenance import commit

    where = commit()
    return f"imitate {version('imitation-laboratory')}{f' ({where})' if where else ''}\n"


def completion(words: list[str]) -> str:
    """The script that completes names and options in a shell."""
    from experiments.completion import script

    return script(" ".join(words) or "bash")


def listing(*, full: bool) -> None:
    """Every experiment with its line, under the stage it belongs to, and what options may name."""
    from models.robots import ROBOTS
    from models.teachers.demonstrations import DEMONSTRATIONS

    if full:
        print(USAGE + "\n")
    width, columns = max(map(len, EXPERIMENTS)), get_terminal_size().columns
    for stage, group in groupby(EXPERIMENTS.items(), lambda one: one[1].stage):
        print(stage)
        for name, one in group:
            print(fill(f"  {name:<{width}}  {one.line}", columns, subsequent_indent=" " * (width + 4)))
    print()
    for what, names in (("Robots", ROBOTS), ("Demonstrations", DEMONSTRATIONS)):
        print(fill(f"{what}: {', '.join(names)}; or a file", columns, subsequent_indent="    ", break_on_hyphens=False))


def run(name: str, words: list[str]) -> int:
    """Parse options and do it, in silence where that is wanted; the exit status."""
    one = entry(name)
    config = parse(one.options(), name, words)
    if config is None:
        return 0
    config.check()
    with ExitStack() as silence:
        if config.quiet:
            nowhere = silence.enter_context(open(os.devnull, "w"))
            silence.enter_context(redirect_stdout(nowhere))
            silence.enter_context(redirect_stderr(nowhere))
        out = do(one, name, config)
    if config.quiet:
        print(out)
    return 0


def do(one: Entry, name: str, config: "Options") -> Path:
    """Run, publish, show; where the results are."""
    module = load(one, config)
    from experiments.shared.experiment import check_out, folder, publish
    from experiments.shared.kept import studying
    from experiments.shared.tables import opened, show

    work()
    if hasattr(module, "command"):  # an experiment that leaves something else than a folder of results
        left: Path = module.command(config)
        return left
    check_out(folder(name, config))
    with studying(config, folder(name, config)):
        result = module.run(config)
        out = publish(name, config, result)
        show(result.summary)
        print("\n" + opened(out))
        if result.failed:  # what succeeded is kept for the next time
            failed = f"{len(result.failed)} failed: {' | '.join(result.failed)}"
            raise UnfinishedError(f"{out} holds what succeeded; {failed}; said again, only these are done again")
    return out


def load(one: Entry, config: "Options") -> ModuleType:
    """The module that runs it; a graphics library is only looked for where something is rendered.

    Raises:
        ExperimentError: it is not there.
    """
    renders = getattr(config, "renderer", "rays") == "mujoco"
    if not renders:
        os.environ["MUJOCO_GL"] = "disabled"
    try:
        return one.load()
    except (AttributeError, ImportError, RuntimeError) as error:  # what MuJoCo's bindings make of it
        if not renders:
            raise
        library = os.environ["MUJOCO_GL"]
        raise ExperimentError(
            f"--renderer mujoco: MUJOCO_GL={library} cannot be loaded ({str(error)[:100]}); install it, set MUJOCO_GL "
            "to egl or osmesa, whichever is there, or take --renderer rays"
        ) from error


def parse(kind: "type[Options]", name: str, words: list[str]) -> "Options | None":
    """The options as an instance of `kind`; None when only help was wanted.

    Raises:
        ExperimentError: what tyro says in a box, in one line.
    """
    import tyro

    said, one = io.StringIO(), EXPERIMENTS[name]
    if os.environ.get("COLUMNS", "").isdigit() and int(os.environ["COLUMNS"]) < NARROWEST:  # tyro would not end
        os.environ["COLUMNS"] = str(NARROWEST)
    wide = partial(fill, width=get_terminal_size().columns, subsequent_indent="  ")  # tyro keeps breaks before blanks
    marks = (tyro.conf.FlagCreatePairsOff, tyro.conf.DisallowNone)
    try:
        with redirect_stderr(said):
            return tyro.cli(kind, args=words, prog=f"imitate {name}", description=wide(one.line), config=marks)
    except SystemExit as stop:
        if stop.code in (0, None):
            print("\nExample: " + f"imitate {name} {one.example}".rstrip())
            print(f"It takes {one.takes}." if one.takes else "")
            return None
        raise ExperimentError(in_one_line(said.getvalue(), name)) from None


PLAIN = (
    (r"Error parsing (--\S+): invalid literal for int\(\) with base 10: (.*)", r"\1 \2: this is not a whole number"),
    (r"Error parsing (--\S+): could not convert string to float: (.*)", r"\1 \2: this is not a number"),
    (r"Missing value for argument '(--\S+)'.*", r"\1: a value is missing"),
    (r"Unrecognized options?: (.*)", r"unknown option \1"),
)


def in_one_line(box: str, name: str) -> str:
    """The message and the suggestions out of tyro's boxes, which have no sides where letters are ASCII alone."""
    bare = re.sub(r"\x1b\[[0-9;]*m", "", box).replace("─", "-").splitlines()[1:]
    lines = [line.strip("│ ") for line in bare if line[:1] != "╰"]
    parts = [
        " ".join(part.split())
        for part in re.split(r"\n-{20,}\n", "\n".join(lines).removeprefix("-" * 20).lstrip("-\n"))
    ]
    message = parts[0] or "these options cannot be understood"
    for pattern, plain in PLAIN:
        message = re.sub(f"^{pattern}$", plain, message)
    meant = re.findall(r"(?<!\S)--[a-z][a-z-]*", " ".join(p for p in parts[1:] if p.startswith("Perhaps you meant")))
    hint = f"; did you mean {' or '.join(dict.fromkeys(meant))}?" if meant else ""
    return f"{message}{hint}; `imitate {name} --help` lists what there is"
