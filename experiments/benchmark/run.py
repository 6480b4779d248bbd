"""Peers in one table: same bodies, same experience, same loop, each at its own best eagerness; and what it costs."""

import sys
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from babbling.pilot import pilot_minutes
from experiments.benchmark import figures
from experiments.benchmark import maze as maze_benchmark
from experiments.benchmark.lives import Clips, Point, Task, live
from experiments.benchmark.options import CURVE, LEARNERS, PEERS, Config, body_options
from experiments.errors import ExperimentError
from experiments.shared.experiment import Result
from experiments.shared.kept import keeping
from experiments.shared.minds import COPIES, body_of, copies_for
from experiments.shared.parallel import in_parallel
from experiments.shared.progress import progress
from experiments.shared.tables import table
from experiments.shared.watching import watch

resource: ModuleType | None
try:
    import resource
except ImportError:
    resource = None

GROWING = (0.0, 2 / 3, 8 / 3, 23 / 3, 53 / 3, 143 / 3, 293 / 3)
"""Minutes of babbling after which the curve has points; the first is the pilot alone."""
EARLY = (0.3, 0.5, 1.0)
"""Body-minutes in all, the pilot's counted, of the points before: other lives, of as few bodies as have time for it."""
CURVE_BODIES = ("ideal", "worn")
RESAMPLES = 2000


def run(config: Config) -> Result:
    """Watch, live every life, compare, measure what it costs."""
    config.check()
    models = [name for name in config.models if name not in LEARNERS or find_spec("sklearn")]
    clips = watched(config)
    seeds = range(config.seed, config.seed + config.seeds)
    task = partial(Task, clips=clips)
    babbling = config.babbling_minutes - pilot_minutes(COPIES)
    tasks = [
        task(
            body,
            seed,
            models=models,
            stops=(babbling,),
            attempts=config.attempts,
        )
        for body in config.bodies
        for seed in seeds
    ]
    tasks[0] = tasks[0]._replace(costs=True)
    growing = [
        task(body, seed, models=CURVE, stops=stops, copies=copies)
        for body in CURVE_BODIES
        for seed in seeds
        for copies, stops in growths()
    ]
    with keeping(config.keep, stays=True) if config.keep is not None else nullcontext():
        lives = in_parallel(live, tasks, config.workers, "living")
        grown = in_parallel(live, growing if config.curve else [], config.workers, "living")
    by_body = {
        body: [life[0] for one, life in zip(tasks, lives, strict=True) if one.body == body] for body in config.bodies
    }
    metrics = compare(config, tuple(clips), by_body) | lives[0][0].costs
    if config.curve:
        metrics |= curves(growing, grown)
    metrics["peak_memory_mb"] = peak_memory_mb()
    maze = maze_benchmark.rows(peers=config.peers, seed=config.seed)
    metrics |= maze_benchmark.metrics(maze)
    return Result(metrics, summarise(metrics, maze), figures.drawn(metrics))


def growths() -> list[tuple[int, tuple[float, ...]]]:
    """Copies and stops of the lives that the curve is made of, the shortest first."""
    early = [(copies_for(minutes), minutes) for minutes in EARLY]
    return [*((n, (minutes - pilot_minutes(n),)) for n, minutes in early), (COPIES, GROWING)]


def peak_memory_mb() -> float:
    """Of this process, or of the largest that lived a life: resident at most; 0 where nobody tells (Windows)."""
    if resource is None:
        return 0.0
    most: float = max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return most / (1 << 20 if sys.platform == "darwin" else 1 << 10)


def watched(config: Config) -> Clips:
    """Every clip, at the pace that these bodies' servos allow, the same for all."""
    body, *others = (body_of(body_options(name, config.seed), 1) for name in config.bodies)
    for name, other in zip(config.bodies[1:], others, strict=True):
        if other.joints != body.joints:
            raise ExperimentError(f"--bodies {name}: it has other joints than {config.bodies[0]}; name alike ones")
    with progress("watching") as report:
        clips = {}
        for done, clip in enumerate(config.clips):
            clips[Path(clip).name] = watch(clip, body, unit=config.unit).angles
            report((done + 1) / len(config.clips))
    return clips


