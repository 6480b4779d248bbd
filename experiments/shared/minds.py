"""Getting a mind: babble anew, go on with an interrupted babble, or take one from a file."""

import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing, nullcontext
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.explanations import EXPLANATIONS, Explanations
from babbling.files import load, save
from babbling.kinds import Numbers, kind
from babbling.loop import babble, bouts
from babbling.mind import Mind, Temper
from babbling.pilot import Pilot, begin, pilot_minutes
from experiments.errors import ExperimentError
from experiments.shared.held_out import HeldOut, Watched
from experiments.shared.judging import LearningCurve
from experiments.shared.options import LONGEST_MINUTES, BodyOptions
from experiments.shared.progress import part, ticking
from imitation.acting.rehearsal import EAGERNESS, REHEARSAL_S, REHEARSERS, rehearse
from imitation.inference.moving import CANDIDATES
from models.body import SimulatedBody
from models.loading import load_body

EVERY_S, SPARING = 13.0, 50.0
"""Wall time after which what was learned so far is kept, as soon as a bout (1.5 s) ends, sooner where a rehearsal's
round (6 s) does; but no sooner than so many times what keeping took last (0.2 s)."""
COPIES, PILOT_SHARE = 8, 0.6
"""Bodies that babble at once, and how much of the babbling their pilot may take: fewer where there is little time."""
BARE_TICKS = 100
REHEARSED, REHEARSAL_COST = 3.7, 4.4
"""For progress alone: rehearsing lasts so many made-up movements, a tick of it so many ticks of babbling."""
Experiences = Generator[tuple[FloatArray, FloatArray], None, None]
Elsewhere = Callable[[int, Pilot, tuple[int, ...], int], Experiences]
"""(copies, pilot, ticks of each bout, the first bout still to do) -> `experience` of every bout from that one on."""


def body_of(options: BodyOptions, copies: int, stream: int = 0) -> SimulatedBody:
    """So many copies; `stream` tells apart the sensor noise of different uses."""
    return load_body(
        options.robot,
        copies=copies,
        threads=options.threads,
        noise=float(np.deg2rad(options.sensor_noise_deg)),
        scramble=options.scramble,
        seed=options.seed * 1000 + stream,
        give_servos=options.servos,
    )


@dataclass(frozen=True)
class Learned:
    """A mind and how it came about."""

    mind: Mind
    metrics: dict[str, Any] = field(default_factory=dict)
    curve: LearningCurve | None = None


@kind("interrupted babble", "move or delete the file", ExperimentError)
@dataclass(frozen=True)
class Interrupted:
    """A mind that has not babbled to the end, and what is needed to go on."""

    mind: Mind
    minutes: Annotated[float, Numbers(unit="min", low=0, high=LONGEST_MINUTES)]
    """Body time of the whole babble."""
    noise_deg: Annotated[float, Numbers(unit="degree", low=0, high=30)]
    bouts_done: Annotated[int, Numbers(low=0)]
    points: Annotated[FloatArray, Numbers("point curve:3", low=0)]
    """Of its learning curve; see `HeldOut`."""
    rehearsed: Annotated[FloatArray, Numbers(f"temper eagerness:{len(EAGERNESS)} motor", low=0)]
    """(R, E, F) what its rehearsal felt so far; see `rehearse`."""
    wall_s: Annotated[FloatArray, Numbers("phase:2", "s", low=0)]
    """Of its pilot, and of its babbling so far."""


def people_say(body: SimulatedBody) -> Mapping[str, Sequence[str]]:
    """Joint names, for files that people read; the mind is never told."""
    return {"motor": body.motor_labels, "sense": body.senses.labels}


def factors_of(body: SimulatedBody, mind: Mind) -> IntArray:
    """(J,) factor of each joint, by the sense it moves; -1 where babbling found none."""
    labels = [body.sense_labels[line] for line in mind.pilot.schema.posture]
    return np.array([labels.index(joint) if joint in labels else -1 for joint in body.joints])


