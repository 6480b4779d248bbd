"""Two processes find what one finds: a file of its own, since what is made hasty in one process is not in another."""

from pathlib import Path

import numpy as np

from experiments.benchmark.lives import Task, live
from experiments.shared.parallel import in_parallel


def test_two_processes_find_what_one_finds(arm: Path) -> None:
    clips = {"still": np.zeros((5, 3))}
    tasks = [Task(str(arm), seed, clips, ("replay", "forward_line"), (0.1,)) for seed in range(2)]
    one, two = (in_parallel(live, tasks, workers, "living") for workers in (1, 2))
    assert [[p.errors for p in life] for life in one] == [[p.errors for p in life] for life in two]
    assert one[0][0].errors != one[1][0].errors
