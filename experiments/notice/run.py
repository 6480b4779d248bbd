"""A body changes while it imitates: a motor jams, a hand takes up a weight, two wires are swapped. Does it notice?"""

from typing import Any

import numpy as np

from experiments.notice.counting import WHO, count_on
from experiments.notice.figures import figures
from experiments.notice.options import Config
from experiments.notice.recording import record
from experiments.notice.trials import (
    COPIES,
    HEALTHY,
    KINDS,
    REHEARSING,
    Senses,
    alarms,
    changed,
    judge,
    listen,
    movements,
)
from experiments.shared.experiment import Result
from experiments.shared.judging import over_learners
from experiments.shared.kept import once
from experiments.shared.minds import body_of, learn_mind, take_mind
from experiments.shared.peers import forward_line
from experiments.shared.progress import progress
from experiments.shared.tables import table
from experiments.shared.watching import watch
from imitation.inference.moving import MovingInverse

SAID = {"average": "evidence, averaged model", "line": "evidence, plain line", "error": "threshold on felt - wanted"}
PER_HOUR = 1.0


def run(config: Config) -> Result:
    """Rehearse, imitate in health, then let bodies change; then count on with a weight in the hand."""
    config.check()
    if config.robot == "hoap2":  # what is counted on with is watched now, lest it be no demonstration
        for demonstration in config.demonstrations:
            watch(demonstration, body_of(config, 1, stream=3), unit=config.unit)
    with progress(f"{config.robot} babbles") as report:
        path, minutes = config.forward_model, config.babbling_minutes
        mind = (take_mind(path, config) if path is not None else once(learn_mind, config, minutes, report=report)).mind
    limit, metrics = float(np.log(3600 / PER_HOUR)), dict[str, Any]()
    inverses: dict[str, MovingInverse | None] = {"average": None, "line": forward_line(mind.forward_model)}
    ways = dict[str, tuple[MovingInverse | None, Senses]]()
    falsely = dict[str, int]()
    with progress("rehearsing, imitating in health") as report:
        for number, (way, inverse) in enumerate(inverses.items()):
            runs = []
            for use, minutes in ((REHEARSING, config.rehearsal_minutes), (HEALTHY, config.healthy_minutes)):
                body = body_of(config, COPIES, stream=31 + use)
                seconds = max(60 * minutes / COPIES, 2.0)
                runs.append(listen(body, movements(body, mind, config, use, COPIES, seconds), mind, inverse))
                report((2 * number + len(runs)) / 4)
            senses = Senses.rehearsed(runs[0], body.tick_s)
            ways[way] = inverse, senses
            falsely[way] = alarms(senses.surprise(runs[1])[1], limit, body.tick_s)
            if inverse is None:
                falsely["error"] = alarms(senses.surprise(runs[1], by_error=True)[1], limit, body.tick_s)
    hours = runs[1].off[:, 0, :, 0].size * body.tick_s / 3600
    metrics |= {"robot": config.robot, "seed": config.seed, "healthy_hours": hours, "cases": config.cases}
    metrics["false_alarms"] = falsely
    metrics["false_alarms_per_hour"] = {way: count / hours for way, count in falsely.items()}
    found = {}
    with progress("bodies change") as report:
        for number, kind in enumerate(KINDS):
            found[kind] = changed(mind, ways, kind, config)
            metrics[kind] = {way: judge(found[kind], way, limit, body.tick_s) for way in SAID}
            report((number + 1) / len(KINDS))
    errors = None
    if config.robot == "hoap2":
        with progress("counting on") as report:
            errors = count_on(config, report)
        metrics["counting_on_deg"] = errors
        last = errors["counts on"][..., -1] / errors["babbled with it"][..., 0]
        first = errors["does not"][..., 0] / errors["babbled with it"][..., 0]
        metrics["counting_on_ratio"], metrics["not_counting_on_ratio"] = last.mean(), first.mean()
    summary = summarise(metrics)
    tick, joints = body.tick_s, [body.sense_labels[line] for line in mind.pilot.schema.posture]
    return Result(
        metrics,
        summary,
        figures(found, limit, tick, joints),
        lambda path: record(path, found["carry"], body, limit, joints, summary),
    )


def summarise(metrics: dict[str, Any]) -> str:
    """Two markdown tables."""
    rows = []
    for way, said in SAID.items():
        cells = []
        for kind in KINDS:
            one = metrics[kind][way]
            delay = "" if one["delay_median"] is None else f", {one['delay_median']:.2f} s"
            cells.append(f"{one['noticed']:.0%} ({one['named_right']:.0%}){delay}")
        rows.append((said, *cells, f"{metrics['false_alarms'][way]} in {metrics['healthy_hours']:.2f} h"))
    header = ("noticed within .5 s (joints named right), median delay", *KINDS.values(), "false alarms")
    parts = [table(rows, header)]
    if "counting_on_deg" in metrics:
        errors = metrics["counting_on_deg"]
        lines = []
        for who in WHO:
            each = errors[who].mean(1)
            if len(each) > 1:
                mean, half = over_learners(each)
                lines.append((who, *(f"{m:.4f} +- {h:.4f}" for m, h in zip(mean, half, strict=True))))
            else:
                lines.append((who, *(f"{m:.4f}" for m in each[0])))
        names = [f"attempt {n + 1}" for n in range(len(each[0]))]
        parts.append(table(lines, ("200 g in the right hand: its arm's error, degrees", *names)))
    return "\n\n".join(parts)
