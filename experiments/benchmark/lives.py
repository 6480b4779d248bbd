"""A life is one mind of one body: it babbles, and everyone imitates all clips at once, one copy of the body each."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray
from babbling.explanations import UNBELIEVED
from babbling.loop import babble, bouts, experience
from babbling.mind import Mind, Temper
from babbling.pilot import begin
from experiments.benchmark.options import body_options
from experiments.shared import peers
from experiments.shared.baselines import direct_replay
from experiments.shared.judging import ringing, rmse_deg
from experiments.shared.minds import COPIES, bare_rate, body_of
from experiments.shared.options import BodyOptions
from experiments.shared.peers import Steps
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement, together
from imitation.acting.rehearsal import EAGERNESS, REHEARSERS, calmest, felt_errors
from imitation.inference.moving import AveragedInverse, MovingInverse

Clips = Mapping[str, FloatArray]
"""(T, J) joint angles by name."""


class Task(NamedTuple):
    """A life to be lived."""

    body: str
    seed: int
    clips: Clips
    models: Sequence[str]
    stops: tuple[float, ...]
    """Minutes of babbling after which everyone imitates, ascending."""
    attempts: int = 1
    costs: bool = False
    copies: int = COPIES
    """How many babble at once; the fewer, the sooner their pilot is over."""


@dataclass
class Point:
    """What everyone did after so many body-minutes, pilot included."""

    minutes: float
    errors: dict[str, list[float]] = field(default_factory=dict)
    """deg, of every clip."""
    ringing: dict[str, FloatArray] = field(default_factory=dict)
    """(J,) deg, mean over clips."""
    last: list[list[float]] = field(default_factory=list)
    """deg of every attempt at every clip."""
    costs: dict[str, float] = field(default_factory=dict)


def live(task: Task) -> list[Point]:
    """Pilot and babble; at every stop, everyone imitates."""
    options, points, done, before = body_options(task.body, task.seed), list[Point](), 0, 0.0
    body = body_of(options, task.copies)
    runs = list[tuple[FloatArray, FloatArray]]()
    found, model = begin(body, task.seed, lambda *run: runs.append(run))
    lived = [Steps.lived(found, *run) for run in runs]
    for stop in task.stops:
        for ticks in bouts(stop - before, body) if stop > before else ():
            body.reseed(1 + done)
            motors, senses = experience(body, found, task.seed, done, ticks)
            found.learn(model, motors, senses)
            lived.append(Steps.lived(found, motors, senses))
            done += 1
        mind = Mind(body.fingerprint, task.seed, found, model, Temper.cautious(len(model.factors)))
        points.append(perform(task, options, mind, lived, Point(found.minutes + stop)))
        before = stop
    if task.costs:
        points[0].costs.update(costs(options, mind, task.clips))
    return points


def inverse_models(mind: Mind, lived: Sequence[Steps], models: Sequence[str]) -> dict[str, list[MovingInverse]]:
    """Everyone who chooses actions, by name; of several of a name, the one that rehearses best is to imitate."""
    model, seen = mind.forward_model, Steps(*map(np.concatenate, zip(*lived, strict=True)))
    line, forward = peers.forward_line(model), peers.feature_line_forward(seen, 0.1)
    evidence = model.evidence.copy()
    evidence[:, -1] = -UNBELIEVED
    averaged, counted = partial(AveragedInverse, trust=mind.temper.trust), partial(peers.one_table, lived[0], seen)
    makers: dict[str, Callable[[], list[MovingInverse]]] = {
        "average": lambda: [averaged(model)],
        "table": lambda: [peers.table(one, trust) for one in (counted(),) for trust in (1.0, 0.1)],
        "inverse_line": lambda: [peers.inverse_line(model)],
        "forward_line": lambda: [line],
        "gaussian": lambda: [peers.forward_line(model, trust) for trust in (1.0, 0.1)],
        "feature_line": lambda: [peers.feature_line(seen, forward)],
        "feature_line_forward": lambda: [forward],
        "mlp": lambda: [peers.mlp(seen, line, forward, mind.seed)],
        "trees": lambda: [peers.trees(seen, line, forward)],
        "lqr": lambda: [peers.lqr(mind.pilot.dynamics, weight, line) for weight in (1e-3, 1.0)],
        "average_without_table": lambda: [averaged(replace(model, evidence=evidence))],
        "average_mean": lambda: [averaged(model, "mean")],
        "average_matching": lambda: [averaged(model, "matching")],
    }
    return {name: makers[name]() for name in models if name in makers}


def perform(task: Task, options: BodyOptions, mind: Mind, lived: Sequence[Steps], point: Point) -> Point:
    """Everyone imitates all clips."""
    body, clips = body_of(options, len(task.clips), stream=3), list(task.clips.values())
    everything = together([Movement(n, body.tick_s, body.sensations(a)) for n, a in task.clips.items()])

    def note(name: str, reached: Sequence[FloatArray]) -> None:
        point.errors[name] = [rmse_deg(one, wanted) for one, wanted in zip(reached, clips, strict=True)]
        rings = [ringing(np.rad2deg(one - wanted)) for one, wanted in zip(reached, clips, strict=True)]
        point.ringing[name] = np.mean(rings, axis=0)

    if "replay" in task.models:
        alone = body_of(options, 1, stream=3)
        note("replay", [direct_replay(alone, wanted) for wanted in clips])
    for name, variants in inverse_models(mind, lived, task.models).items():
        eagerness, inverse = rehearsed(options, mind, variants)
        attempts = imitate(
            body,
            everything,
            mind,
            inverse=inverse,
            eagerness=eagerness,
            attempts=task.attempts if name == "average" else 1,
            rng=np.random.default_rng([options.seed, 8]),
            witness=lambda: body.joint_angles,
        )
        note(name, [attempts[0].truth[: len(wanted), b] for b, wanted in enumerate(clips)])
        if name == "average":
            point.last = [[rmse_deg(a.truth[: len(w), b], w) for a in attempts] for b, w in enumerate(clips)]
    return point


def rehearsed(options: BodyOptions, mind: Mind, variants: Sequence[MovingInverse]) -> tuple[FloatArray, MovingInverse]:
    """The variant that felt closest in rehearsal, and (F,) its best eagerness."""
    tried = []
    for inverse in variants:
        errors = felt_errors(body_of(options, REHEARSERS, stream=1), mind, inverse, options.seed)
        chosen = calmest(errors)
        missed = float((np.take_along_axis(errors, chosen[None], 0) ** 2).sum())
        tried.append((missed, np.array(EAGERNESS)[chosen], inverse))
    return min(tried, key=lambda one: one[0])[1:]


def costs(options: BodyOptions, mind: Mind, clips: Clips, rounds: int = 5, ticks: int = 250) -> dict[str, float]:
    """Babbling (exploring, acting, feeling, counting) against bare `mujoco.batch` stepping of the same bodies through
    the same commands, in turn, the median of the rates' ratio; and milliseconds of one selection for all joints."""
    body, model, ratios = body_of(options, COPIES), mind.pilot.forward_model(), []
    for number in range(rounds):
        started = time.perf_counter()
        babble(body, mind.pilot, (ticks,), options.seed + number, onto=model)
        ours = time.perf_counter() - started
        rng = np.random.default_rng([options.seed + number, 3, 0])
        ratios.append(ticks / bare_rate(body, mind.pilot, rng, ticks) / ours)
    alone, angles = body_of(options, 1, stream=3), next(iter(clips.values()))[:ticks]
    movement = Movement("one", alone.tick_s, alone.sensations(angles))
    select_ms = 1e3 * imitate(alone, movement, mind, rng=np.random.default_rng(options.seed))[0].select_s
    return {
        "babbling_efficiency_factor": float(np.median(ratios)),
        "select_p50_ms": float(np.median(select_ms)),
        "select_p99_ms": float(np.quantile(select_ms, 0.99)),
    }
