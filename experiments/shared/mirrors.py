"""In front of the mirror, and then in front of a teacher: a learned correspondence, and how far off it is."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from babbling.axes import BoolArray, FloatArray
from babbling.body_image import BodyImage, learn_image
from babbling.mirroring import MirrorExperience, angles_between, mirror_babble
from babbling.organs import find_organs
from babbling.pilot import Pilot
from experiments.errors import ExperimentError
from experiments.shared.minds import body_of
from experiments.shared.options import BodyOptions
from experiments.shared.oracle import Retargeted, at_ticks
from experiments.shared.watching import Seen
from imitation.correspondence.correspondence import correspond
from imitation.correspondence.likeness import recognised
from models.body import SimulatedBody
from models.mirror import Mirror, blurred
from models.teachers.performance import Performance, touching

COPIES = 64


def look_into_mirror(
    options: BodyOptions,
    pilot: Pilot,
    minutes: float,
    noise_deg: float = 0.0,
    report: Callable[[float], None] = lambda share: None,
) -> MirrorExperience:
    """Babble in front of the mirror; what is seen there is off by `noise_deg` across the line of sight."""
    body = body_of(options, COPIES, stream=11)
    mirror = Mirror(body, float(np.deg2rad(noise_deg)), options.seed)
    return mirror_babble(body, mirror, pilot.schema, pilot.motors, minutes, options.seed, report)


def image_of(experience: MirrorExperience, options: BodyOptions, pilot: Pilot) -> BodyImage:
    """Organ identification and body image."""
    body = body_of(options, 1, stream=12)
    lines = pilot.schema.posture
    rest = body.reset()[0][lines]
    organs = find_organs(experience)
    low, high = body.sense_low[lines], body.sense_high[lines]
    return learn_image(experience, organs, low, high, rest, options.seed, body.fingerprint)


@dataclass(frozen=True, eq=False)
class Pupil:
    """Who sees teachers with a learned body image; it sees with noise, `noise_deg` across the line of sight. Unless
    their parts are `named` as its own, it has to recognise them."""

    body: SimulatedBody
    pilot: Pilot
    image: BodyImage
    noise_deg: float = 0.0
    named: bool = True

    def look(self, directions: FloatArray, rng: np.random.Generator) -> FloatArray:
        """(..., 3) directions as they are seen."""
        return blurred(directions, float(np.deg2rad(self.noise_deg)), rng)

    def follow(
        self, performance: Performance, rng: np.random.Generator, hidden: Mapping[str, BoolArray] | None = None
    ) -> Retargeted:
        """See a teacher, with parts `hidden` (T,) now and then, and find one's own postures for it."""
        body, image = self.body, self.image
        teacher = at_ticks(performance, body.tick_s)
        seen = {part: self.look(values, rng) for part, values in teacher.items()}
        visible = {}
        for part, away in (hidden or {}).items():
            visible[part] = ~away
            seen[part] = np.where(away[:, None], np.nan, seen[part])
        taken = {part: part for part in image.parts if part in seen} if self.named else self.recognise(seen, rng)
        seen = {own: seen[it] for own, it in taken.items()}
        visible = {own: visible[it] for own, it in taken.items() if it in visible}
        speed = body.sense_high[self.pilot.schema.rate]
        found = correspond(image, performance.name, seen, body.tick_s, speed, visible)
        angles = self.angles(found.postures)
        shown = Mirror(body).shown(angles)[:, [image.parts.index(part) for part in found.parts]]
        meant = {part: teacher.get(part, teacher[taken[part]]) for part in found.parts}
        apart = {part: np.rad2deg(angles_between(meant[part], teacher[it]).max()) for part, it in taken.items()}
        mistaken = {part: float(away) for part, away in apart.items() if taken[part] != part}
        return Retargeted(found, angles, shown, np.stack([*meant.values()], 1), mistaken)

    def recognise(self, seen: Mapping[str, FloatArray], rng: np.random.Generator) -> dict[str, str]:
        """Own part -> the part of (T, 3) `seen` that is taken for it; they are shown in any order, without names."""
        theirs = [list(seen)[number] for number in rng.permutation(len(seen))]
        looks, tick_s = np.stack([seen[part] for part in theirs], 1), self.body.tick_s
        found = recognised(self.image, looks, tick_s, rng, touching(theirs))
        return {self.image.parts[own]: theirs[number] for own, number in sorted(found.items())}

    def angles(self, postures: FloatArray) -> FloatArray:
        """(T, J) joint angles in the body's order for (T, F) postures, for those who judge."""
        labels = [self.body.sense_labels[line] for line in self.pilot.schema.posture]
        if not set(labels) >= set(self.body.joints):
            raise ExperimentError("babbling did not find every joint's posture sense; babble longer")
        return np.asarray(postures[:, [labels.index(joint) for joint in self.body.joints]])


def limbs_off_deg(mirror: Mirror, angles: FloatArray, aims: Mapping[str, FloatArray]) -> FloatArray:
    """(T, P) degrees between where a body's parts point at (T, J) joint angles and (T, 3) aims, by part."""
    shown = mirror.shown(angles)[:, [mirror.parts.index(part) for part in aims]]
    return np.asarray(np.rad2deg(angles_between(shown, np.stack([*aims.values()], 1))))


def correspondence_metrics(seen: Seen, tick_s: float) -> dict[str, Any]:
    """How well limb directions could be met at all, by the oracle and by the learned correspondence where inverse
    kinematics can reach; zeros when joint angles were given.

    unreachable_frames: summed over parts, each of which is in or out of reach by itself.
    correspond_p50_ms: processor time of the whole movement, all limbs, per frame.
    """
    oracle, learned = seen.oracle, seen.learned
    if oracle is None:
        return {"retarget_error_deg": 0.0, "retarget_reachable_error_deg": 0.0, "unreachable_share": 0.0}
    reachable = oracle.found.reachable
    within = oracle.mean_error_deg(reachable)
    metrics = {
        "retarget_error_deg": float(oracle.error_deg.mean()),
        "retarget_reachable_error_deg": within,
        "unreachable_share": float(1 - reachable.mean()),
        "retarget_error_deg_by_part": oracle.error_deg_by_part,
        "ik_limb_direction_error_deg": within,
        "limb_direction_error_deg": (learned or oracle).mean_error_deg(reachable),
        "unreachable_frames": int((~reachable).sum()),
    }
    if learned is None:
        return metrics
    pace = learned.speeds(tick_s)
    return metrics | {
        "limb_direction_error_deg_by_part": learned.error_deg_by_part,
        "seeing_noise_found_deg": float(np.rad2deg(learned.found.noise.mean())),
        "sub_goal_speed_q999": float(np.quantile(pace, 0.999)),
        "sub_goal_speed_max": float(pace.max()),
        "correspond_p50_ms": 1e3 * learned.found.seconds / len(learned.angles),
        **learned.recognised,
    }
