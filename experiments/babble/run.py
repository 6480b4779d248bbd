"""A robot babbles and leaves what it learned in a file; interrupted, the same command goes on where it stopped."""

from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.markdown import Markdown

from babbling.storage import check_kind
from experiments.errors import ExperimentError
from experiments.gesture.figures import learning_curve
from experiments.gesture.run import curve_metrics
from experiments.shared.experiment import as_json, check_out, publish, try_writing
from experiments.shared.minds import DEFAULT_MINUTES, BodyOptions, check_minutes, learn_mind, save_learned
from experiments.shared.progress import progress


@dataclass(frozen=True)
class Config:
    """Options of `imitate babble`."""

    robot: str = "hoap2"
    """hoap2, hoap2-worn, or the path of an MJCF file with position actuators; biclops babbles with its eyes, as
    `imitate saccades` does, and leaves a folder."""
    babbling_minutes: float = DEFAULT_MINUTES
    """Body-minutes of babbling, over all copies."""
    sensor_noise_deg: float = 0.0
    """Standard deviation of every angle sense, degrees."""
    scramble: int | None = None
    """Seed of an unknown wiring between mind and body."""
    seed: int = 0
    """Seed of everything random."""
    threads: int = 2
    """Worker threads; the result does not depend on it."""
    out: Path | None = None
    """The file (runs/ROBOT.nc); its learning curve is drawn beside it."""


def command(config: Config) -> None:
    """Babble into a file.

    While it runs, FILE.partial holds what was learned so far; it is gone when FILE is complete.

    Raises:
        ExperimentError: the file cannot be written, or an interrupted babble of other options is in the way.
    """
    if config.robot == "biclops":
        with_eyes(config)
        return
    out = config.out or Path("runs") / f"{Path(config.robot).stem}.nc"
    check_file(out)
    check_minutes(config.babbling_minutes)
    checkpoint = out.with_name(out.name + ".partial")
    options = BodyOptions(config.robot, config.sensor_noise_deg, config.scramble, config.seed, config.threads)
    with progress(f"{config.robot} babbles") as report:
        learned = learn_mind(options, config.babbling_minutes, report, checkpoint=checkpoint)
    save_learned(learned, out, options, config.babbling_minutes)
    checkpoint.unlink(missing_ok=True)
    metrics = {"robot": config.robot, "seed": config.seed, **learned.metrics, **curve_metrics(learned)}
    out.with_suffix(".json").write_text(as_json(metrics))
    assert learned.curve is not None
    learning_curve(learned.curve).savefig(out.with_suffix(".png"), dpi=130)
    rows = [
        ("body time", f"{metrics['babbling_body_minutes']:.1f} + {metrics['pilot_body_minutes']:.1f} minutes (pilot)"),
        ("transitions", f"{metrics['babbling_transitions']:,} over {len(learned.mind.forward_model.factors)} factors"),
        ("wall time of the babble", f"{metrics['babbling_wall_s']:.1f} s"),
        ("held-out error, one tick ahead", f"{metrics['learning_curve_table_deg'][-1]:.4f} deg"),
        ("the same, least-squares line", f"{metrics['learning_curve_linear_deg'][-1]:.4f} deg"),
    ]
    table = "\n".join(["| what | result |", "|---|---|", *(f"| {a} | {b} |" for a, b in rows)])
    Console().print(Markdown(table))
    print(f"\nwritten to {out} (and {out.with_suffix('.png').name}, {out.with_suffix('.json').name} beside it)")


def check_file(out: Path) -> None:
    """Refuse early what could not be written, or should not be overwritten.

    Raises:
        ExperimentError: a directory, another kind of file, a place that cannot be written, or strangers beside it.
    """
    try:
        if out.is_dir():
            raise ExperimentError(f"--out {out}: this is a directory; name a file such as {out / 'hoap2.nc'}")
        if out.suffix != ".nc":
            raise ExperimentError(f"--out {out}: a forward model's file ends in .nc; name it {out.stem or 'robot'}.nc")
        if out.exists():
            check_kind(out)
        elif taken := [p for p in (out.with_suffix(".json"), out.with_suffix(".png")) if p.exists()]:
            raise ExperimentError(
                f"--out {out}: {taken[0].name} is there already and would be lost; choose another name"
            )
        try_writing(next(p for p in out.absolute().resolve().parents if p.exists()))
    except OSError as error:
        raise ExperimentError(
            f"--out {out}: cannot be written ({error.strerror or error}); name a file that can"
        ) from error


def with_eyes(config: Config) -> None:
    """A head's babble: what `imitate saccades` does, into a folder.

    Raises:
        ExperimentError: options that a head does not have.
    """
    from experiments.saccades import run as saccades

    if config.sensor_noise_deg or config.scramble is not None:
        raise ExperimentError("--sensor-noise-deg and --scramble are for bodies of many joints; biclops has neither")
    if config.out is not None and config.out.suffix:
        raise ExperimentError(
            f"--out {config.out}: biclops leaves a folder (recording, figures, eyes.nc); name a folder"
        )
    out = config.out or Path("runs") / "biclops"
    check_out(out)
    looking = saccades.Config(babbling_minutes=config.babbling_minutes, seed=config.seed, out=out)
    result = saccades.run(looking)
    publish("saccades", looking, result)
    Console().print(Markdown(result.summary))
    print(f"\nwritten to {out}")
