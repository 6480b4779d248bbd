"""A robot babbles and leaves what it learned in a file; interrupted, the same command goes on where it stopped."""

import shlex
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from babbling.balance import Balance
from babbling.files import VERSION, is_kind, load, save
from babbling.mind import Mind
from babbling.whole import sweep, whole
from experiments.babble.bouts import in_shards
from experiments.babble.options import Config
from experiments.errors import ExperimentError
from experiments.gesture.figures import babbling_curve
from experiments.saccades.options import Config as Looking
from experiments.saccades.run import run as look
from experiments.shared.experiment import as_json, check_file, check_out, publish, writing
from experiments.shared.journal import Journal
from experiments.shared.minds import body_of, learn_mind, people_say
from experiments.shared.one_leg import learn_to_stand
from experiments.shared.options import must_stand
from experiments.shared.progress import progress
from experiments.shared.report import drawn
from experiments.shared.standing import standing_of
from experiments.shared.tables import opened, show, table
from experiments.stopping import say

Rows = list[tuple[str, str]]


def command(config: Config) -> Path:
    """Babble into a file, and say which.

    While it runs, FILE.partial holds what was learned so far; it is gone when FILE and what is beside it are complete.
    A FILE that these very options made is finished: nothing is done but what is missing of standing.

    Raises:
        ExperimentError: the file cannot be written, or an interrupted babble of other options is in the way.
    """
    config.check()
    if config.stand:
        must_stand(config.robot)
    if config.sees:
        return with_eyes(config)
    out = config.out or Path("runs") / f"{Path(config.robot).stem}.nc"
    figure, numbers, balance_out = out.with_suffix(".png"), out.with_suffix(".json"), balance_file(out)
    check_file(out, Mind, "forward model", (numbers, figure))
    if config.stand:
        check_file(balance_out, Balance, "balance")
    body = body_of(config, 1)
    told: dict[str, str | float] = {
        "minutes": config.babbling_minutes,
        "noise_deg": config.sensor_noise_deg,
        "scramble": -1 if config.scramble is None else config.scramble,
        "seed": config.seed,
        "body": body.fingerprint,
    }
    made = {"version": VERSION, **told}
    checkpoint, rows, left = out.with_name(out.name + ".partial"), Rows(), [figure, numbers]
    if is_kind(out, Mind, **made) and figure.exists() and numbers.exists() and not checkpoint.exists():
        mind = load(out, Mind)
        say(f"{out}: this very babble is finished; delete the file to babble anew, or name another")
    else:
        mind = babbled(config, out, checkpoint, told, rows)
    if config.stand:
        left.append(balance_out)
        if is_kind(balance_out, Balance, **made):
            say(f"{balance_out}: so is learning to stand")
        else:
            rows.append(("learning to stand", stood(config, mind, balance_out, told)))
    if rows:
        show(table(rows))
        print(f"\nwritten to {out} (and {', '.join(file.name for file in left)} beside it)")
        words = [*(["--robot", config.robot] if config.robot != Config.robot else []), "--forward-model", str(out)]
        words += [] if config.scramble is None else ["--scramble", str(config.scramble)]
        print("to use it:", shlex.join(["imitate", "gesture", *words]))
    return out


def babbled(config: Config, out: Path, checkpoint: Path, told: Mapping[str, str | float], rows: Rows) -> Mind:
    """Babble and write what was learned, its numbers and its curve; rows are added to the table."""
    with progress(f"{config.robot} babbles") as report:
        elsewhere = partial(in_shards, config) if config.shards > 1 or config.scheduler is not None else None
        learned = learn_mind(config, config.babbling_minutes, report, checkpoint=checkpoint, elsewhere=elsewhere)
    metrics, curve = {"robot": config.robot, "seed": config.seed, **learned.metrics}, learned.curve
    assert curve is not None
    with writing(out, "file"):
        for older in (out.with_suffix(".json"), out.with_suffix(".png")):
            older.unlink(missing_ok=True)  # of another babble: whoever is killed here is not finished
    save(learned.mind, out, people_say(body_of(config, 1)), robot=config.robot, **told)
    with writing(out, "file"):
        with whole(out.with_suffix(".json")) as beside:
            beside.write_text(as_json(metrics))
        with whole(out.with_suffix(".png")) as beside:
            beside.write_bytes(drawn(babbling_curve(curve)))
        sweep(checkpoint)
        checkpoint.unlink(missing_ok=True)  # only now: whoever is killed before goes on from there
    rows += [
        ("body time", f"{metrics['babbling_body_minutes']:.1f} + {metrics['pilot_body_minutes']:.1f} minutes (pilot)"),
        ("transitions", f"{metrics['babbling_transitions']:,} over {len(learned.mind.forward_model.factors)} factors"),
        ("wall time of the babble", f"{metrics['babbling_wall_s']:.1f} s"),
        ("held-out error, one tick ahead", f"{curve.table[-1]:.4f} {curve.unit}"),
        ("the same, least-squares line", f"{curve.line[-1]:.4f} {curve.unit}"),
    ]
    return learned.mind


def stood(config: Config, mind: Mind, out: Path, told: Mapping[str, str | float]) -> str:
    """Learn to stand and write it; how it went."""
    journal = Journal(partial := out.with_name(out.name + ".partial"), told)
    with progress(f"{config.robot} learns to stand") as report:
        balance = learn_to_stand(config, mind, body_of(config, 1), report, journal)
    save(balance, out, people_say(standing_of(config, 1, 0)), robot=config.robot, **told)
    sweep(partial)
    partial.unlink(missing_ok=True)
    return f"{balance.minutes.sum():.1f} body-minutes, {balance.falls.sum():g} falls"


def balance_file(out: Path) -> Path:
    """Where balance is kept, beside the mind."""
    return out.with_suffix(".balance.nc")


def with_eyes(config: Config) -> Path:
    """A head's babble: what `imitate saccades` does, into a folder.

    Raises:
        ExperimentError: options that a head does not have.
    """
    if config.sensor_noise_deg or config.scramble is not None:
        raise ExperimentError(
            f"--sensor-noise-deg and --scramble are for bodies of many joints; {config.robot} has neither"
        )
    if config.shards > 1 or config.scheduler is not None:
        raise ExperimentError(f"--shards and --scheduler are for bodies of many joints; {config.robot} babbles here")
    if config.out is not None and config.out.suffix:
        raise ExperimentError(
            f"--out {config.out}: {config.robot} leaves a folder (recording, figures, eyes.nc); name a folder"
        )
    out = config.out or Path("runs") / config.robot
    check_out(out)
    looking = Looking(robot=config.robot, babbling_minutes=config.babbling_minutes, seed=config.seed, out=out)
    result = look(looking)
    publish("saccades", looking, result)
    show(result.summary)
    print("\n" + opened(out))
    return out
