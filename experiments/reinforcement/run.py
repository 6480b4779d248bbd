"""The peer of the chapter's section 4: learning by reward, on the same body, the same movement and the same senses.

"Learning through imitation offers substantial benefits over other leading robotic learning methods (such as
reinforcement learning) by (1) overcoming the need for a huge number of learning trials and (2) avoiding the need for
risky and dangerous experimentation during learning." Both are counted here, by the same counters for all.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from babbling.axes import FloatArray
from experiments.reinforcement import figures
from experiments.reinforcement.deep import proximal
from experiments.reinforcement.found import NONE, Point, Ratio, Reached, ratio, reached
from experiments.reinforcement.options import Config, must_be_there
from experiments.reinforcement.ours import Life, live
from experiments.reinforcement.search import search
from experiments.reinforcement.trials import Policy, Trials, off, replaying
from experiments.shared.experiment import Result
from experiments.shared.minds import COPIES, body_of
from experiments.shared.options import BodyOptions
from experiments.shared.parallel import in_parallel
from experiments.shared.tables import table
from experiments.shared.watching import watch
from models.risk import Risks, WatchedBody

LEARNERS: Mapping[str, Callable[[Trials, int], Iterator[Policy]]] = {
    "search": search,
    "residual": partial(proximal, residual=True),
    "nothing": partial(proximal, residual=False),
}
STAGES = {"attempt after the pilot": 0, "first attempt": -1}
"""Of ours, which others are to be as good as; by `Life.points`."""
SPACED = 1.08
"""A learner is looked at again once it has had so many times the body time; its being looked at costs it nothing."""


class Task(NamedTuple):
    """One learner of one seed."""

    who: str
    options: BodyOptions
    angles: FloatArray
    """(T, J) the movement."""
    minutes: float
    target: float
    """How little it is to be off; then it is done."""


def practise(task: Task) -> list[Point]:
    """What a learner is off by, before its first trial and after more and more of them."""
    trials = Trials(WatchedBody(body_of(task.options, COPIES)), task.angles)
    judge = Trials(WatchedBody(body_of(task.options, 1, stream=3)), task.angles)
    points = list[Point]()
    for policy in LEARNERS[task.who](trials, task.options.seed):
        spent = trials.body.risks.minutes
        if points and spent < min(points[-1].risks.minutes * SPACED, task.minutes):
            continue
        points.append(Point(trials.body.risks, off(judge, policy)))
        if points[-1].error <= task.target or spent >= task.minutes:
            break
    return points


def run(config: Config) -> Result:
    """Watch, imitate, learn by reward, compare."""
    config.check()
    must_be_there(config)
    body = body_of(config, 1, stream=3)
    seen = watch(config.demonstration, body, unit=config.unit)
    replay = off(Trials(WatchedBody(body), seen.angles), replaying)
    bodies = [body_options(config, config.seed + n) for n in range(config.seeds)]
    lives = in_parallel(live, [(one, seen.angles, config.babbling_minutes) for one in bodies], config.workers, "living")
    attempts = {name: float(np.mean([life.points[stage].error for life in lives])) for name, stage in STAGES.items()}
    tasks = [
        Task(who, one, seen.angles, config.minutes, attempts["first attempt"]) for who in config.peers for one in bodies
    ]
    curves = in_parallel(practise, tasks, config.workers, "learning by reward")
    by_peer = {who: curves[n * len(bodies) : (n + 1) * len(bodies)] for n, who in enumerate(config.peers)}
    levels = {"direct replay": replay} | attempts
    rows = compare(lives, by_peer, levels)
    metrics = {
        "demonstration": config.demonstration,
        "robot": config.robot,
        "seeds": config.seeds,
        "minutes": config.minutes,
        "levels_deg": levels | {"inverse line": float(np.mean([life.line for life in lives]))},
        "rows": [row._asdict() | {"ratio": row.ratio._asdict()} for row in rows],
        "ours": [[told(point) for point in life.points] for life in lives],
        "peers": {who: [[told(point) for point in one] for one in many] for who, many in by_peer.items()},
    }
    return Result(metrics, summarise(metrics, rows), {"body_time": figures.body_time(metrics)})


def body_options(config: Config, seed: int) -> BodyOptions:
    """The body of one seed; one thread where there are many processes."""
    names = ("robot", "servos", "sensor_noise_deg", "scramble")
    threads = config.threads if config.workers == 1 else 1
    return replace(BodyOptions(**{name: getattr(config, name) for name in names}), seed=seed, threads=threads)


def told(point: Point) -> dict[str, float]:
    """For metrics.json."""
    return {"error_deg": point.error, **point.risks._asdict()}


class Row(NamedTuple):
    """One question to one peer."""

    peer: str
    as_good_as: str
    what: str
    """Of `Risks`: body-minutes, or what was risked in them."""
    theirs: list[float]
    """Of every seed."""
    enough: list[bool]
    """Whether it became as good; otherwise all that it had."""
    ours: list[float]
    ratio: Ratio


def compare(
    lives: Sequence[Life], by_peer: Mapping[str, Sequence[Sequence[Point]]], levels: Mapping[str, float]
) -> list[Row]:
    """How much of everything it takes to be as good as each level, theirs over ours (at a stage of ours, all of it)."""
    rows = []
    for level, error in levels.items():
        stage = STAGES.get(level)
        mine = [
            reached(one.points, error) if stage is None else Reached(one.points[stage].risks, True) for one in lives
        ]
        for who, curves in by_peer.items():
            theirs = [reached(one, error) for one in curves]
            enough = [one.enough for one in theirs]
            for what in Risks._fields:
                took, our = ([float(getattr(one.risks, what)) for one in many] for many in (theirs, mine))
                found = ratio(took, our, enough) if all(one.enough for one in mine) else NONE
                rows.append(Row(who, level, what, took, enough, our, found))
    return rows


WHAT = {"minutes": "body-minutes", "stops_hit": "joint stops hit", "saturated_s": "servos saturated, s",
        "touching_s": "parts would touch, s"}  # fmt: skip


def summarise(metrics: Mapping[str, Any], rows: Sequence[Row]) -> str:
    """Levels, then what everyone took to reach them, and the ratios: markdown tables."""
    levels, spent = metrics["levels_deg"], [np.mean([p[n]["minutes"] for p in metrics["ours"]]) for n in (0, -1)]
    best = {who: [min(p["error_deg"] for p in one) for one in many] for who, many in metrics["peers"].items()}
    errors = [(f"the imitator: {name}", f"{error:.4f}") for name, error in levels.items()]
    errors[0], errors[-1] = ("direct replay", errors[0][1]), ("its inverse line, the same loop", errors[-1][1])
    errors += [
        (f"{who}, the best of {metrics['minutes']:g} body-minutes", f"{np.mean(b):.4f}") for who, b in best.items()
    ]
    parts = [
        f"**{metrics['demonstration']}** by {metrics['robot']}, {metrics['seeds']} seeds. The imitator's first attempt "
        f"comes after {spent[1]:.1f} body-minutes, babbling and rehearsal counted; one after its pilot alone, after "
        f"{spent[0]:.1f}",
        table(errors, ("root mean square of all joints", "deg")),
    ]
    for level in dict.fromkeys(row.as_good_as for row in rows):
        cells = [
            (
                row.peer,
                WHAT[row.what],
                f"{'' if all(row.enough) else '≥ '}{np.mean(row.theirs):.4g}",
                f"{np.mean(row.ours):.4g}",
                row.ratio,
            )
            for row in rows
            if row.as_good_as == level
        ]
        parts.append(table(cells, (f"until as good as {level}", "", "it", "the imitator", "ratio (95 % over seeds)")))
    parts.append(
        "What was had and was not enough is marked ≥. Search and residual begin as direct replay, and know which motor "
        "moves which joint. What was learned by reward serves this movement, babbling and rehearsal serve any."
    )
    return "\n\n".join(parts)
