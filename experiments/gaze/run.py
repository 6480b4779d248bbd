"""A teacher turns its head to one of several toys; the imitator infers which, by Eq. (2), and looks there."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from babbling.files import load, save
from babbling.looking import LookingMind
from experiments.errors import ExperimentError
from experiments.gaze.covered import covered_eyes
from experiments.gaze.crowds import crowds
from experiments.gaze.figures import figures
from experiments.gaze.found import Found
from experiments.gaze.infer import infer, preferences
from experiments.gaze.options import Config
from experiments.gaze.recording import record
from experiments.gaze.scene import episode
from experiments.gaze.trials import (
    COPIES,
    PAIR,
    TOYS,
    Trials,
    Watcher,
    lesson_for_gaze,
    run_trials,
    shown,
    table_body,
    view,
)
from experiments.shared.caregiver import TURN_S
from experiments.shared.experiment import Result
from experiments.shared.eyes import learn_to_look, nursery
from experiments.shared.judging import calibration_error, more_often
from experiments.shared.kept import once
from experiments.shared.progress import part, progress
from experiments.shared.tables import table
from models.biclops.gaze import BALL_RADIUS, possible
from models.robots import head_of

LESSONS, FAR_M = 400, 10.0
SHOWN_TRIALS = 80
PREFERENCE_TRIALS = 100
PREFERENCE = (0.2, 0.8)
"""How often the teacher looks at either of `PAIR` when both are there."""
PUPILS = 5
"""Who meet the crowds: each babbles, is mirrored and is shown by itself."""
STUDY = {"clear": 200, "pairs": 600, "calibration": 1000, "covered": 100, "crowds": 60}
SHORT = {"clear": 40, "pairs": 60, "calibration": 80, "covered": 20}


def run(config: Config) -> Result:
    """Babble (or recall), be mirrored, be shown, follow.

    Raises:
        ExperimentError, BodyError, BabblingError: options that cannot be meant.
    """
    layout = _check(config)
    naive = _pupil(config)
    mind = naive.eyes
    lessons, clear_trials, with_likes, close, many, covered = once(_met, config, naive=naive)
    who = shown(naive, lessons)
    clear = infer(who, clear_trials, TOYS).argmax(1) == clear_trials.target
    likes = preferences(who, with_likes, PAIR)
    plain = close._replace(salience=np.ones_like(close.salience))
    alone = infer(who, plain, PAIR).argmax(1) == close.target
    preferred = infer(who, close, PAIR, likes).argmax(1) == close.target
    belief = infer(who, many, TOYS, preferences(who, lessons, TOYS))
    error, bins = calibration_error(belief.max(1), belief.argmax(1) == many.target)
    close_by = None
    if config.study:
        pupils = [naive, *(_pupil(replace(config, seed=config.seed + k)) for k in range(1, PUPILS))]
        with progress("beads that lie close") as report:
            close_by = crowds(pupils, STUDY["crowds"], report)
    shown_episode = episode(who, layout, config.target, config.seed)
    found = Found(who, clear_trials, clear, alone, preferred, likes, bins, error, covered, shown_episode, close_by)
    metrics = _metrics(config, found)
    summary = _summary(metrics, found)
    labels = {"motor": head_of(config.robot).motors}
    files = {"eyes.nc": lambda path: save(mind, path, labels, robot=config.robot, seed=config.seed)}
    recorded = partial(record, robot=config.robot, one=found.episode, summary=summary, seed=config.seed)
    return Result(metrics, summary, figures(found), recorded, files)


def _met(config: Config, naive: Watcher) -> tuple[Trials, Trials, Trials, Trials, Trials, dict[str, Any]]:
    """Trials of being shown, following, a teacher with preferences (toys apart, then close), calibration; and covered
    eyes."""
    counts, rng = STUDY if config.study else SHORT, np.random.default_rng([config.seed, 0x6A2E])
    body = table_body(config, COPIES, config.seed + 11, TURN_S)
    with progress("being shown") as report:
        lessons = run_trials(body, naive, SHOWN_TRIALS, rng, report=report)
        who = shown(naive, lessons)
    with progress("following gaze") as report:
        clear = run_trials(
            body, who, counts["clear"], rng, report=report, follow=lambda seen: infer(who, seen, TOYS).argmax(1)
        )
    with progress("a teacher with preferences") as report:
        meet = partial(run_trials, body, who, rng=rng, toys=PAIR, preference=PREFERENCE)
        first = PREFERENCE_TRIALS / (PREFERENCE_TRIALS + counts["pairs"])
        with_likes = meet(PREFERENCE_TRIALS, apart_deg=(15.0, 60.0), report=part(report, 0, first))
        close = meet(counts["pairs"], apart_deg=(5.7, 6.3), report=part(report, first, 1))
    with progress("calibration") as report:
        many = run_trials(body, who, counts["calibration"], rng, apart_deg=(5.0, 180.0), report=report)
    with progress("covered eyes") as report:
        covered = covered_eyes(body, who, counts["covered"], np.random.default_rng([config.seed, 7]), report)
    return lessons, clear, with_likes, close, many, covered


def _check(config: Config) -> FloatArray | None:
    """Refuse options that cannot be meant; the places of the recorded episode, if given."""
    config.check()
    seen = view(config)
    if config.objects is None:
        if not 0 <= config.target <= 4:
            raise ExperimentError(f"--target {config.target}: 1 to 4, or 0 for chance")
        return None
    try:
        pairs = [tuple(float(x) for x in part.split(",")) for part in config.objects.split(";")]
        places = np.array([(x, y, BALL_RADIUS) for x, y in pairs])
    except ValueError:
        raise ExperimentError(f"--objects {config.objects}: give x,y;x,y in metres, such as 0.5,0.2;0.5,-0.2") from None
    if not 2 <= len(places) <= len(TOYS) or not (np.abs(places) < FAR_M).all():
        raise ExperimentError(f"--objects: {len(places)} toys; 2 to {len(TOYS)} within {FAR_M:g} m are possible")
    if not 0 <= config.target <= len(places):
        raise ExperimentError(f"--target {config.target}: there are {len(places)} objects; 1 is the first, 0 chance")
    for number, place in enumerate(places, 1):
        if not possible(place[None], config.distance, seen, (0.0, 180.0)):
            raise ExperimentError(
                f"--objects: object {number} at {place[0]:g},{place[1]:g} m is outside every direction that both heads "
                f"can look in; between them, 0.35 to 0.65 m ahead and up to 0.2 m aside, all can be seen"
            )
    return places


def _eyes(config: Config) -> LookingMind:
    if config.learned_eyes is not None:
        mind = load(config.learned_eyes, LookingMind)
        mind.check(nursery(config, 0, copies=1))
        return mind
    body = nursery(config, config.seed)
    with progress("looking about") as report:
        return learn_to_look(body, config.babbling_minutes, config.seed, report=report)


def _pupil(config: Config) -> Watcher:
    mind = once(_eyes, config)
    with progress("the caregiver mirrors") as report:
        return lesson_for_gaze(config, mind, LESSONS, config.seed, report)


def _metrics(config: Config, found: Found) -> dict[str, Any]:
    looked, gaze = found.trials.looked, found.who.gaze
    prior = found.likes.prior(PAIR, np.ones(2))
    return {
        "robot": config.robot,
        "babbling_body_minutes": found.who.eyes.minutes,
        "gaze_trials": len(found.clear),
        "gaze_accuracy": float((looked[:, 0] == found.trials.target).mean()),
        "gaze_inferred_accuracy": float(found.clear.mean()),
        "gaze_looked_px": float(np.nanmedian(looked[:, 1])),
        "gaze_ambiguous_trials": len(found.alone),
        "gaze_accuracy_ambiguous_alone": float(found.alone.mean()),
        "gaze_accuracy_ambiguous_with_preferences": float(found.preferred.mean()),
        "gaze_preference_margin": float(found.preferred.mean() - found.alone.mean()),
        "gaze_preferences_help": more_often(found.preferred, found.alone).numbers,
        "gaze_learned_preference": float(prior[1]),
        "gaze_calibration_trials": int(found.calibration[:, 2].sum()),
        "gaze_calibration_error": found.calibration_error,
        "gaze_calibration_bins": found.calibration,
        "gaze_learned_origin": gaze.origin,
        "gaze_learned_eyes_deg": np.rad2deg(gaze.geometry.stand),
        "gaze_learned_spread_deg": np.rad2deg(np.sqrt(np.diag(gaze.covariance))),
        "gaze_blindfold": found.covered,
        **(found.crowds.numbers() if found.crowds else {}),
    }


def _summary(metrics: dict[str, Any], found: Found) -> str:
    m, rates, signs = metrics, metrics["gaze_blindfold"]["rates"], metrics["gaze_blindfold"]["signs"]
    rows = [
        (f"looked at the right one of 4 toys, {m['gaze_trials']} trials", f"{m['gaze_accuracy']:.1%}"),
        ("how far from the middle", f"{m['gaze_looked_px']:.2f} px"),
        (f"{m['gaze_ambiguous_trials']} pairs 6 deg apart, gaze alone", f"{m['gaze_accuracy_ambiguous_alone']:.1%}"),
        ("with learned preferences", f"{m['gaze_accuracy_ambiguous_with_preferences']:.1%}"),
        ("preferences help", m["gaze_preferences_help"]["said"]),
        (f"calibration error, {m['gaze_calibration_trials']} trials", f"{m['gaze_calibration_error']:.3f}"),
        *(
            (f"followed, {name}", ", ".join(f"{cloth} {one['rate']:.0%}" for cloth, one in row.items()))
            for name, row in rates.items()
        ),
        *((name, sign["said"]) for name, sign in signs.items()),
    ]
    for name, sweep in found.crowds.sweeps.items() if found.crowds else ():
        gaps = (f"{gap} on {rule}" for rule, gap in sweep.told())
        less = m["gaze_crowds_less_log_loss"][name].items()
        loss = ", ".join(f"{m:.3f} ± {half:.3f} than {who}" for who, (m, half) in less)
        rows.append((f"beads, {name}", f"points: {'; '.join(gaps)}. Log loss less by {loss}"))
    return f"# {m['robot']} follows gaze\n\n{table(rows)}\n"
