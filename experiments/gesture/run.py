"""HOAP-2 babbles, watches a movement, and reproduces it (chapter, stages 1 and 2; sections 3.1, 3.2, 3.5)."""

import time
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from babbling.body_image import BodyImage
from babbling.files import load
from experiments.gesture.figures import figures
from experiments.gesture.found import Performed
from experiments.gesture.joints import joint_metrics, joint_rows
from experiments.gesture.options import Config
from experiments.gesture.recording import record
from experiments.gesture.standing import stand, take_balance
from experiments.shared.baselines import direct_replay
from experiments.shared.experiment import Result
from experiments.shared.film import filmed
from experiments.shared.held import given, held
from experiments.shared.kept import once
from experiments.shared.minds import Learned, body_of, learn_mind, take_mind
from experiments.shared.mirrors import Pupil, correspondence_metrics, image_of, look_into_mirror
from experiments.shared.peers import inverse_line
from experiments.shared.progress import part, progress, ticking
from experiments.shared.tables import table
from experiments.shared.trajectories import left
from experiments.shared.watching import Seen, watch
from imitation.acting.loop import imitate
from imitation.acting.rehearsal import REHEARSAL_S, REHEARSERS, best_eagerness


def run(config: Config) -> Result:
    """Watch, babble, imitate, measure."""
    if config.stand:
        balance = take_balance(config) if config.balance is not None else None
        return stand(config, *prepare(config), balance)
    return judged(perform(config))


def judged(done: Performed) -> Result:
    """Numbers, figures, recording and files of what was done."""
    config, metrics = done.config, measure(done)
    summary = summarise(metrics, done.seen)
    imitated, demonstrated = (done.body.configurations(angles) for angles in (done.imitated, done.seen.angles))
    files = left(done.trajectories, csv=config.csv)
    files |= filmed(config.film, done.title, done.body, imitated, demonstrated, done.seen.teacher)
    made = figures(done, metrics)
    return Result(metrics, summary, made, lambda path: record(path, done, summary, made), files)


def prepare(config: Config) -> tuple[Learned, Seen]:
    """Watch, babble, and find in a mirror what of the teacher corresponds to what of oneself."""
    config.check()
    noise_deg = config.seeing_noise_deg
    body = body_of(config, 1, stream=3)
    learned = take_mind(config.forward_model, config) if config.forward_model is not None else None
    image = None if config.body_image is None else load(config.body_image, BodyImage)
    if image is not None:
        image.check(body)
    seen = watch(config.demonstration, body, config.motion, config.unit)
    for clip in config.clips if config.study else ():  # read now, watched later
        watch(clip, body, unit=config.unit)
    if not config.stand:
        seen = replace(seen, remarks=(*seen.remarks, *given(body), *held(config, seen.angles)))
    if learned is None:
        with progress(f"{config.robot} babbles") as report:
            learned = once(learn_mind, config, config.babbling_minutes, report=report)
    mind = learned.mind
    if config.correspondence == "learned" and seen.performance is not None:
        with progress(f"{config.robot} looks into a mirror") as report:
            started = time.perf_counter()
            if image is None:
                mirrored = once(look_into_mirror, config, mind.pilot, config.mirror_minutes, noise_deg, report=report)
                image = image_of(mirrored, config, mind.pilot)
        learned.metrics.update(mirror_body_minutes=image.minutes, mirror_wall_s=time.perf_counter() - started)
        pupil = Pupil(body, mind.pilot, image, noise_deg, config.parts == "named")
        found = pupil.follow(seen.performance, np.random.default_rng([config.seed, 10]))
        seen = seen.learning(found, body)
    return learned, seen


def perform(config: Config) -> Performed:
    """All of `imitate gesture` but its files, for notebooks: the same options, the same numbers.

    Raises:
        ExperimentError, BodyError, BabblingError: what the command line would say.
    """
    learned, seen = prepare(config)
    body, mind = body_of(config, 1, stream=3), learned.mind
    attempted = partial(imitate, body, seen.movement, mind, witness=lambda: body.joint_angles)
    rng = np.random.default_rng([config.seed, 8])
    line, hung, ticks = inverse_line(mind.forward_model), body_of(config, REHEARSERS, stream=1), len(seen.angles)
    with progress("imitating") as report:
        with ticking(body, part(report, 0, 0.7), config.attempts * ticks):
            attempts = attempted(selection=config.selection, attempts=config.attempts, rng=rng)
        with ticking(hung, part(report, 0.7, 0.9), 1.2 * REHEARSAL_S / body.tick_s):
            eagerness = best_eagerness(hung, mind, line, config.seed)
        with ticking(body, part(report, 0.9, 1), ticks):
            peer = attempted(inverse=line, eagerness=eagerness, rng=np.random.default_rng([config.seed, 9]))[0]
    return Performed(config, body, seen, learned, attempts, peer, direct_replay(body, seen.angles))


