"""Small shards, as studies deal them: see `test_shards.py`."""

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from babbling.axes import FloatArray


@dataclass(frozen=True)
class Shard:
    """Notes in a folder where it is really done; takes a while; may have its worker killed, or fail."""

    seed: int
    notes: Path
    takes_s: float = 0.0
    deaths: int = 0
    """How many of its first tries end in death."""
    fails: bool = False

    @property
    def label(self) -> str:
        return f"seed {self.seed}"

    @property
    def alone(self) -> str:
        return f"imitate it --seed {self.seed}"


@dataclass(frozen=True)
class Drawn:
    """What one shard finds."""

    seed: int
    numbers: FloatArray


def draw(shard: Shard) -> Drawn:
    """A few numbers that depend on the seed alone."""
    with (shard.notes / f"{shard.seed}").open("a") as note:
        note.write(f"{os.getpid()}\n")
    time.sleep(shard.takes_s)
    if len(done(shard)) <= shard.deaths:
        os.kill(os.getpid(), signal.SIGKILL)
    if shard.fails:
        raise KeyError(shard.seed)
    return Drawn(shard.seed, np.random.default_rng(shard.seed).normal(size=(3, 2)))


def done(shard: Shard) -> list[int]:
    """The processes that did it, or tried."""
    note = shard.notes / f"{shard.seed}"
    return [int(pid) for pid in note.read_text().split()] if note.exists() else []
