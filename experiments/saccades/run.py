"""A head looks about at random and learns what its movements do to what it sees; then it looks where it wants to."""

import time
from typing import Any

import numpy as np

from babbling.files import save
from babbling.looking import LookingMind
from babbling.loop import Transitions
from experiments.saccades import trials
from experiments.saccades.figures import figures
from experiments.saccades.options import Config
from experiments.saccades.recording import Glance, record
from experiments.saccades.trials import Predicted, expected
from experiments.shared.experiment import Result
from experiments.shared.eyes import COPIES, TOYS, learn_to_look, nursery, toy_places
from experiments.shared.judging import LearningCurve
from experiments.shared.options import EyeOptions
from experiments.shared.progress import part, progress
from experiments.shared.tables import table
from imitation.gaze.fixation import Fixation
from models.onlooker import onlook
from models.robots import head_of

ONCE_PX, TWICE_PX = 1.5, 1.5
"""Pixels from the middle within which a thing counts as fixated after one saccade, after two."""
TEST_SACCADES, STUDY_SACCADES = 10, 40
"""Unseen saccades of each head for the prediction's error."""
TEST_ROUNDS, STUDY_ROUNDS = 4, 25
"""Fixations of each head."""
CURVE_POINTS = 12
ENOUGH = 2
"""Visits after which a toy is no news."""


def run(config: Config) -> Result:
    """Oculomotor babbling and its figures; the learned eyes are the file `eyes.nc` of the result.

    Raises:
        ExperimentError, BodyError, BabblingError: options that cannot be meant.
    """
    config.check()
    seed, selection = config.seed, config.selection
    body, other = nursery(config, seed), nursery(config, seed + 1000)
    start = time.perf_counter()
    other.reset()
    rounds, tests = (STUDY_ROUNDS, STUDY_SACCADES) if config.study else (TEST_ROUNDS, TEST_SACCADES)
    points: list[tuple[float, float, float]] = []
    with progress("looking about") as report:
        unseen: Predicted | None = None
        marks = np.linspace(0, 1, CURVE_POINTS + 1)[1:]

        def learned(done: float, mind: LookingMind) -> None:
            nonlocal unseen
            if unseen is None:
                unseen = trials.unseen_saccades(mind, other, tests, seed)
            if done >= marks[len(points)] - 1e-9 or not points:
                table, line = (unseen.error(expected(mind, unseen, table=t)).mean() for t in (True, False))
                points.append((mind.minutes + mind.pilot.minutes, table, line))

        notes: list[Transitions] = []
        mind = learn_to_look(body, config.babbling_minutes, seed, learned, notes, part(report, 0, 0.8))
        babble_s = time.perf_counter() - start
        assert unseen is not None
        speed = body.images_per_second()
        fixated = trials.fixate(mind, other, rounds, selection, seed, part(report, 0.8, 1))
    curve = LearningCurve(*np.array(points).T)
    glances = tour(mind, config, selection, seed)
    errors, copy = unseen.error(expected(mind, unseen)), unseen.error(expected(mind, unseen, table=False))
    straight = unseen.error(trials.straight_lines(mind, body, unseen, seed))
    metrics: dict[str, Any] = {
        "robot": config.robot,
        "babbling_body_minutes": mind.minutes,
        "pilot_body_minutes": mind.pilot.minutes,
        "babbling_transitions": mind.forward_model.transitions,
        "babbling_left_out": int(mind.forward_model.outside.sum()),
        "babbling_wall_s": babble_s,
        "saccade_trials": len(errors),
        "saccade_prediction_px": float(errors.mean()),
        "saccade_prediction_median_px": float(np.median(errors)),
        "saccade_prediction_p95_px": float(np.quantile(errors, 0.95)),
        "saccade_prediction_least_squares_px": float(unseen.error(trials.least_squares(mind, notes, unseen)).mean()),
        "saccade_prediction_efference_copy_px": float(copy.mean()),
        "saccade_prediction_straight_line_px": float(straight.mean()),
        "fixation_trials": len(fixated.once),
        "fixation_1_rate": float((fixated.once <= ONCE_PX).mean()),
        "fixation_2_rate": float((fixated.twice <= TWICE_PX).mean()),
        "fixation_1_px": float(np.mean(fixated.once[np.isfinite(fixated.once)])),
        "fixation_2_px": float(np.mean(fixated.twice[np.isfinite(fixated.twice)])),
        "fixation_uninformed": fixated.uninformed,
        "learning_curve_minutes": curve.minutes,
        "learning_curve_table_px": curve.table,
        "learning_curve_efference_copy_px": curve.line,
        "retina_images_per_s": speed,
    }
    summary, name = _summary(metrics), f"{config.robot} looks about, seed {seed}"
    toys = {toy: places[0] for toy, places in zip(TOYS, toy_places(1, seed), strict=True)}
    seen = onlook(body.model, config.robot, np.stack([g.angles for g in glances]), None, toys)
    labels = {"motor": head_of(config.robot).motors}
    return Result(
        metrics,
        summary,
        figures(mind, unseen, expected(mind, unseen), fixated, curve),
        lambda path: record(path, seen, head_of(config.robot).table, glances, summary, name),
        {"eyes.nc": lambda path: save(mind, path, labels, robot=config.robot, seed=seed)},
    )


