"""`python -m experiments.benchmark.shards`: what dealing shards costs, and what that means for many of them.

Shards here wait (whoever else uses the machine makes no difference) or reckon (they do), and find as many bytes as an
agent is taken to find. Waiting for processes and libraries to load is told apart: `start_s`.
"""

import math
import os
import pickle
import resource
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import tyro

from babbling.errors import BabblingError
from babbling.whole import whole
from experiments.shared.experiment import as_json, writing
from experiments.shared.options import LOCAL, obey_all, within
from experiments.shared.parallel import in_parallel
from experiments.shared.tables import show, table

EMPTY = 200
"""Shards that do nothing, by which the overhead of one is measured."""
WIRE_BYTES_S = 100e6
"""Of the client's network, where it is extrapolated: a gigabit, less what goes beside."""


@dataclass(frozen=True)
class Config:
    """Options of the bench."""

    workers: Annotated[int, within(2, 256)] = 2
    """Processes."""
    shards: Annotated[int, within(2, 100_000)] = 20
    """How many wait, and how many reckon."""
    takes_s: Annotated[float, within(0, 3600, above=True)] = 0.5
    """Of each."""
    kilobytes: Annotated[int, within(0, 1_000_000)] = 100
    """That each finds."""
    agents: Annotated[int, within(1, 1_000_000_000)] = 10_000
    """To extrapolate to."""
    cores: Annotated[int, within(1, 1_000_000)] = 1000
    """To extrapolate to."""
    agent_s: Annotated[float, within(0, 1e7, above=True)] = 600.0
    """Of one agent on one core, to extrapolate to."""
    out: Path = Path("runs/shards.json")
    """The file of numbers."""


class Shard(NamedTuple):
    """Waits, or reckons, and finds so many bytes."""

    takes_s: float
    reckons: bool
    size: int


class Did(NamedTuple):
    """What one shard was."""

    process: int
    began: float
    """s since the epoch."""
    ended: float
    took_s: float
    """Of the processor where it reckons, of time where it waits."""
    memory_mb: float
    """Most that its process has had so far."""
    found: bytes


def do(shard: Shard) -> Did:
    """Do it."""
    began = time.time()
    spent = time.process_time if shard.reckons else time.monotonic
    start = spent()
    if shard.reckons:
        while spent() - start < shard.takes_s:
            math.fsum(range(1000))
    else:
        time.sleep(shard.takes_s)
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 << 20 if sys.platform == "darwin" else 1 << 10)
    return Did(os.getpid(), began, time.time(), spent() - start, most, bytes(shard.size))


class Cost(NamedTuple):
    """Of a run of shards."""

    start_s: float
    """Until the first began."""
    wall_s: float
    """From then on, until all results were there."""
    efficiency: float
    """Time of the shards over time of the workers, since all of these had loaded."""
    memory_mb: float
    wire_bytes: float
    """Over the loopback, whoever sent them."""


def cost(workers: int, scheduler: str | None, count: int, shard: Shard) -> Cost:
    """Of so many such shards."""
    before, asked = _wire(), time.time()
    done = in_parallel(do, [shard] * count, workers, "shards", scheduler)
    end, began, sent = time.time(), min(one.began for one in done), _wire() - before
    loaded = max(min(one.began for one in done if one.process == process) for process in {one.process for one in done})
    busy = sum(
        one.took_s * max(0.0, one.ended - max(one.began, loaded)) / max(one.ended - one.began, 1e-9) for one in done
    )
    most = max(one.memory_mb for one in done)
    return Cost(began - asked, end - began, busy / (workers * (end - loaded)), most, sent)


def _wire() -> int:
    psutil = import_module("psutil")  # comes with distributed
    return sum(one.bytes_sent for name, one in psutil.net_io_counters(pernic=True).items() if name.startswith("lo"))