def learn_mind(
    options: BodyOptions,
    minutes: float,
    report: Callable[[float], None],
    *,
    checkpoint: Path | None = None,
    candidates: int = CANDIDATES,
    rehearsal_s: float = REHEARSAL_S,
    elsewhere: Elsewhere | None = None,
    judged: bool = True,
) -> Learned:
    """Pilot, babbling, rehearsal.

    Args:
        options: the body.
        minutes: body time in all, the pilot's counted.
        report: progress, 0 to 1.
        checkpoint: where to keep what was learned so far, every `EVERY_S`; an interrupted babble goes on from there and
            ends with the same mind and numbers, wall times apart.
        candidates: see `rehearse`.
        rehearsal_s: see `rehearse`.
        elsewhere: who has the experience of the bouts, if not this process.
        judged: whether there are metrics and a curve, for which other copies babble as well.
    """
    copies = copies_for(minutes)
    body = body_of(options, copies)
    more = minutes - pilot_minutes(copies)
    plan = bouts(more, body) if more * 60 > body.tick_s * copies else ()
    kept, cost_s = (clock := time.perf_counter()), 0.0
    left = _left(checkpoint, body, options, minutes, plan)
    pilot_ticks, rehearsing = pilot_minutes(1) * 60 / body.tick_s, REHEARSED * rehearsal_s / body.tick_s
    whole = pilot_ticks + sum(plan) + REHEARSAL_COST * rehearsing
    before, babbled = pilot_ticks / whole, (pilot_ticks + sum(plan)) / whole
    if left is None:
        runs = list[tuple[FloatArray, FloatArray]]()
        with ticking(body, part(report, 0, before), pilot_ticks):
            found, model = begin(body, options.seed, lambda *run: runs.append(run))
        first, rehearsed, (piloted, spent) = 0, list[FloatArray](), (time.perf_counter() - clock, 1e-9)
    else:
        found, model, first = left.mind.pilot, left.mind.forward_model, left.bouts_done
        rehearsed, (piloted, spent) = list(left.rehearsed), left.wall_s.tolist()
    noted = () if left is None else left.points
    held_out = HeldOut(body_of(options, COPIES, stream=2), found, options.seed, noted) if judged else None
    piloting = model.transitions / len(model.factors) - sum(plan[:first]) * copies  # transitions that it counted

    def look(within: bool) -> None:
        nonlocal clock
        if held_out is None:
            return
        began = time.perf_counter()
        held_out.note(
            found.minutes + (model.transitions / len(model.factors) - piloting) * body.tick_s / 60, model, within
        )
        clock += time.perf_counter() - began

    if left is None and held_out is not None:
        held_out.note_pilot(*runs[0], found)
        look(within=False)

    def unrehearsed() -> Mind:
        return Mind(body.fingerprint, options.seed, found, model, Temper.cautious(len(model.factors)))

    def keep(done: int, after_s: float) -> None:
        nonlocal kept, cost_s
        if checkpoint is not None and (begun := time.perf_counter()) - kept >= max(after_s, SPARING * cost_s):
            felt = np.array(rehearsed).reshape(-1, len(EAGERNESS), len(model.factors))
            points = np.array(held_out.points if held_out else ()).reshape(-1, 3)
            wall_s = np.array([piloted, spent])
            save(Interrupted(unrehearsed(), minutes, options.sensor_noise_deg, done, points, felt, wall_s), checkpoint)
            kept = time.perf_counter()
            cost_s = kept - begun

    def after_bout(done: int, model: Explanations) -> None:
        nonlocal clock, spent
        spent += time.perf_counter() - clock
        look(within=False)
        if elsewhere is not None:  # no tick is felt here
            part(report, before, babbled)(done / len(plan))
        keep(done, EVERY_S if done < len(plan) else EVERY_S * 0.7)
        body.reseed(1 + done)  # so that a bout feels the same whether or not earlier ones were run in this process
        clock = time.perf_counter()

    def after_rehearsing(errors: FloatArray) -> None:
        rehearsed.append(errors)
        if not options.sensor_noise_deg:  # else the next would feel other noise in another process
            keep(len(plan), EVERY_S * 0.7)

    keep(first, EVERY_S)
    body.reseed(1 + first)
    clock = time.perf_counter()
    watched = Watched(found, partial(look, within=True))
    with (
        ticking(body, part(report, before, babbled), sum(plan), sum(plan[:first])),
        nullcontext() if elsewhere is None else closing(elsewhere(copies, found, plan, first)) as had,
    ):
        babble(body, watched, plan, options.seed, onto=model, first=first, after_bout=after_bout, had=had)
    rehearsers = body_of(options, REHEARSERS, stream=1)
    with ticking(rehearsers, part(report, babbled, 1), rehearsing):
        how = options.seed, tuple(rehearsed), after_rehearsing, candidates, rehearsal_s
        mind = rehearse(rehearsers, unrehearsed(), *how)
    report(1.0)
    if held_out is None:
        return Learned(mind)
    ticks, curve = sum(plan), held_out.curve()
    metrics = {
        "babbling_transitions": model.transitions,
        "babbling_body_minutes": sum(plan) * copies * body.tick_s / 60,
        "pilot_body_minutes": found.minutes,
        "babbling_wall_s": spent,
        "pilot_wall_s": piloted,
        "babbling_outside": int(model.outside.sum()),
        "babbling_efficiency_factor": ticks / spent / bare_rate(body, found, np.random.default_rng([options.seed, 6])),
        "steps_per_second_factor": ticks * copies * body.substeps / spent,
        "learning_curve_body_minutes": curve.minutes,
        f"learning_curve_table_{curve.unit}": curve.table,
        f"learning_curve_linear_{curve.unit}": curve.line,
        f"learning_curve_floor_{curve.unit}": curve.floor,
        "explanations": dict(zip(EXPLANATIONS, model.weights.mean(0).tolist(), strict=True)),
    }
    return Learned(mind, metrics, curve)


