"""The command line: `imitate NAME [options]`, `imitate list`, `imitate --help`."""

import os
import sys

from rich.console import Console
from rich.markdown import Markdown

from babbling.errors import BabblingError
from experiments.registry import EXPERIMENTS, entry
from models.errors import BodyError

USAGE = "usage: imitate NAME [options] | imitate list | imitate NAME --help"


def main(arguments: list[str] | None = None) -> int:
    """Run one experiment; the exit status is 0, 2 for what the user can mend, 130 when interrupted."""
    words = sys.argv[1:] if arguments is None else arguments
    os.environ.setdefault("MUJOCO_GL", "disabled")  # dm_control must not look for a display
    try:
        if not words or words[0] in ("-h", "--help", "list"):
            listing(full=not words or words[0] != "list")
            return 0
        return run(words[0], words[1:])
    except (BabblingError, BodyError) as error:
        print(f"imitate: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("imitate: interrupted; nothing half done was left behind", file=sys.stderr)
        return 130


def listing(*, full: bool) -> None:
    """Every experiment with its line."""
    if full:
        print(USAGE + "\n")
    width = max(map(len, EXPERIMENTS))
    for name, one in EXPERIMENTS.items():
        print(f"  {name:<{width}}  {one.line}")


def run(name: str, words: list[str]) -> int:
    """Parse options, run, publish, show."""
    import tyro

    from experiments.experiment import check_out, publish

    module = entry(name).load()
    try:
        config = tyro.cli(module.Config, args=words, prog=f"imitate {name}", description=EXPERIMENTS[name].line)
    except SystemExit as stop:
        return 0 if stop.code in (0, None) else 2
    if hasattr(module, "command"):  # an experiment that leaves something else than a folder of results
        module.command(config)
        return 0
    if config.out is not None:
        check_out(config.out)
    result = module.run(config)
    out = publish(name, config, result)
    Console().print(Markdown(result.summary))
    print(f"\nwritten to {out}: " + ", ".join(sorted(p.name for p in out.iterdir())))
    return 0


if __name__ == "__main__":
    sys.exit(main())
