"""Whose body is this? A mirror, organ identification, and everybody's movements in one's own limbs (2.2, 3.2, 3.5)."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from babbling.body_image import BodyImage
from babbling.errors import BabblingError
from babbling.image_storage import save_image
from babbling.mirroring import MirrorExperience
from babbling.pilot import Pilot, pilot
from babbling.storage import load_mind
from experiments.correspondence.acts import Acts, act_study
from experiments.correspondence.figures import figures
from experiments.correspondence.options import Config
from experiments.correspondence.recording import record
from experiments.shared import minds
from experiments.shared.experiment import Result
from experiments.shared.minds import body_of
from experiments.shared.mirrors import Eyes, image_of, look_into_mirror, through_mirror
from experiments.shared.options import BodyOptions
from experiments.shared.oracle import Retargeted, retarget
from experiments.shared.progress import progress
from models.body import SimulatedBody
from models.mirror import blurred
from models.teachers.performance import Performance
from models.teachers.performing import perform

HIDDEN_S = 1.0
CURVE_POINTS = 4
"""Of the learning curve, each with half the time of the next."""


@dataclass(frozen=True)
class Row:
    """One teacher: the oracle, and the learned correspondence with clean and with noisy eyes."""

    performance: Performance
    oracle: Retargeted
    clean: Retargeted
    noisy: Retargeted

    def error_deg(self, who: Retargeted) -> float:
        """Mean over the parts and frames that inverse kinematics can reach."""
        return who.mean_error_deg(self.oracle.found.reachable)


@dataclass(frozen=True)
class Hidden:
    """One part hidden for a second while it moved most, with noisy eyes."""

    demonstration: str
    part: str
    error_deg: float
    """Mean over all parts and frames."""
    seen_error_deg: float
    """The same when nothing was hidden."""
    worst_speed: float
    """Fastest joint of the sub-goals, rad/s."""


@dataclass(frozen=True)
class Studied:
    """Everything one run found."""

    config: Config
    body: SimulatedBody
    pilot: Pilot
    image: BodyImage
    noisy_image: BodyImage
    rows: dict[str, Row]
    curve: NDArray[np.float64]
    """(K, 3) body-minutes, error with clean and with noisy eyes, degrees."""
    hidden: list[Hidden]
    acts: Acts
    metrics: dict[str, Any]
    summary: str

    @property
    def shown(self) -> Row:
        """The teacher of the recording."""
        return self.rows.get(self.config.shown) or next(iter(self.rows.values()))


def run(config: Config) -> Result:
    """Babble in front of the mirror, then be shown everything."""
    config.check()
    clean, noisy = Eyes(0.0, config.mirror_minutes), Eyes(config.seeing_noise_deg, config.mirror_minutes)
    options = BodyOptions(scramble=config.scramble, seed=config.seed, threads=config.threads)
    body = body_of(options, 1, stream=13)
    performances = {name: perform(name) for name in config.demonstrations}
    if config.forward_model is not None:
        mind, _ = load_mind(config.forward_model)
        mind.check(body)
        found = mind.pilot
    else:
        found = pilot(body_of(options, minds.COPIES), config.seed)
    with progress("looks into a mirror") as report:
        experience = look_into_mirror(options, found, clean, report)
    blurry = blur(experience, noisy.noise_deg, config.seed)
    image, noisy_image = (image_of(one, options, found) for one in (experience, blurry))
    rng = np.random.default_rng([config.seed, 14])
    rows = {}
    for name, performance in performances.items():
        rows[name] = Row(
            performance,
            retarget(performance, body.tick_s),
            through_mirror(image, body, found, performance, 0.0, rng),
            through_mirror(noisy_image, body, found, performance, noisy.noise_deg, rng),
        )
    curve = learning_curve(config, options, found, experience, blurry, body, rows)
    hidden = hide_parts(noisy_image, body, found, rows, noisy.noise_deg, rng)
    acts = act_study(noisy_image, body, found, config.acts, config.tries, noisy.noise_deg, config.seed)
    metrics = measure(config, body, image, rows, curve, hidden, acts)
    done = Studied(
        config, body, found, image, noisy_image, rows, curve, hidden, acts, metrics, summarise(metrics, rows)
    )
    return Result(
        metrics,
        done.summary,
        figures(done),
        lambda path: record(path, done),
        {"body_image.nc": lambda path: save_image(image, path, body.fingerprint, seed=config.seed)},
    )


def blur(experience: MirrorExperience, noise_deg: float, seed: int) -> MirrorExperience:
    """The same moments in front of the mirror, seen with noise."""
    rng = np.random.default_rng([seed, 15])
    seen = blurred(experience.directions, float(np.deg2rad(noise_deg)), rng)
    return MirrorExperience(experience.parts, experience.tick_s, experience.postures, seen, experience.acts)


def learning_curve(
    config: Config,
    options: BodyOptions,
    found: Pilot,
    experience: MirrorExperience,
    blurry: MirrorExperience,
    body: SimulatedBody,
    rows: dict[str, Row],
) -> NDArray[np.float64]:
    """(K, 3) minutes, and error on the shown demonstration with clean and noisy eyes; NaN where organs stay unknown."""
    row = rows.get(config.shown) or next(iter(rows.values()))
    points: list[list[float]] = []
    for minutes in config.mirror_minutes * 0.5 ** np.arange(CURVE_POINTS)[::-1]:
        point = [0.0]
        for one, noise in ((experience, 0.0), (blurry, config.seeing_noise_deg)):
            part = one.first(float(minutes))
            point[0] = part.minutes
            if points and point[0] <= points[-1][0]:  # no shorter than one cycle of leap and acts
                continue
            try:
                image = image_of(part, options, found)
                rng = np.random.default_rng([config.seed, 16])
                point.append(row.error_deg(through_mirror(image, body, found, row.performance, noise, rng)))
            except BabblingError:
                point.append(np.nan)
        if len(point) == 3:
            points.append(point)
    return np.array(points)


def hide_parts(
    image: BodyImage,
    body: SimulatedBody,
    found: Pilot,
    rows: dict[str, Row],
    noise_deg: float,
    rng: np.random.Generator,
) -> list[Hidden]:
    """In every demonstration the part that turns most within a second is hidden for just that second."""
    results = []
    for name, row in rows.items():
        teacher, parts = row.noisy.teacher, row.noisy.found.parts
        ticks = round(HIDDEN_S / body.tick_s)
        if len(teacher) < ticks + 20:
            continue
        turned = np.linalg.norm(teacher[ticks:] - teacher[:-ticks], axis=2)[5 : -5 or None]
        start, part = np.unravel_index(int(turned.argmax()), turned.shape)
        away = np.zeros(len(teacher), bool)
        away[start + 5 : start + 5 + ticks] = True
        found_now = through_mirror(image, body, found, row.performance, noise_deg, rng, {parts[int(part)]: away})
        pace = np.abs(np.diff(found_now.angles, axis=0)).max() / body.tick_s
        before, after = float(row.noisy.error_deg.mean()), float(found_now.error_deg.mean())
        results.append(Hidden(name, parts[int(part)], after, before, float(pace)))
    return results


def measure(
    config: Config,
    body: SimulatedBody,
    image: BodyImage,
    rows: dict[str, Row],
    curve: NDArray[np.float64],
    hidden: list[Hidden],
    acts: Acts,
) -> dict[str, Any]:
    """The numbers of metrics.json."""
    speeds = [np.abs(np.diff(who.angles, axis=0)) / body.tick_s for r in rows.values() for who in (r.clean, r.noisy)]
    per_frame = [1e3 * who.found.seconds / len(who.angles) for r in rows.values() for who in (r.clean, r.noisy)]
    table = {
        name: {
            "ik_deg": row.error_deg(row.oracle),
            "learned_deg": row.error_deg(row.clean),
            "learned_noisy_deg": row.error_deg(row.noisy),
            "unreachable_frames": int((~row.oracle.found.reachable).sum()),
            "frames": len(row.clean.angles),
            "speed_q999": max(float(np.quantile(np.abs(np.diff(who.angles, axis=0)), 0.999)) / body.tick_s
                              for who in (row.clean, row.noisy)),
        }
        for name, row in rows.items()
    }  # fmt: skip
    return {
        "seed": config.seed,
        "seeing_noise_deg": config.seeing_noise_deg,
        "mirror_body_minutes": image.minutes,
        "limb_direction_error_deg": float(np.mean([one["learned_deg"] for one in table.values()])),
        "limb_direction_error_noisy_deg": float(np.mean([one["learned_noisy_deg"] for one in table.values()])),
        "ik_limb_direction_error_deg": float(np.mean([one["ik_deg"] for one in table.values()])),
        "worst_beyond_ik_deg": float(max(one["learned_deg"] - one["ik_deg"] for one in table.values())),
        "worst_beyond_ik_noisy_deg": float(max(one["learned_noisy_deg"] - one["ik_deg"] for one in table.values())),
        "unreachable_frames": int(sum(one["unreachable_frames"] for one in table.values())),
        "sub_goal_speed_q999": float(max(np.quantile(one, 0.999) for one in speeds)),
        "sub_goal_speed_max": float(max(one.max() for one in speeds)),
        "correspond_p50_ms": float(np.median(per_frame)),
        "correspond_worst_ms": float(max(per_frame)),
        "organ_identification_rate": acts.rate,
        "first_try_error_deg": float(np.median(acts.errors_deg[:, 1])),
        "last_try_error_deg": float(np.median(acts.errors_deg[:, -1])),
        "hidden_error_ratio": float(max((h.error_deg / h.seen_error_deg for h in hidden), default=1.0)),
        "hidden_worst_speed": float(max((h.worst_speed for h in hidden), default=0.0)),
        "curve_body_minutes": curve[:, 0],
        "curve_clean_deg": curve[:, 1],
        "curve_noisy_deg": curve[:, 2],
        "organ_bits": {part: bits for part, bits in zip(image.parts, image.organs.information.max(1), strict=True)},
        "teachers": table,
    }


def summarise(metrics: dict[str, Any], rows: dict[str, Row]) -> str:
    """The result as markdown tables."""
    lines = [
        f"**Whose body is this?** {metrics['mirror_body_minutes']:.1f} body-minutes in front of a mirror, "
        f"{metrics['organ_identification_rate']:.1%} of single acts put to the right part",
        "",
        f"| teacher | inverse kinematics | learned | learned, {metrics['seeing_noise_deg']:g} deg of noise |",
        "|---|---|---|---|",
    ]
    for name, row in rows.items():
        one = metrics["teachers"][name]
        label = name if len(name) < 30 else Path(name).stem
        lines.append(
            f"| {label} ({row.performance.teacher}) | {one['ik_deg']:.3f} deg | {one['learned_deg']:.3f} deg "
            f"| {one['learned_noisy_deg']:.2f} deg |"
        )
    lines += [
        "",
        f"Fastest sub-goals (99.9 %): {metrics['sub_goal_speed_q999']:.2f} rad/s. "
        f"One frame, all limbs: {metrics['correspond_p50_ms']:.2f} ms. A part hidden for a second: error x "
        f"{metrics['hidden_error_ratio']:.2f} at worst. Single acts: {metrics['first_try_error_deg']:.1f} deg at the "
        f"first try, {metrics['last_try_error_deg']:.1f} deg at the last.",
    ]
    return "\n".join(lines)
