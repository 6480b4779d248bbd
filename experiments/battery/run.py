"""Every stage of the chapter, one growing mind each, populations beside infants (chapter, sections 3.4 and 4)."""

import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from experiments.battery.chapters import beside_infants, words
from experiments.battery.faces import Ward, bank, faces, looks
from experiments.battery.figures import figures
from experiments.battery.found import Battery
from experiments.battery.life import Adult, Life, adult
from experiments.battery.options import Config
from experiments.battery.parameters import FEW_THINGS, QUICK, THINGS, Parameters
from experiments.battery.shards import Shard, lived
from experiments.battery.table import files, tidy
from experiments.battery.vary import designs, parse
from experiments.errors import ExperimentError
from experiments.face.watching import Look
from experiments.shared.dealing import Failure
from experiments.shared.experiment import Result
from experiments.shared.parallel import attempted, succeeded

ADULTS = 2
"""Whom agents watch, in turn."""
ADULT_SEEDS = 900_000
"""From here on adults are numbered."""
WARD = 20
"""Newborns whose faces are raised side by side."""


def run(config: Config) -> Result:
    """Adults first, then faces and lives, whoever is ready; table, verdicts, figures.

    Raises:
        ExperimentError: nobody could be watched, or nobody lived.
    """
    config.check()
    began = time.perf_counter()
    base = QUICK if config.quick else Parameters()
    varied = parse(config.vary, Parameters)
    cells = designs(varied, base, config.population)
    things = FEW_THINGS if config.quick else THINGS
    lives = [Life(one.agent, 1000 * config.seed + one.block, one.parameters, things) for one in cells]
    tasks = partial(_tasks, config, lives if config.only is None else [_only(lives, config.only)])
    many = partial(attempted, workers=config.workers, scheduler=config.scheduler)
    grown_up = [Life(ADULT_SEEDS + n, ADULT_SEEDS + 1000 * config.seed + n, base, things) for n in range(ADULTS)]
    adults = succeeded(many(adult, grown_up, doing="adults grow up")) if "objects" in config.stages else []
    filmed = succeeded(many(bank, looks(config.seed), doing="a face is filmed")) if "face" in config.stages else []
    wards, shards = tasks(tuple(look for some in filmed for look in some), adults)
    done = [*many(faces, wards, doing="faces"), *many(lived, shards, doing="lives")]
    failed = tuple(str(one) for one in done if isinstance(one, Failure))
    rows = [row for some in done if not isinstance(some, Failure) for row in some]
    if not rows:
        raise ExperimentError(f"nobody lived: {' | '.join(failed)}")
    frame = tidy(rows, {one.agent: one.factors for one in cells} if varied else None)
    took_s, count = time.perf_counter() - began, len(adults) + len(filmed) + len(wards) + len(shards)
    battery = Battery(config, frame, tuple(varied), failed, count, took_s)
    drawn = figures(battery) if config.only is None else {}
    return Result(battery.metrics, summarise(battery), drawn, None, files(frame), words(battery), failed)


def _only(lives: list[Life], agent: int) -> Life:
    if agent >= len(lives):
        raise ExperimentError(f"--only {agent}: there are {len(lives)} agents, counted from 0")
    return lives[agent]


def _tasks(
    config: Config, lives: list[Life], seen: tuple[Look, ...], adults: list[Adult]
) -> tuple[list[Ward], list[Shard]]:
    """Wards of newborns' faces, and lives: whatever a number does not depend on, it has in common with others."""
    wards, shards = list[Ward](), list[Shard]()
    if "face" in config.stages:
        newborn = list(_alike(lives, lambda life: (life.how.face_acts, life.seed)).values())
        for group in _alike(newborn, lambda some: (some[0].how.face_acts,)).values():
            wards += [Ward(tuple(map(tuple, group[n : n + WARD])), seen) for n in range(0, len(group), WARD)]
    if stages := tuple(stage for stage in config.stages if stage != "face"):
        for some in _alike(lives, lambda life: life.childhood).values():
            watched = adults[some[0].seed % len(adults)] if adults else None
            asked = " ".join(["--quick"] * config.quick + ["--vary", *config.vary] * bool(config.vary))
            alone = f"imitate battery {asked} --agents {config.population} --seed {config.seed} --only {some[0].agent}"
            shards.append(Shard(tuple(some), watched, stages, " ".join(alone.split())))
    return wards, shards


def _alike(many: Sequence[Any], key: Callable[[Any], tuple[object, ...]]) -> dict[tuple[object, ...], list[Any]]:
    """By what they share."""
    found = dict[tuple[object, ...], list[Any]]()
    for one in many:
        found.setdefault(key(one), []).append(one)
    return found


def summarise(done: Battery) -> str:
    """For people: verdicts."""
    shown = [row for row in done.rows if row.simulated is not None]
    title = f"# The battery: {done.metrics['agents']} agents, {len(done.frame)} trials"
    return f"{title}\n\n{beside_infants(shown)}"
