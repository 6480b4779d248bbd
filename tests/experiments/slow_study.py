"""A study of tasks that take a while, in a process of its own, to be killed: see `test_kept.py`."""

import random
import time
from pathlib import Path

from experiments.shared.kept import keeping
from experiments.shared.parallel import in_parallel

TASKS = 6


def slowly(number: int) -> list[float]:
    """A task, noted in a file where it is really done; some take long."""
    with Path("done.txt").open("a") as note:
        note.write(f"{number}\n")
    time.sleep(0.4 if number % 2 else 0.05)
    return [random.Random(number).gauss() for _ in range(3)]


def study() -> list[list[float]]:
    """All of them, two at a time."""
    return in_parallel(slowly, range(TASKS), 2, "slowly")


if __name__ == "__main__":
    with keeping(Path("parts")):
        found = study()
    Path("found.txt").write_text(repr(found))