def tour(mind: LookingMind, eyes: EyeOptions, selection: str, seed: int, looks: int = 18) -> list[Glance]:
    """One head looks at one toy after the other: what the recording shows."""
    body, fixation, rng = nursery(eyes, seed, copies=1), Fixation(mind, selection), np.random.default_rng([seed, 79])
    retina, reach = mind.pilot.retina, mind.pilot.reach
    senses, glances = body.reset(), list[Glance]()
    visits, last = np.zeros(len(TOYS), int), -1
    expected, event = np.full((len(TOYS), 4), np.nan), "at rest"
    while True:
        things, posture = retina.things(senses)[0], mind.pilot.posture(senses)
        places = (things + retina.centre, expected + retina.centre)
        glances.append(Glance(body.images[0], *places, body.joint_angles[0].copy(), event))
        if len(glances) > looks:
            return glances
        possible = np.flatnonzero(trials.within_reach(mind, things, posture[0]) & (np.arange(len(things)) != last))
        if len(possible) and visits[possible].min() < ENOUGH:
            last = int(rng.choice(possible[visits[possible] == visits[possible].min()]))
            visits[last] += 1
            change, event = fixation.choose(things[None, last], posture, rng).change, f"look at {TOYS[last]}"
        else:
            elsewhere = reach.low + (reach.high - reach.low) * rng.random((1, 2))
            change, event, last = elsewhere - posture, "nothing new in view: looks elsewhere", -1
        expected = mind.expect(things, np.repeat(posture, len(things), 0), np.repeat(change, len(things), 0))
        senses = body.act(mind.pilot.schema.motors(posture + change))


def _summary(metrics: dict[str, Any]) -> str:
    rows = [
        ("looked about", f"{metrics['babbling_body_minutes']:.1f} + {metrics['pilot_body_minutes']:.1f} body-minutes "
                         f"(pilot), {metrics['babbling_transitions']:,} sightings counted, {COPIES} heads"),
        ("where a thing will be after an unseen saccade", f"off by {metrics['saccade_prediction_px']:.3f} px on "
         f"average ({metrics['saccade_trials']} sightings; 95 % within {metrics['saccade_prediction_p95_px']:.2f})"),
        ("least squares (cubic) / a straight line", f"{metrics['saccade_prediction_least_squares_px']:.3f} / "
                                                    f"{metrics['saccade_prediction_straight_line_px']:.3f} px"),
        ("fixated by one saccade / by two", f"{100 * metrics['fixation_1_rate']:.1f} / "
         f"{100 * metrics['fixation_2_rate']:.1f} % of {metrics['fixation_trials']} within {ONCE_PX} px"),
        ("on average", f"{metrics['fixation_1_px']:.3f} / {metrics['fixation_2_px']:.3f} px from the middle; "
                       f"Eq. (1) was 0/0 {metrics['fixation_uninformed']} times"),
        ("retina", f"{metrics['retina_images_per_s']:.0f} images a second of one core"),
    ]  # fmt: skip
    return f"# {metrics['robot']} looks about\n\n{table(rows)}\n"
