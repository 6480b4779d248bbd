"""Every stage of the chapter, one growing mind each, populations beside infants (chapter, sections 3.4 and 4)."""

import os
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from experiments.battery.chapters import beside_infants, words
from experiments.battery.faces import WARD, Ward, bank, faces, looks
from experiments.battery.figures import figures
from experiments.battery.films import Camera, Film
from experiments.battery.found import Battery
from experiments.battery.life import Adult, Life, adult
from experiments.battery.options import Config
from experiments.battery.parameters import FEW_THINGS, THINGS, Parameters
from experiments.battery.shards import Shard, lived
from experiments.battery.table import Trial, comma, files, tidy
from experiments.battery.vary import designs
from experiments.errors import ExperimentError
from experiments.face.watching import Look
from experiments.shared.dealing import Failure
from experiments.shared.experiment import Result
from experiments.shared.explained import explained
from experiments.shared.parallel import attempted, succeeded

ADULTS, ADULT_SEEDS = 2, 900_000
"""Whom agents watch, in turn; their seeds, from that of the first agent on."""
BETWEEN, SEEDS = 1_000_000, 4000
"""Seeds of agents from one run's --seed to the next's; larger ones begin anew."""


def run(config: Config) -> Result:
    """Adults first, then faces and lives, whoever is ready; table, verdicts, figures.

    Raises:
        ExperimentError: nobody could be watched, or nobody lived.
    """
    config.check()
    began, worked, base = time.perf_counter(), _worked_s(), config.parameters
    first = BETWEEN * (config.seed % SEEDS)
    varied = config.varied
    cells = designs(varied, base, config.population, one_by_one=config.one_by_one)
    things = () if "objects" not in config.stages else FEW_THINGS if config.quick else THINGS
    lives = [Life(one.agent, first + one.block, one.parameters, things) for one in cells]
    if config.only is not None and config.only >= len(lives):
        raise ExperimentError(f"--only {config.only}: there are {len(lives)} agents, counted from 0")
    asked = lives if config.only is None else [lives[config.only]]
    many = partial(attempted, workers=config.workers, scheduler=config.scheduler)
    grown_up = [Life(ADULT_SEEDS + n, first + ADULT_SEEDS + n, base, things) for n in range(ADULTS)]
    grow_up = partial(adult, filmed=grown_up[0] if config.films else None)
    adults = many(grow_up, grown_up, doing="adults grow up") if "objects" in config.stages else []
    filmed = succeeded(many(bank, looks(config.seed), doing="a face is filmed")) if "face" in config.stages else []
    whole = [one for one in adults if not isinstance(one, Failure)]
    stages = [stage for stage in config.stages if stage != "objects" or len(whole) == len(adults)]
    seen = tuple(look for some in filmed for look in some)
    wards, shards = tasks(stages, asked, seen, [replace(one, films={}) for one in whole])
    everything: list[Ward | Shard] = [*wards, *shards]
    to_do = [replace(one, filmed=config.films and _first(one) is lives[0]) for one in everything]
    done = attempted(met, to_do, config.workers, "faces and lives", config.scheduler)
    failed = [str(one) for one in adults if isinstance(one, Failure)]
    ended = zip(map(_first, to_do), done, strict=True)
    failed += [f"{one}; alone: {alone(config, life)}" for life, one in ended if isinstance(one, Failure)]
    there = [one for one in done if not isinstance(one, Failure)]
    rows = [row for one in there for row in one.rows]
    if not rows:
        raise ExperimentError(f"nobody lived: {' | '.join(failed)}")
    frame = tidy(rows, {one.agent: one.factors for one in cells} if varied else None)
    took_s, count = time.perf_counter() - began, len(adults) + len(filmed) + len(wards) + len(shards)
    busy_s = _worked_s() - worked if config.scheduler is None else None
    battery = Battery(config, frame, tuple(failed), count, took_s, busy_s)
    drawn = figures(battery) if config.only is None else {}
    written = files(frame, explained(Parameters)) | {"effects.csv": lambda path: comma(battery.effects, path)}
    films = [*(one.films for one in whole), *(one.films for one in there)]
    written |= {f"film-{name}.gif": partial(_write, film) for some in films for name, film in some.items()}
    return Result(battery.metrics, summarise(battery), drawn, None, written, words(battery), tuple(failed))


class Met(NamedTuple):
    """What newborns did, or all that agents of one childhood did."""

    rows: list[Trial]
    films: dict[str, Film]


def met(task: Ward | Shard) -> Met:
    """See `Met`."""
    camera = Camera(task.filmed)
    rows = faces(task, camera) if isinstance(task, Ward) else list(lived(task, camera))
    return Met(rows, camera.films)


def _first(task: Ward | Shard) -> Life:
    return task.lives[0][0] if isinstance(task, Ward) else task.lives[0]


def _write(film: Film, path: Path) -> None:
    path.write_bytes(film.tobytes())


def _worked_s() -> float:
    """Processor time of this process and of those that it has begun and that have ended, s."""
    return sum(os.times()[:4])


def alone(config: Config, life: Life) -> str:
    """The command that lives this one alone."""
    vary = [*["--vary"] * bool(config.vary), *config.vary, *["--one-by-one"] * config.one_by_one]
    words = [*["--quick"] * config.quick, "--stages", *config.stages, *vary, "--agents", config.population,
             "--seed", config.seed, "--only", life.agent, "--out", f"runs/agent-{life.agent}"]  # fmt: skip
    return f"imitate battery {' '.join(map(str, words))}"


def tasks(
    stages: Sequence[str], lives: list[Life], seen: tuple[Look, ...], adults: list[Adult]
) -> tuple[list[Ward], list[Shard]]:
    """Wards of newborns' faces, and lives: whatever a number does not depend on, it has in common with others."""
    wards, shards = list[Ward](), list[Shard]()
    if "face" in stages:
        newborn = _alike(lives, partial(Life.childhood, part="face")).values()
        together = _alike(newborn, lambda some: (some[0].how.face_acts, some[0].seed // WARD))
        for (acts, number), group in together.items():
            wards.append(Ward(WARD * number, acts, tuple(map(tuple, group)), seen))
    for part, inside in (("gaze", ("gaze",)), ("body", ("movements", "objects"))):
        if asked := tuple(stage for stage in stages if stage in inside):
            for some in _alike(lives, partial(Life.childhood, part=part)).values():
                watched = adults[some[0].seed % len(adults)] if "objects" in asked else None
                shards.append(Shard(tuple(some), watched, asked))
    return wards, shards


def _alike(many: Iterable[Any], key: Callable[[Any], tuple[Any, ...]]) -> dict[tuple[Any, ...], list[Any]]:
    """By what they share."""
    found = dict[tuple[Any, ...], list[Any]]()
    for one in many:
        found.setdefault(key(one), []).append(one)
    return found


def summarise(done: Battery) -> str:
    """For people: verdicts."""
    shown = [row for row in done.rows if row.simulated is not None]
    title = f"# The battery: {done.metrics['agents']} agents, {len(done.frame)} trials"
    return f"{title}\n\n{beside_infants(shown)}"
