"""HOAP-2 babbles, watches a movement, and reproduces it (chapter, stages 1 and 2; sections 3.1, 3.2, 3.5)."""

import sys
import time
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from babbling.body_image import BodyImage
from babbling.files import load
from experiments.gesture.figures import figures
from experiments.gesture.found import Performed
from experiments.gesture.options import Config
from experiments.gesture.recording import record
from experiments.shared.baselines import direct_replay
from experiments.shared.experiment import Result
from experiments.shared.judging import rmse_deg
from experiments.shared.minds import body_of, learn_mind, take_mind
from experiments.shared.mirrors import Pupil, correspondence_metrics, image_of, look_into_mirror
from experiments.shared.progress import progress
from experiments.shared.tables import table
from experiments.shared.watching import Seen, watch
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement
from imitation.acting.rehearsal import EAGERNESS, best_eagerness
from imitation.inference.inverse import LinearInverse


def run(config: Config) -> Result:
    """Watch, babble, imitate, measure."""
    config.check()
    noise_deg = config.seeing_noise_deg
    body = body_of(config, 1, stream=3)
    learned = take_mind(config.forward_model, config) if config.forward_model is not None else None
    seen = watch(config.demonstration, body, config.motion)
    if learned is None:
        with progress(f"{config.robot} babbles") as report:
            learned = learn_mind(config, config.babbling_minutes, report)
    mind = learned.mind
    if config.correspondence == "learned" and seen.performance is not None:
        with progress(f"{config.robot} looks into a mirror") as report:
            started = time.perf_counter()
            if config.body_image is not None:
                image = load(config.body_image, BodyImage)
                image.check(body)
            else:
                mirrored = look_into_mirror(config, mind.pilot, config.mirror_minutes, noise_deg, report)
                image = image_of(mirrored, config, mind.pilot)
        learned.metrics.update(mirror_body_minutes=image.minutes, mirror_wall_s=time.perf_counter() - started)
        pupil = Pupil(body, mind.pilot, image, noise_deg, config.parts == "named")
        found = pupil.follow(seen.performance, np.random.default_rng([config.seed, 10]))
        movement = Movement(seen.movement.name, body.tick_s, body.sensations(found.angles))
        seen = replace(seen, movement=movement, angles=found.angles, learned=found)
    print("imitating ...", file=sys.stderr) if sys.stderr.isatty() else None
    perform = partial(imitate, body, seen.movement, mind, witness=lambda: body.joint_angles)
    rng = np.random.default_rng([config.seed, 8])
    attempts = perform(selection=config.selection, attempts=config.attempts, rng=rng)
    line = LinearInverse(mind.forward_model)
    eagerness = best_eagerness(body_of(config, len(EAGERNESS), stream=1), mind, line, config.seed)
    peer = perform(inverse=line, eagerness=eagerness, rng=np.random.default_rng([config.seed, 9]))[0]
    done = Performed(config, body, seen, learned, attempts, peer, direct_replay(body, seen.angles))
    metrics = measure(done)
    summary = summarise(metrics, seen)
    return Result(metrics, summary, figures(done, metrics), lambda path: record(path, done, summary))


def measure(done: Performed) -> dict[str, Any]:
    """The numbers of metrics.json."""
    config, body, seen, learned, last = done.config, done.body, done.seen, done.learned, done.attempts[-1]
    error = np.rad2deg(done.imitated - seen.angles)
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
        "joint_rmse_deg": float(np.sqrt(np.mean(error**2))),
        "joint_rmse_deg_by_joint": dict(zip(body.joints, np.sqrt(np.mean(error**2, axis=0)).tolist(), strict=True)),
        "attempts_rmse_deg": [rmse_deg(attempt.truth[:, 0], seen.angles) for attempt in done.attempts],
        "direct_replay_rmse_deg": rmse_deg(done.replayed, seen.angles),
        "linear_peer_rmse_deg": rmse_deg(done.peer.truth[:, 0], seen.angles),
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


def summarise(metrics: dict[str, Any], seen: Seen) -> str:
    """The result as a markdown table."""
    deg = {key: f"{value:.4f} deg" for key, value in metrics.items() if isinstance(value, float)}
    rows = [
        (f"joint error, imitated (attempt {len(metrics['attempts_rmse_deg'])})", deg["joint_rmse_deg"]),
        ("joint error, first attempt", f"{metrics['attempts_rmse_deg'][0]:.4f} deg"),
        ("joint error, direct replay", deg["direct_replay_rmse_deg"]),
        ("joint error, linear inverse model in the same loop", deg["linear_peer_rmse_deg"]),
        (
            "limb directions off, inverse kinematics (what this body cannot do included)",
            f"{metrics['retarget_error_deg']:.2f} deg",
        ),
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
        ("selections where Eq. (1) was 0/0", f"{metrics['uninformed_selections']} of {metrics['selections']}"),
        ("motors whose joint babbling found", f"{metrics['body_schema_correct_share']:.0%}"),
    ]
    title = f"**{seen.movement.name}**, {metrics['frames'] * metrics['tick']:.1f} s, by {metrics['robot']}"
    return f"{title}\n\n{table(rows)}"