def measured(config: Config, scheduler: str | None) -> dict[str, float]:
    """What one way of dealing costs; with processes, bytes are those of the pickles that go through pipes."""
    size, count, workers = config.kilobytes << 10, config.shards, config.workers
    empty, full = (cost(workers, scheduler, EMPTY, Shard(0.0, False, some)) for some in (0, size))
    waits = [cost(w, scheduler, count, Shard(config.takes_s, False, size)) for w in (1, workers)]
    reckons = [cost(w, scheduler, count, Shard(config.takes_s, True, size)) for w in (1, workers)]
    piped = len(pickle.dumps((do, Shard(0.0, False, size)))) + len(pickle.dumps(do(Shard(0.0, False, size))))
    return {
        "start_s": empty.start_s,
        "shard_overhead_ms": 1e3 * empty.wall_s / EMPTY,
        "shard_overhead_with_result_ms": 1e3 * full.wall_s / EMPTY,
        "efficiency_factor": waits[1].efficiency / waits[0].efficiency,
        "efficiency_reckoning_factor": reckons[1].efficiency / reckons[0].efficiency,
        "wire_bytes_per_agent": piped if scheduler is None else full.wire_bytes / EMPTY,
        "peak_memory_mb": max(one.memory_mb for one in (empty, full, *waits, *reckons)),
    }


def extrapolated(
    agents: int, cores: int, agent_s: float, *, shard_overhead_ms: float, wire_bytes_per_agent: float, start_s: float
) -> dict[str, float]:
    """What so many agents take on so many cores, and what share of the cores' time is theirs.

    Law: start + the largest of three times, which overlap: rounds of whole agents, ceil(agents / cores) agent_s; the
    client and the scheduler, one shard after the other, agents x overhead; the client's network, agents x bytes / rate.
    Assumes agents that take equally long, workers that load at once, and an overhead that does not grow with them.
    """
    rounds = math.ceil(agents / cores) * agent_s
    dealing, wire = agents * shard_overhead_ms / 1e3, agents * wire_bytes_per_agent / WIRE_BYTES_S
    wall = start_s + max(rounds, dealing, wire)
    factor = agents * agent_s / (cores * wall)
    return {"wall_s": wall, "rounds_s": rounds, "dealing_s": dealing, "wire_s": wire, "efficiency_factor": factor}


def main(config: Config) -> None:
    """Measure, extrapolate, tell.

    Raises:
        ExperimentError: options that cannot be meant, no such cluster, a file that cannot be written.
    """
    obey_all(config)
    found: dict[str, Any] = {"workers": config.workers, "shards": config.shards}
    for name, scheduler in (("processes", None), ("dask", LOCAL)):
        found[name] = measured(config, scheduler)
        costs = {key: found[name][key] for key in ("shard_overhead_ms", "wire_bytes_per_agent", "start_s")}
        found[name]["extrapolated"] = extrapolated(config.agents, config.cores, config.agent_s, **costs)
    with writing(config.out, "file"), whole(config.out) as beside:
        beside.write_text(as_json(found | {"agents": config.agents, "cores": config.cores, "agent_s": config.agent_s}))
    show(told(config, found))


def told(config: Config, found: Mapping[str, Any]) -> str:
    """The table."""
    ways = ("processes", "dask")
    keys = [key for key in found["dask"] if key != "extrapolated"]
    many = f"{config.agents} agents of {config.agent_s:g} s, {config.cores} cores"
    rows = [(key, *(f"{found[way][key]:.4g}" for way in ways)) for key in keys]
    rows += [(f"{many}: {key}", *(f"{found[way]['extrapolated'][key]:.4g}" for way in ways))
             for key in found["dask"]["extrapolated"]]  # fmt: skip
    return table(rows, (f"{config.workers} workers", *ways))


if __name__ == "__main__":
    try:
        main(tyro.cli(Config, description=__doc__))
    except BabblingError as fault:
        sys.exit(f"shards: {fault}")