def copies_for(minutes: float) -> int:
    """How many bodies babble so long at once.

    Raises:
        ExperimentError: less than one body's pilot takes.
    """
    if minutes < pilot_minutes(1):
        raise ExperimentError(
            f"--babbling-minutes {minutes:g}: to find out what there is to move takes {pilot_minutes(1):.2f} alone"
        )
    return int(np.clip(PILOT_SHARE * minutes / pilot_minutes(1), 1, COPIES))


def bare_rate(body: SimulatedBody, found: Pilot, rng: np.random.Generator, ticks: int = BARE_TICKS) -> float:
    """Ticks per second of `mujoco.batch` alone, stepping the same bodies through babbling's own commands."""
    stream = found.stream(body, rng)
    commands = [body.commands(next(stream)) for _ in range(ticks)]
    body.reset()
    started = time.perf_counter()
    for command in commands:
        body.batch.ctrl[:] = command
        body.batch.step(nstep=body.substeps)
    return ticks / (time.perf_counter() - started)


def take_mind(path: Path, options: BodyOptions) -> Learned:
    """A mind from a file, checked against the body.

    Raises:
        BabblingError: see `load` and `Mind.check`.
    """
    mind = load(path, Mind)
    mind.check(body_of(options, 1))
    model = mind.forward_model
    per_factor = model.transitions / len(model.factors)
    return Learned(
        mind,
        {
            "babbling_transitions": model.transitions,
            "babbling_body_minutes": per_factor * body_of(options, 1).tick_s / 60 - mind.pilot.counted_minutes,
            "pilot_body_minutes": mind.pilot.minutes,
            "babbling_wall_s": 0.0,
            "babbling_efficiency_factor": None,  # nobody babbled
            "babbling_outside": int(model.outside.sum()),
        },
    )


def _left(
    checkpoint: Path | None, body: SimulatedBody, options: BodyOptions, minutes: float, plan: tuple[int, ...]
) -> Interrupted | None:
    if checkpoint is None or not checkpoint.exists():
        return None
    left = load(checkpoint, Interrupted)
    asked = body.fingerprint, options.seed, minutes, options.sensor_noise_deg
    if asked != (left.mind.fingerprint, left.mind.seed, left.minutes, left.noise_deg) or left.bouts_done > len(plan):
        raise ExperimentError(
            f"{checkpoint}: an interrupted babble of another body, seed, noise or length is here; "
            "repeat that command to finish it, or delete the file"
        )
    return left
