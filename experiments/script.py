"""Every experiment is a script of its own: `python -m experiments.NAME` does what `imitate NAME` does."""

import sys


def script(name: str) -> int:
    """Run the experiment of this name with the words of the command line; returns the exit status."""
    from experiments.__main__ import main  # at the end of a module: the command line imports experiments

    return main([name, *sys.argv[1:]])
