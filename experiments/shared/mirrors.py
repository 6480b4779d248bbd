"""In front of the mirror, and then in front of a teacher: a learned correspondence, and how far off it is."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from babbling.body_image import BodyImage, learn_image
from babbling.image_storage import load_image
from babbling.mirroring import MirrorExperience, mirror_babble
from babbling.organs import find_organs
from babbling.pilot import Pilot
from experiments.errors import ExperimentError
from experiments.shared.judging import degrees_between
from experiments.shared.minds import body_of
from experiments.shared.options import MIRROR_MINUTES, BodyOptions
from experiments.shared.watching import Seen
from imitation.acting.movement import Movement
from imitation.correspondence.correspondence import SubGoals, correspond
from models.body import SimulatedBody
from models.mirror import Mirror, blurred
from models.retargeting import Retargeted
from models.teachers.performance import Performance, unit

COPIES = 64
FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Eyes:
    """How well one sees, and how long one looks into the mirror."""

    noise_deg: float = 0.0
    minutes: float = MIRROR_MINUTES


@dataclass(frozen=True)
class Corresponded:
    """A movement that went through the learned correspondence, for those who judge.

    angles (T, J): the sub-goals in the body's own joint order. directions (T, P, 3): where the body really points with
    them; teacher (T, P, 3): where the teacher pointed; both in the order of sub_goals.parts. error_deg: part -> (T,).
    """

    image: BodyImage
    sub_goals: SubGoals
    angles: FloatArray
    directions: FloatArray
    teacher: FloatArray
    error_deg: Mapping[str, FloatArray]


def look_into_mirror(
    options: BodyOptions, pilot: Pilot, eyes: Eyes, report: Callable[[float], None] = lambda share: None
) -> MirrorExperience:
    """Babble in front of the mirror."""
    body = body_of(options, COPIES, stream=11)
    mirror = Mirror(body, float(np.deg2rad(eyes.noise_deg)), options.seed)
    return mirror_babble(body, mirror, pilot.schema, pilot.motors, eyes.minutes, options.seed, report)


def image_of(experience: MirrorExperience, options: BodyOptions, pilot: Pilot) -> BodyImage:
    """Organ identification and body image."""
    body = body_of(options, 1, stream=12)
    lines = pilot.schema.posture
    rest = body.reset()[0][lines]
    organs = find_organs(experience)
    return learn_image(experience, organs, body.sense_low[lines], body.sense_high[lines], rest, options.seed)


def take_image(
    path: Path | None, options: BodyOptions, pilot: Pilot, eyes: Eyes, report: Callable[[float], None]
) -> tuple[BodyImage, dict[str, Any]]:
    """A body image from a file, or learned now; and what it cost."""
    if path is not None:
        image = load_image(path, body_of(options, 1).fingerprint)
        return image, {"mirror_body_minutes": image.minutes, "mirror_wall_s": 0.0}
    started = time.perf_counter()
    image = image_of(look_into_mirror(options, pilot, eyes, report), options, pilot)
    return image, {"mirror_body_minutes": image.minutes, "mirror_wall_s": time.perf_counter() - started}


def at_ticks(performance: Performance, tick_s: float, frames: int) -> dict[str, FloatArray]:
    """Part -> (T, 3) directions of a teacher at the imitator's ticks, seen without noise."""
    time_s = np.arange(frames) * tick_s
    return {
        part: unit(CubicSpline(performance.time, values, axis=0)(time_s))
        for part, values in performance.directions.items()
    }


def through_mirror(
    image: BodyImage,
    body: SimulatedBody,
    pilot: Pilot,
    performance: Performance,
    frames: int,
    noise_deg: float,
    rng: np.random.Generator,
    hidden: Mapping[str, NDArray[np.bool_]] | None = None,
) -> Corresponded:
    """See a teacher, with noise and with parts `hidden` (T,) now and then, and find one's own postures for it."""
    teacher = at_ticks(performance, body.tick_s, frames)
    seen = {part: blurred(values, float(np.deg2rad(noise_deg)), rng) for part, values in teacher.items()}
    visible = {}
    for part, away in (hidden or {}).items():
        visible[part] = ~away
        seen[part] = np.where(away[:, None], np.nan, seen[part])
    schema = pilot.schema
    sub_goals = correspond(image, performance.name, seen, body.tick_s, body.sense_high[schema.rate], visible)
    angles = angles_of(sub_goals.postures, body, pilot)
    shown = Mirror(body).shown(angles)
    places = [image.parts.index(part) for part in sub_goals.parts]
    directions = shown[:, places]
    wanted = np.stack([teacher[part] for part in sub_goals.parts], 1)
    error = degrees_between(directions, wanted)
    by_part = {part: error[:, number] for number, part in enumerate(sub_goals.parts)}
    return Corresponded(image, sub_goals, angles, directions, wanted, by_part)


def angles_of(postures: FloatArray, body: SimulatedBody, pilot: Pilot) -> FloatArray:
    """(T, J) joint angles in the body's order for (T, F) postures, for those who judge."""
    labels = [body.sense_labels[line] for line in pilot.schema.posture]
    if not set(labels) >= set(body.joints):
        raise ExperimentError("babbling did not find every joint's posture sense; babble longer")
    found: FloatArray = postures[:, [labels.index(joint) for joint in body.joints]]
    return found


def seen_in_mirror(seen: Seen, corresponded: Corresponded, body: SimulatedBody) -> Seen:
    """What was watched, with the sub-goals of the learned correspondence in place of the oracle's."""
    movement = Movement(seen.movement.name, body.tick_s, body.sensations(corresponded.angles))
    return replace(seen, movement=movement, angles=corresponded.angles, corresponded=corresponded)


def correspondence_metrics(
    corresponded: Corresponded | None, oracle: Retargeted | None, tick_s: float
) -> dict[str, Any]:
    """The learned correspondence and the oracle where inverse kinematics can reach.

    unreachable_frames: summed over parts, each of which is in or out of reach by itself.
    correspond_p50_ms: processor time of the whole movement, all limbs, per frame.
    """
    if oracle is None:
        return {}
    own = {} if corresponded is None else corresponded.error_deg
    parts = [part for part in oracle.error_deg if part in own] or list(oracle.error_deg)
    reach = {part: oracle.reachable[part] for part in parts}
    metrics = {
        "ik_limb_direction_error_deg": _mean(oracle.error_deg, reach),
        "limb_direction_error_deg": _mean(own or oracle.error_deg, reach),
        "unreachable_frames": int(sum((~reach[part]).sum() for part in parts)),
    }
    if corresponded is None:
        return metrics
    pace = np.abs(np.diff(corresponded.angles, axis=0))
    goals = corresponded.sub_goals
    return metrics | {
        "limb_direction_error_deg_by_part": {part: float(own[part].mean()) for part in parts},
        "seeing_noise_found_deg": float(np.rad2deg(goals.noise.mean())),
        "sub_goal_speed_q999": float(np.quantile(pace, 0.999) / tick_s),
        "sub_goal_speed_max": float(pace.max() / tick_s),
        "correspond_p50_ms": 1e3 * goals.seconds / len(goals.postures),
    }


def _mean(error: Mapping[str, FloatArray], reach: Mapping[str, NDArray[np.bool_]]) -> float:
    values = np.concatenate([error[part][reach[part]] for part in reach])
    return float(values.mean()) if len(values) else 0.0
