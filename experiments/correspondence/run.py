"""Whose body is this? A mirror, organ identification, and everybody's movements in one's own limbs (2.2, 3.2, 3.5)."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from babbling.errors import BabblingError
from babbling.files import load, save
from babbling.mind import Mind
from babbling.mirroring import MirrorExperience
from babbling.organs import find_organs
from babbling.pilot import pilot
from experiments.correspondence.acts import HARDER, RULES, act_study, harder_acts
from experiments.correspondence.figures import figures
from experiments.correspondence.found import Row, Studied
from experiments.correspondence.options import Config
from experiments.correspondence.recording import record
from experiments.shared import minds
from experiments.shared.experiment import Result
from experiments.shared.judging import Sweep
from experiments.shared.kept import once
from experiments.shared.minds import body_of
from experiments.shared.mirrors import Pupil, image_of, look_into_mirror
from experiments.shared.options import BodyOptions
from experiments.shared.oracle import retarget
from experiments.shared.progress import progress
from experiments.shared.tables import table
from models.mirror import blurred
from models.teachers.performing import perform

HIDDEN_S = 1.0
CURVE_POINTS = 4
"""Of the learning curve, each with half the time of the next."""


def run(config: Config) -> Result:
    """Babble in front of the mirror, then be shown everything."""
    config.check()
    options = BodyOptions(scramble=config.scramble, seed=config.seed, threads=config.threads)
    body = body_of(options, 1, stream=13)
    performances = {name: perform(name) for name in config.demonstrations}
    if config.forward_model is not None:
        mind = load(config.forward_model, Mind)
        mind.check(body)
        found = mind.pilot
    else:
        found = pilot(body_of(options, minds.COPIES), config.seed)
    with progress("looks into a mirror") as report:
        experience = once(look_into_mirror, options, found, config.mirror_minutes, report=report)
    noise = float(np.deg2rad(config.seeing_noise_deg))
    seen = blurred(experience.directions, noise, np.random.default_rng([config.seed, 15]))
    blurry = replace(experience, directions=seen)
    clean, noisy = (
        Pupil(body, found, image_of(one, options, found), noise, config.parts == "named")
        for one, noise in ((experience, 0.0), (blurry, config.seeing_noise_deg))
    )
    rng = np.random.default_rng([config.seed, 14])
    rows = {
        name: Row(seen, retarget(seen, body.tick_s), clean.follow(seen, rng), noisy.follow(seen, rng))
        for name, seen in performances.items()
    }
    shown = rows.get(config.shown) or next(iter(rows.values()))
    curve = once(learning_curve, config, options=options, row=shown, looks=[(clean, experience), (noisy, blurry)])
    hidden = hide_parts(noisy, rows, rng)
    acts = act_study(noisy, config.acts, config.tries, config.seed)
    with progress("harder acts") as report:
        others = (replace(options, seed=options.seed + k) for k in range(1, config.learners))
        looks = (once(look_into_mirror, one, found, config.mirror_minutes, config.seeing_noise_deg) for one in others)
        organs = [noisy.image.organs, *map(find_organs, looks)]
        harder = harder_acts(organs, config.harder_acts, body.tick_s, config.seed, report)
    done = Studied(config, clean, noisy, rows, shown, curve, hidden, acts, harder)
    metrics = measure(done)
    summary = summarise(metrics, rows, done.harder)
    labels = {"factor": [body.sense_labels[line] for line in found.schema.posture]}
    files = {"body_image.nc": lambda path: save(clean.image, path, labels, seed=config.seed)}
    made = figures(done)
    return Result(metrics, summary, made, lambda path: record(path, done, summary, made["structure"]), files)


def learning_curve(
    config: Config, options: BodyOptions, row: Row, looks: list[tuple[Pupil, MirrorExperience]]
) -> FloatArray:
    """(K, 3) minutes, and error on the shown demonstration with clean and noisy eyes; NaN where organs stay unknown."""

    def error_deg(pupil: Pupil, part: MirrorExperience) -> float:
        try:
            younger = replace(pupil, image=image_of(part, options, pupil.pilot))
        except BabblingError:
            return np.nan
        return row.error_deg(younger.follow(row.performance, np.random.default_rng([config.seed, 16])))

    points = dict[float, list[float]]()
    for minutes in config.mirror_minutes * 0.5 ** np.arange(CURVE_POINTS)[::-1]:
        parts = [(pupil, experience.first(float(minutes))) for pupil, experience in looks]
        if (at := parts[0][1].minutes) not in points:  # no shorter than one cycle of leap and acts
            points[at] = [error_deg(*each) for each in parts]
    return np.array([[at, *errors] for at, errors in points.items()])


def hide_parts(pupil: Pupil, rows: dict[str, Row], rng: np.random.Generator) -> FloatArray:
    """In every demonstration the part that turns most within a second is hidden for just that second."""
    results: list[tuple[float, float]] = []
    tick_s = pupil.body.tick_s
    for row in rows.values():
        teacher, parts = row.noisy.teacher, row.noisy.found.parts
        ticks = round(HIDDEN_S / tick_s)
        if len(teacher) < ticks + 20:
            continue
        turned = np.linalg.norm(teacher[ticks:] - teacher[:-ticks], axis=2)[5 : -5 or None]
        start, part = np.unravel_index(int(turned.argmax()), turned.shape)
        away = np.zeros(len(teacher), bool)
        away[start + 5 : start + 5 + ticks] = True
        found = pupil.follow(row.performance, rng, {parts[int(part)]: away})
        results.append((found.error_deg.mean() / row.noisy.error_deg.mean(), found.speeds(tick_s).max()))
    return np.array(results).reshape(-1, 2)


def measure(done: Studied) -> dict[str, Any]:
    """The numbers of metrics.json."""
    image, acts, hidden = done.clean.image, done.acts, done.hidden
    learned = [who for row in done.rows.values() for who in (row.clean, row.noisy)]
    speeds = [who.speeds(done.clean.body.tick_s) for who in learned]
    per_frame = [1e3 * who.found.seconds / len(who.angles) for who in learned]
    teachers = {
        name: {
            "ik_deg": row.error_deg(row.oracle),
            "learned_deg": row.error_deg(row.clean),
            "learned_noisy_deg": row.error_deg(row.noisy),
            "unreachable_frames": int((~row.oracle.found.reachable).sum()),
            "frames": len(row.clean.angles),
            **{kind: (share + row.noisy.recognised[kind]) / 2 for kind, share in row.clean.recognised.items()},
        }
        for name, row in done.rows.items()
    }
    column = {kind: np.array([one[kind] for one in teachers.values()]) for kind in next(iter(teachers.values()))}
    minutes, clean_deg, noisy_deg = done.curve.T
    return {
        "seed": done.config.seed,
        "seeing_noise_deg": done.config.seeing_noise_deg,
        "mirror_body_minutes": image.minutes,
        "limb_direction_error_deg": column["learned_deg"].mean(),
        "limb_direction_error_noisy_deg": column["learned_noisy_deg"].mean(),
        "ik_limb_direction_error_deg": column["ik_deg"].mean(),
        "worst_beyond_ik_deg": (column["learned_deg"] - column["ik_deg"]).max(),
        "worst_beyond_ik_noisy_deg": (column["learned_noisy_deg"] - column["ik_deg"]).max(),
        "unreachable_frames": column["unreachable_frames"].sum(),
        "sub_goal_speed_q999": float(max(np.quantile(one, 0.999) for one in speeds)),
        "sub_goal_speed_max": float(max(one.max() for one in speeds)),
        "correspond_p50_ms": float(np.median(per_frame)),
        "parts_right_share": column["parts_right_share"].mean(),
        "parts_alike_share": column["parts_alike_share"].mean(),
        "organ_identification_rate": acts.rate,
        "organ_harder": {name: sweep.numbers() for name, sweep in done.harder.items()},
        "first_try_error_deg": float(np.median(acts.errors_deg[:, 1])),
        "last_try_error_deg": float(np.median(acts.errors_deg[:, -1])),
        "last_try_error_q75_deg": float(np.quantile(acts.errors_deg[:, -1], 0.75)),
        "least_error_own_joints_q75_deg": float(np.quantile(acts.least_deg[:, 0], 0.75)),
        "least_error_all_joints_q75_deg": float(np.quantile(acts.least_deg[:, 1], 0.75)),
        "try_error_beyond_least_deg": float(np.median(np.maximum(acts.errors_deg[:, -1] - acts.least_deg[:, 0], 0))),
        "hidden_error_ratio": hidden[:, 0].max() if len(hidden) else 1.0,
        "hidden_worst_speed": hidden[:, 1].max(initial=0.0),
        "curve_body_minutes": minutes,
        "curve_clean_deg": clean_deg,
        "curve_noisy_deg": noisy_deg,
        "organ_bits": dict(zip(image.parts, image.organs.information.max(1), strict=True)),
        "teachers": teachers,
    }


def summarise(metrics: dict[str, Any], rows: dict[str, Row], found: Mapping[str, Sweep]) -> str:
    """The result as a markdown table, with a line before and after it."""
    shown = [
        (
            row.label,
            *(f"{metrics['teachers'][name][who]:.3f}" for who in ("ik_deg", "learned_deg", "learned_noisy_deg")),
        )
        for name, row in rows.items()
    ]
    harder = [
        (
            HARDER[name][0],
            " ".join(f"{100 * r:.0f}" for r in sweep.right[:, 0].mean(0)) + " %",
            *(gap for _, gap in sweep.told()),
        )
        for name, sweep in found.items()
    ]
    return (
        f"**Whose body is this?** {metrics['mirror_body_minutes']:.1f} body-minutes in front of a mirror, "
        f"{metrics['organ_identification_rate']:.1%} of single acts put to the right part\n\n"
        f"{table(shown, ('teacher', 'inverse kinematics [deg]', 'learned', 'with noisy eyes'))}\n\n"
        f"Fastest sub-goals (99.9 %): {metrics['sub_goal_speed_q999']:.2f} rad/s. "
        f"One frame, all limbs: {metrics['correspond_p50_ms']:.2f} ms. A part hidden for a second: error x "
        f"{metrics['hidden_error_ratio']:.2f} at worst. Single acts: {metrics['first_try_error_deg']:.1f} deg at the "
        f"first try, {metrics['last_try_error_deg']:.1f} deg at the last (medians); a quarter stays above "
        f"{metrics['last_try_error_q75_deg']:.1f} deg, where the part's own joints come no nearer than "
        f"{metrics['least_error_own_joints_q75_deg']:.1f} deg for a quarter, and all joints than "
        f"{metrics['least_error_all_joints_q75_deg']:.1f}.\n\n"
        f"{table(harder, ('acts harder by', 'Eq. (1), from easy to hard', *(f'points beyond {r}' for r in RULES[1:])))}"
    )
