"""Small shards, as studies deal them: see `test_shards.py`."""

import os
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import psutil

from babbling.axes import FloatArray
from experiments.shared.kept import keeping
from experiments.shared.parallel import in_parallel


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


def meet(shard: Shard) -> int:
    """The process that does it, which waits until another does one too."""
    (shard.notes / f"process-{os.getpid()}").touch()
    until = time.monotonic() + 100
    while len(list(shard.notes.glob("process-*"))) < 2 and time.monotonic() < until:
        time.sleep(0.02)
    return os.getpid()


def listening(shard: Shard) -> list[str]:
    """Addresses of this machine at which the process that does it can be reached."""
    return sorted({one.laddr.ip for one in psutil.Process().net_connections("tcp") if one.status == "LISTEN"})


if __name__ == "__main__":  # a client, to be killed
    address, notes, count, takes_s = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
    from tests.experiments import shards

    with keeping(notes / "parts"):
        in_parallel(shards.draw, [shards.Shard(n, notes, takes_s) for n in range(count)], 2, "drawing", address)
