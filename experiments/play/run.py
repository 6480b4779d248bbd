"""Children play with things at a table and leave what they learned in a file; interrupted, the same command goes on."""

import shlex
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from babbling.files import load, save
from babbling.mind import Mind
from babbling.play import HANDS, Play
from experiments.errors import ExperimentError
from experiments.play.figures import outcomes
from experiments.play.options import Config
from experiments.shared.children import NAMED, Child, beside, born, keep, meet, merged
from experiments.shared.experiment import as_json, check_file
from experiments.shared.pixels import watch_hands
from experiments.shared.playing import SEATED
from experiments.shared.progress import progress
from experiments.shared.report import drawn
from experiments.shared.rounds import PLAYED, empty, kinds, play_on, rounds_of, usable
from experiments.shared.tables import show, table
from models.loading import load_body


def command(config: Config) -> Path:
    """Play into a file, which holds at any time what was learned so far, and say which.

    Raises:
        ExperimentError: the file cannot be written, or holds something else.
        BabblingError: a mind or play of another body.
    """
    config.check()
    things = usable(config.things or PLAYED)
    out = config.out or Path("runs") / "play.nc"
    check_file(out, Play, "play", others(out), new=bool(config.merge))
    started = time.perf_counter()
    if config.merge:
        child = merged(config.merge)
        keep(child, out)
    else:
        child = begin(config, things, out)
        rounds = rounds_of(config.minutes, things)

        def after(play: Play) -> None:
            save(play, out)

        if child.play.rounds >= rounds:
            print(f"{out} already holds {child.play.minutes:.0f} body-minutes of play; --minutes more go on with it")
        one = child.mind, child.image, child.play, things, rounds, config.seed, config.workers, child.eyes
        child = replace(child, play=play_on(*one, after))
    metrics = told(child.play) | {"seed": config.seed, "play_wall_s": time.perf_counter() - started}
    out.with_suffix(".json").write_text(as_json(metrics))
    out.with_suffix(".png").write_bytes(drawn(outcomes(child.play)))
    rows = [
        ("body time of play", f"{child.play.minutes:.1f} minutes, {int(child.play.reached.sum())} tries"),
        ("kinds of things", ", ".join(child.play.kinds)),
        *((f"{kind}: what comes about", text) for kind, text in metrics["reached"].items()),
        ("wall time", f"{metrics['play_wall_s']:.0f} s"),
    ]
    show(table(rows))
    left = ", ".join(file.name for file in others(out) if file.exists())
    print(f"\nwritten to {out} (and {left} beside it)\nto use it: imitate objects --play {shlex.quote(str(out))}")
    return out


def told(play: Play) -> dict[str, Any]:
    """For people: what was learned, in numbers."""
    states, acts = play.outcomes.outcome.labels, play.outcomes.action.labels
    tables = {
        f"{kind}, hands {hands}": {
            act: dict(zip(states, play.outcomes.predictive[0, k, h, a].tolist(), strict=True))
            for a, act in enumerate(acts)
        }
        for k, kind in enumerate(play.kinds)
        for h, hands in enumerate(HANDS)
        if play.outcomes.visits[0, k, h].any()
    }
    reached = {
        kind: ", ".join(f"{state} {n}" for state, n in zip(states, play.reached[k].sum(0).tolist(), strict=True) if n)
        for k, kind in enumerate(play.kinds)
    }
    return {
        "play_body_minutes": play.minutes,
        "tries": int(play.reached.sum()),
        "counted": play.outcomes.transitions,
        "reached": reached,
        "outcome_probability": tables,
    }


def begin(config: Config, things: tuple[str, ...], out: Path) -> Child:
    """Who played so far, or one who has babbled and looked at its hands.

    Raises:
        ExperimentError: another mind, or other kinds of things, than the file's.
    """
    mind = None if config.forward_model is None else load(config.forward_model, Mind)
    if mind is not None:
        mind.check(load_body(SEATED))
    if out.exists():
        child = meet(out)
        if mind is not None and mind.fingerprint != child.play.fingerprint:
            raise ExperimentError(f"{out}: somebody with another body played here; choose another name")
        if child.play.kinds != kinds(things):
            raise ExperimentError(
                f"{out}: play with {', '.join(child.play.kinds)} is here, not with {', '.join(kinds(things))}; "
                "name the same things, or another file"
            )
        return child
    with progress("babbling on the seat") as report:
        mind, image = born(config.seed, report, mind)
    eyes = watch_hands(mind, image, config.seed) if config.seeing == "pixels" else None
    child = Child(mind, image, empty(mind, things), eyes)
    keep(child, out)
    return child


def others(out: Path) -> list[Path]:
    """What is left beside the play."""
    return [*(beside(out, what) for what in NAMED), out.with_suffix(".json"), out.with_suffix(".png")]