def measure(done: Performed) -> dict[str, Any]:
    """The numbers of metrics.json; the headline is `limb_error_deg`, errors of joints are against the sub-goals."""
    config, body, seen, learned, last = done.config, done.body, done.seen, done.learned, done.attempts[-1]
    labels = [body.sense_labels[sense] for sense in learned.mind.pilot.schema.posture]
    right = np.mean([label == joint for label, joint in zip(labels, body.motor_labels, strict=True)])
    select_ms = 1e3 * np.concatenate([attempt.select_s for attempt in done.attempts])
    return {
        "demonstration": config.demonstration,
        "remarks": list(seen.remarks),
        "robot": config.robot,
        "selection": config.selection,
        "seed": config.seed,
        "frames": len(seen.angles),
        "tick": body.tick_s,
        **limb_metrics(done),
        **joint_metrics(done),
        "slowed_factor": seen.slowed,
        "uninformed_selections": int(last.uninformed.sum()),
        "selections": last.uninformed.size,
        "never_tried_share": float(np.mean(last.familiarity < 1)),
        "mean_entropy_bits": float(last.entropy.mean()),
        "select_p50_ms": float(np.median(select_ms)),
        "select_p99_ms": float(np.quantile(select_ms, 0.99)),
        "body_schema_correct_share": float(right),
        "eagerness_mean": float(learned.mind.temper.eagerness.mean()),
        "habit_mean": float(learned.mind.temper.trust.mean()),
        **correspondence_metrics(seen, body.tick_s),
        **learned.metrics,
    }


def limb_metrics(done: Performed) -> dict[str, Any]:
    """Where the body really pointed, against where the teacher did: means over parts and frames; null when joint angles
    were given. limb_reachable_deg: see `Retargeted.best_deg`. demonstration_changed_deg (the most) and its mean: see
    `Retargeted.changed_deg`."""
    away, oracle = done.limb_errors_deg, done.seen.oracle
    if oracle is None:
        return {"limb_error_deg": None, "limb_reachable_deg": None, "demonstration_changed_deg": 0.0}
    changed = (done.seen.learned or oracle).changed_deg
    return {
        "limb_error_deg": float(away["imitated"].mean()),
        "limb_reachable_deg": float(away["least"].mean()),
        "limb_error_steadied_deg": float(away["steadied"].mean()),
        "limb_error_deg_by_part": dict(zip(oracle.found.parts, away["imitated"].mean(0).tolist(), strict=True)),
        "direct_replay_limb_error_deg": float(away["replayed"].mean()),
        "linear_peer_limb_error_deg": float(away["line"].mean()),
        "demonstration_changed_deg": float(changed.max(initial=0)),
        "demonstration_changed_mean_deg": float(changed.mean()) if len(changed) else 0.0,
    }


def summarise(metrics: dict[str, Any], seen: Seen) -> str:
    """The result as a markdown table."""
    deg = {key: f"{value:.4f} deg" for key, value in metrics.items() if isinstance(value, float)}
    changed = f"{metrics['demonstration_changed_deg']:.2f} deg ({metrics.get('demonstration_changed_mean_deg', 0):.2f})"
    rows = []
    if seen.oracle is not None:
        rows = [
            ("limb directions, executed against the teacher's", deg["limb_error_deg"]),
            ("the same, against its steadied ones", deg["limb_error_steadied_deg"]),
            ("the least that this body's joints allow", deg["limb_reachable_deg"]),
            ("limb directions, direct replay", deg["direct_replay_limb_error_deg"]),
            ("the demonstration was changed by at most (mean)", changed),
        ]
    rows += [
        ("slowed for the servos", f"{metrics['slowed_factor']:.2f} times as long"),
        *joint_rows(metrics),
    ]
    if seen.learned is not None:
        both = f"{metrics['limb_direction_error_deg']:.3f} / {metrics['ik_limb_direction_error_deg']:.3f} deg"
        rows.append(("limb directions off where they can be reached: learned / inverse kinematics", both))
    rows += [
        (
            "babbling",
            f"{metrics['babbling_body_minutes']:.1f} body-minutes + {metrics['pilot_body_minutes']:.1f} pilot",
        ),
        ("one selection, all joints", f"{metrics['select_p50_ms']:.2f} ms of {1e3 * metrics['tick']:.0f} ms"),
        ("selections off the table", f"{metrics['uninformed_selections']} of {metrics['selections']}"),
        ("motors whose joint babbling found", f"{metrics['body_schema_correct_share']:.0%}"),
    ]
    title = f"**{seen.movement.name}**, {metrics['frames'] * metrics['tick']:.1f} s, by {metrics['robot']}"
    return f"{title}\n\n{table(rows)}"
