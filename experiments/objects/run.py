"""An act on an object is seen once, remembered, and done by one's own means (chapter, sections 2.3 and 3.5)."""

from dataclasses import replace
from math import ceil
from typing import Any

import numpy as np

from experiments.objects.deciding import UNSEEN, remembered, respond
from experiments.objects.figures import figures, study_figures
from experiments.objects.found import Done, Studied
from experiments.objects.options import Config
from experiments.objects.recording import record
from experiments.objects.showing import ROOM_TABLE_M, demonstrated, watched
from experiments.objects.study import HEADS, Task, measured, peer
from experiments.objects.week import a_week_later
from experiments.shared.children import meet
from experiments.shared.experiment import Result
from experiments.shared.growing import kind_of, who
from experiments.shared.parallel import in_parallel
from experiments.shared.tables import table as markdown
from imitation.acting.primitives import NAMES
from models.objects.states import STATES


def run(config: Config) -> Result:
    """See, remember, act; or the study."""
    config.check()
    if config.study:
        return study(config)
    child = who(config.play, config.seed, config.workers)
    kind = kind_of(child, config.object)
    rng, far = np.random.default_rng([config.seed, 0x0B]), config.further_m
    act = memory = None
    if config.condition != "none":
        doing = "lift with both" if config.condition == "handled" else config.act
        teacher = peer(config.seed + 1, child) if config.condition == "peer" else child
        goal = int(child.play.practised(kind)[NAMES.index(doing)])
        state = None if goal < 0 or config.condition == "handled" else STATES[goal]
        table = ROOM_TABLE_M if config.condition == "room" else None
        act = demonstrated(teacher, config.object, doing, state, 1, config.seed, table=table, further=far, keep=True)
        seen = watched(act, config.condition, rng, config.seeing)
        [memory] = remembered(child.play, config.object, seen)
    how = config.object, config.acts, config.selection
    if config.condition == "week" and memory is not None:
        response = a_week_later(child, [memory], *how, config.seed, 0, keep_all=True, further=far)
    else:
        toy, acts, selection = how
        goals = np.array([UNSEEN]) if memory is None else memory.states[-1:]
        response = respond(child, toy, goals, acts, selection, rng, keep=True, further=far)
    done = Done(config, child, act, memory, response)
    rows = [
        ("what was seen", "nothing" if memory is None else f"{config.act} ({config.condition})"),
        ("taken for", done.metrics["recognised"] or "-"),
        ("what it is after", done.goal),
        *((f"act {n}", f"{name}: {state}") for n, (name, state) in enumerate(done.acts, 1)),
    ]
    summary = f"# An act on the {config.object}\n\n{markdown(rows)}"
    made = figures(done)
    return Result(done.metrics, summary, made, lambda path: record(path, done, summary, made))


def study(config: Config) -> Result:
    """Every figure, over agents and plays."""
    plays = [meet(path) for path in config.plays] or [who(config.play, config.seed, config.workers)]
    each = ceil(config.agents / len(plays))
    parts = ("tables", "watching", "success", "new", "apart", *HEADS)
    one = Task("", plays[0], plays[0], 0, each, config.acts, config.selection, config.seed)
    tasks = [
        replace(one, part=part, child=child, teacher=plays[(n + 1) % len(plays)], number=n)
        for part in parts
        for n, child in enumerate(plays)
    ]
    studied = Studied(plays, in_parallel(measured, tasks, config.workers, "studying acts on objects"))
    metrics = studied.metrics
    rows = [
        *(
            (
                f"{name}: done / by one who learned no aims",
                f"{percent(metrics, 'primitive_success', name)}, {metrics['primitive_success_unaimed'][name]:.1%}",
            )
            for name in metrics["primitive_success"]
        ),
        ("creep at 90 % of dry friction", f"{metrics['creep_mm_per_s']:.3f} mm/s"),
        (
            "pulled apart, grip below / above 1.5 x friction",
            f"{metrics['apart_rate_below']:.1%}, {metrics['apart_rate_above']:.1%}",
        ),
        ("tables of 8 tries a cell: calibration error", f"{metrics['outcome_calibration_error']:.3f}"),
        ("the same: gain over the kind alone", f"{metrics['outcome_gain_bits']:.2f} bits"),
        *(
            (
                f"another's primitive recognised, {by} / every place by itself",
                f"{metrics[f'recognition_{by}']:.1%}, {metrics[f'recognition_{by}_alone']:.1%}",
            )
            for by in ("points", "pixels")
        ),
        ("new object, first try / after own play", f"{metrics['new_object_ratio']:.2f}"),
        *((f"head touch, {name}", percent(metrics, "head_touch", name)) for name in metrics["head_touch"]),
    ]
    return Result(metrics, "# Acts on objects\n\n" + markdown(rows), study_figures(studied))


def percent(metrics: dict[str, Any], key: str, name: str) -> str:
    """A share with its interval."""
    low, high = metrics[f"{key}_interval"][name]
    return f"{metrics[key][name]:.1%} ({low:.0%} to {high:.0%})"
