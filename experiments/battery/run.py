"""Every stage of the chapter, one growing mind each, populations beside infants (chapter, sections 3.4 and 4)."""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from experiments.battery.faces import Ward, bank, faces, looks
from experiments.battery.figures import figures
from experiments.battery.found import Battery, told
from experiments.battery.life import Life, adult
from experiments.battery.options import Config
from experiments.battery.parameters import FEW_THINGS, QUICK, THINGS, Parameters
from experiments.battery.shards import Shard, lived
from experiments.battery.table import files, tidy
from experiments.battery.vary import designs, parse
from experiments.shared.experiment import Result
from experiments.shared.parallel import in_parallel
from experiments.shared.tables import table

ADULTS = 2
"""Whom agents watch, in turn."""
ADULT_SEEDS = 900_000
"""From here on adults are numbered."""
WARD = 20
"""Newborns whose faces are raised side by side."""


def run(config: Config) -> Result:
    """Adults first, then faces and lives, whoever is ready; table, verdicts, figures."""
    config.check()
    began = time.perf_counter()
    base = QUICK if config.quick else Parameters()
    varied = parse(config.vary, Parameters)
    cells = designs(varied, base, config.population)
    things = FEW_THINGS if config.quick else THINGS
    lives = [Life(one.agent, 1000 * config.seed + one.block, one.parameters, things) for one in cells]
    many = partial(in_parallel, workers=config.workers)
    grown_up = [Life(ADULT_SEEDS + n, ADULT_SEEDS + 1000 * config.seed + n, base, things) for n in range(ADULTS)]
    adults = many(adult, grown_up, doing="adults grow up") if "objects" in config.stages else []
    trials, shards = [], len(adults)
    if "face" in config.stages:
        seen = tuple(
            look for some in many(bank, looks(config.seed), doing="an adult's face is filmed") for look in some
        )
        newborn = _alike(lives, lambda life: (life.how.face_acts, life.seed))
        wards = [Ward(some, seen) for some in _wards([some[0] for some in newborn.values()])]
        for row in (row for some in many(faces, wards, doing="faces") for row in some):
            alike = newborn[lives[row.agent].how.face_acts, row.seed]
            trials += [replace(row, agent=life.agent) for life in alike]
        shards += len(wards)
    if stages := tuple(stage for stage in config.stages if stage != "face"):
        tasks = [
            Shard(tuple(some), adults[some[0].seed % len(adults)] if adults else None, stages)
            for some in _alike(lives, lambda life: life.childhood).values()
        ]
        trials += [row for some in many(lived, tasks, doing="lives") for row in some]
        shards += len(tasks)
    frame = tidy(trials, {one.agent: one.factors for one in cells} if varied else None)
    done = Battery(config, frame, tuple(varied), (), shards, time.perf_counter() - began)
    return Result(done.metrics, summarise(done), figures(done), None, files(frame))


def _alike(lives: list[Life], key: Callable[[Life], tuple[object, ...]]) -> dict[tuple[object, ...], list[Life]]:
    """Lives by what they share."""
    found = dict[tuple[object, ...], list[Life]]()
    for life in lives:
        found.setdefault(key(life), []).append(life)
    return found


def _wards(lives: list[Life]) -> list[tuple[Life, ...]]:
    """Those of one length of babbling side by side."""
    alike = _alike(lives, lambda life: (life.how.face_acts,)).values()
    return [tuple(some[n : n + WARD]) for some in alike for n in range(0, len(some), WARD)]


def summarise(done: Battery) -> str:
    """For people: verdicts."""
    rows = []
    for one in map(told, done.rows):
        low_high = one["interval"]
        found = "-" if low_high is None else f"{one['simulated']:.2f} ({low_high[0]:.2f} to {low_high[1]:.2f})"
        said = one["published"] if isinstance(one["published"], str) else f"{one['published'][0]:.2f}"
        rows.append((one["task"], found, said, f"{one['study']} ({one['status']})", one["verdict"]))
    heads = ("what", "agents (95 %)", "infants", "study (status)", "verdict")
    return f"# The battery: {done.metrics['agents']} agents, {len(done.frame)} trials\n\n{table(rows, heads)}"