def compare(config: Config, clips: Sequence[str], lived: Mapping[str, Sequence[Point]]) -> dict[str, Any]:
    """The numbers of metrics.json."""
    metrics: dict[str, Any] = {"seeds": config.seeds, "clips": list(clips), "errors_deg": {}, "ringing_deg": {}}
    for body, points in lived.items():
        models = list(points[0].errors)
        errors = {c: {m: [p.errors[m][i] for p in points] for m in models} for i, c in enumerate(clips)}
        rings = {m: np.mean([p.ringing[m] for p in points], axis=0) for m in models}
        metrics["errors_deg"][body] = errors
        metrics["ringing_deg"][body] = {m: [float(np.median(r)), float(r.max())] for m, r in rings.items()}
        rivals = [m for m in models if m in PEERS]
        if "average" in models and rivals:
            ratios = {c: ratio(one["average"], {m: one[m] for m in rivals}) for c, one in errors.items()}
            metrics.setdefault("ratio", {})[body] = {c: r[1:] for c, r in ratios.items()}
            metrics.setdefault("best_peer", {})[body] = {c: r[0] for c, r in ratios.items()}
        if config.attempts >= 5 and "average" in models:
            fifth = {c: [p.last[i][4] for p in points] for i, c in enumerate(clips)}
            metrics.setdefault("fifth_deg", {})[body] = fifth
    return metrics


def ratio(ours: Sequence[float], theirs: Mapping[str, Sequence[float]]) -> tuple[str, float, float, float]:
    """Best peer, our mean error over its, and a 95 % interval by drawing seeds again (all models' together)."""
    mine, others = np.array(ours), np.array(list(theirs.values()))
    drawn = np.random.default_rng(0).integers(0, len(mine), (RESAMPLES, len(mine)))
    low, high = np.quantile(mine[drawn].mean(1) / others[:, drawn].mean(2).min(0), (0.025, 0.975))
    best = int(others.mean(1).argmin())
    return list(theirs)[best], float(mine.mean() / others[best].mean()), float(low), float(high)


def curves(tasks: Sequence[Task], lives: Sequence[Sequence[Point]]) -> dict[str, dict[str, Any]]:
    """`curve` (of the ideal body; others `curve_BODY`): [minutes, errors of every seed at each] by model; means over
    clips."""
    found: dict[str, dict[str, Any]] = {}
    for body in dict.fromkeys(task.body for task in tasks):
        by_seed: dict[int, list[Point]] = {}
        for task, life in zip(tasks, lives, strict=True):
            if task.body == body:
                by_seed.setdefault(task.seed, []).extend(life)
        mine = by_seed.values()
        at = [list(points) for points in zip(*mine, strict=True)]
        found["curve" if body == CURVE_BODIES[0] else f"curve_{body}"] = {
            name: [[same[0].minutes for same in at], [[float(np.mean(p.errors[name])) for p in same] for same in at]]
            for name in CURVE
        }
    return found


def summarise(metrics: Mapping[str, Any], maze: Sequence[maze_benchmark.Row]) -> str:
    """Bodies, then costs, then the maze's questions: markdown tables."""
    parts = [f"Joint error, root mean square over joints and frames, degrees; mean over {metrics['seeds']} seeds"]
    for body, errors in metrics["errors_deg"].items():
        rings = metrics["ringing_deg"][body]
        rows = [
            (model, *(f"{np.mean(one[model]):.4f}" for one in errors.values()), "{:.3f} / {:.3f}".format(*rings[model]))
            for model in rings
        ]
        if ratios := metrics.get("ratio", {}).get(body):
            rows.append(("average / best peer", *("{:.2f} ({:.2f} to {:.2f})".format(*r) for r in ratios.values()), ""))
        if fifth := metrics.get("fifth_deg", {}).get(body):
            rows.append(("average, fifth attempt", *(f"{np.mean(one):.4f}" for one in fifth.values()), ""))
        parts.append(table(rows, (body, *errors, "ringing, median / worst joint")))
    costs = [
        ("babbling against bare stepping of the same bodies", f"{metrics['babbling_efficiency_factor']:.2f}"),
        ("one selection for all joints", f"{metrics['select_p50_ms']:.2f} ms"),
        ("peak memory, largest process", f"{metrics['peak_memory_mb']:.0f} MB"),
    ]
    answers = [
        (r.question, r.who, f"{r.each_us:.3f}", f"{r.times_ours_factor:.2f}", f"{r.largest_difference:.1e}")
        for r in maze
    ]
    header = ("maze question", "who", "us each", "times ours", "largest difference")
    return "\n\n".join([*parts, table(costs, ("cost", "")), table(answers, header)])
