"""A robot babbles and leaves what it learned in a file; interrupted, the same command goes on where it stopped."""

from pathlib import Path

from babbling.balance import Balance
from babbling.files import save
from babbling.mind import Mind
from experiments.babble.options import Config
from experiments.errors import ExperimentError
from experiments.gesture.figures import babbling_curve
from experiments.saccades.options import Config as Looking
from experiments.saccades.run import run as look
from experiments.shared.experiment import as_json, check_file, check_out, publish
from experiments.shared.minds import body_of, learn_mind, people_say
from experiments.shared.one_leg import learn_to_stand
from experiments.shared.options import must_stand
from experiments.shared.progress import progress
from experiments.shared.standing import standing_of
from experiments.shared.tables import show, table


def command(config: Config) -> Path:
    """Babble into a file, and say which.

    While it runs, FILE.partial holds what was learned so far; it is gone when FILE is complete.

    Raises:
        ExperimentError: the file cannot be written, or an interrupted babble of other options is in the way.
    """
    config.check()
    if config.stand:
        must_stand(config.robot)
    if config.sees:
        return with_eyes(config)
    out = config.out or Path("runs") / f"{Path(config.robot).stem}.nc"
    check_file(out, Mind, "forward model", (out.with_suffix(".json"), out.with_suffix(".png")))
    if config.stand:
        check_file(balance_file(out), Balance, "balance")
    checkpoint = out.with_name(out.name + ".partial")
    with progress(f"{config.robot} babbles") as report:
        learned = learn_mind(config, config.babbling_minutes, report, checkpoint=checkpoint)
    scramble = -1 if config.scramble is None else config.scramble
    told = {"minutes": config.babbling_minutes, "noise_deg": config.sensor_noise_deg, "scramble": scramble}
    save(learned.mind, out, people_say(body_of(config, 1)), robot=config.robot, **told)
    checkpoint.unlink(missing_ok=True)
    metrics = {"robot": config.robot, "seed": config.seed, **learned.metrics}
    out.with_suffix(".json").write_text(as_json(metrics))
    assert learned.curve is not None
    babbling_curve(learned.curve).savefig(out.with_suffix(".png"), dpi=130)
    rows = [
        ("body time", f"{metrics['babbling_body_minutes']:.1f} + {metrics['pilot_body_minutes']:.1f} minutes (pilot)"),
        ("transitions", f"{metrics['babbling_transitions']:,} over {len(learned.mind.forward_model.factors)} factors"),
        ("wall time of the babble", f"{metrics['babbling_wall_s']:.1f} s"),
        ("held-out error, one tick ahead", f"{learned.curve.table[-1]:.4f} {learned.curve.unit}"),
        ("the same, least-squares line", f"{learned.curve.line[-1]:.4f} {learned.curve.unit}"),
    ]
    beside = [out.with_suffix(".png"), out.with_suffix(".json")]
    if config.stand:
        beside.append(balance_file(out))
        with progress(f"{config.robot} learns to stand") as report:
            balance = learn_to_stand(config, learned.mind, body_of(config, 1), report)
        save(balance, beside[-1], people_say(standing_of(config, 1, 0)), **told)
        rows.append(("learning to stand", f"{balance.minutes.sum():.1f} body-minutes, {balance.falls.sum():g} falls"))
    show(table(rows))
    print(f"\nwritten to {out} (and {', '.join(file.name for file in beside)} beside it)")
    return out


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
    print(f"\nwritten to {out}")
    return out
