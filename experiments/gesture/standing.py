"""`imitate gesture --stand`: the same movement on one's own feet, and who else would fall."""

import time
from typing import Any

import numpy as np

from babbling.balance import SATURATED, Balance
from babbling.files import load, save
from experiments.gesture.options import Config
from experiments.gesture.standing_figures import figures
from experiments.gesture.standing_found import Stands, touches
from experiments.gesture.standing_recording import record
from experiments.gesture.standing_study import ENOUGH, Cell, prepared, study
from experiments.shared.experiment import Result
from experiments.shared.film import filmed
from experiments.shared.judging import interval_95, rmse_deg
from experiments.shared.kept import once
from experiments.shared.minds import Learned, body_of, factors_of
from experiments.shared.one_leg import learn_to_stand
from experiments.shared.progress import progress
from experiments.shared.standing import paced, perform, shove, standing_of
from experiments.shared.tables import table
from experiments.shared.trajectories import left
from experiments.shared.watching import Seen
from imitation.acting.balancing import Balancer

WAYS = ("ours", "linear", "replay")


def take_balance(config: Config) -> Balance:
    """What was learned of standing, out of a file, checked against the body.

    Raises:
        BabblingError: see `load` and `Balance.check`.
    """
    assert config.balance is not None
    balance = load(config.balance, Balance)
    balance.check(standing_of(config, 1, 0))
    return balance


def stand(config: Config, learned: Learned, seen: Seen, balance: Balance | None) -> Result:
    """Learn to stand, unless that was done before; do the movement on one's feet; judge."""
    hung, started = body_of(config, 1, stream=3), time.perf_counter()
    body, taken = standing_of(config, 1, 0), balance is not None
    if balance is None:
        with progress(f"{config.robot} learns to stand") as report:
            balance = once(learn_to_stand, config, learned.mind, hung=hung, report=report)
    spent = time.perf_counter() - started
    movement = paced(seen.angles, config.speed, hung)
    wanted = movement.senses[:, hung.senses.lines("angle")]
    balancer = Balancer(balance, config.balance_weight)
    push = shoved(config.push)
    done = {
        who: perform(
            standing_of(config, 1, 0), hung, learned.mind, movement,
            Balancer(balance, linear=True) if who == "linear" else balancer, replay=who == "replay", push=push,
        )
        for who in WAYS
    }  # fmt: skip
    order = factors_of(hung, learned.mind)
    whole = prepared(config, learned.mind, balance, hung, seen.angles) if config.study else None
    if whole is not None:
        done["pd"] = whole.perform(Cell("pd", config.demonstration, config.speed), 1, push)
    stands = Stands(config, body, learned, balance, balancer, seen, wanted, done, order)
    metrics = measure(stands) | {"balance_wall_s": spent}
    if whole is not None:
        metrics |= study(whole, config.threads)
    summary = summarise(metrics, stands)
    shown = (stands.ours.configurations[stands.during(), 0], stands.demonstrated)
    files = left(stands.trajectories, csv=config.csv) | filmed(config.film, stands.title, body, *shown, seen.teacher)
    files |= {} if taken else {"balance.nc": lambda path: save(balance, path)}
    return Result(metrics, summary, figures(stands, metrics), lambda path: record(path, stands, summary), files)


def shoved(told: str | None) -> Any:
    """What pushes when, or None."""
    if told is None:
        return None
    begin, *force = map(float, told.split(","))
    return shove(np.array(force), begin)


def measure(stands: Stands) -> dict[str, Any]:
    """The numbers of metrics.json. Joints that carry the body are left out of `joint_rmse_deg`: they belong to
    balance; so are ticks at which parts of the body touch each other, and what comes after a fall."""
    ours, balance, tick = stands.ours, stands.balance, stands.body.tick_s
    count, first = len(stands.wanted), ours.first
    carried = balance.carries[stands.order] > 0
    during = slice(first, first + count)
    upright, (touching, free) = ours.upright[during, 0], touches(ours, 0, during, stands.body)
    noticed = (ours.resisted[during, 0] & (balance.carries == 0)).any(-1)
    reached, wanted = ours.angles[during, 0], stands.wanted

    def error(ticks: Any, joints: Any) -> float | None:
        return rmse_deg(reached[ticks][:, joints], wanted[ticks][:, joints]) if ticks.any() else None

    felt = balance.pressed(ours.loads[:, 0])[ours.upright[:, 0]]
    expected = ours.foretold[ours.upright[:, 0], 0]
    fell = {who: bool(one.fell[0]) for who, one in stands.done.items()}
    when = {
        who: float((one.upright[:, 0].argmin() - one.first) * tick) if fell[who] else None
        for who, one in stands.done.items()
    }
    return {
        "demonstration": stands.config.demonstration,
        "robot": stands.config.robot,
        "seed": stands.config.seed,
        "speed": stands.config.speed,
        "slowed_factor": stands.seen.slowed,
        "frames": count,
        "tick": tick,
        "fell": fell,
        "fall_time_s": when,
        "joint_rmse_deg": error(free, ~carried),
        "joint_rmse_touching_deg": error(upright & touching, ~carried),
        "carrying_joints_rmse_deg": error(upright, carried),
        "contact_frames_share": float(touching[upright].mean()) if upright.any() else 0.0,
        "contact_noticed_share": float(noticed[touching].mean()) if touching.any() else None,
        "contact_imagined_share": float(noticed[free].mean()) if free.any() else None,
        "pressure_largest": np.abs(felt).max(0).tolist(),
        "pressure_foretold_rmse": float(np.sqrt(((felt - expected) ** 2).mean())),
        "first_pressure_foretold": ours.plan.expected[first, 0].tolist(),
        "stays_largest": np.abs(ours.stays[:, 0]).max(0).tolist(),
        "choice_p50_ms": 1e3 * float(np.median(ours.choice_s)),
        "offset_largest_deg": np.rad2deg(np.abs(ours.plan.offset[:, 0]).max(0)).tolist(),
        "carrying_joints": [joint for joint, carries in zip(stands.body.joints, carried, strict=True) if carries],
        "balance_body_minutes": float(balance.minutes.sum()),
        "balance_stage_minutes": balance.minutes.tolist(),
        "balance_stage_falls": balance.falls.tolist(),
        "balance_weight": stands.config.balance_weight,
        **stands.learned.metrics,
    }


def summarise(metrics: dict[str, Any], stands: Stands) -> str:
    """The result as a markdown table."""

    def said(who: str) -> str:
        return f"fell after {metrics['fall_time_s'][who]:.1f} s" if metrics["fell"][who] else "stands"

    def degrees(value: float | None) -> str:
        return "-" if value is None else f"{value:.3f} deg"

    rows = [
        ("on its own feet", said("ours")),
        ("the line of the same experience", said("linear")),
        ("sub-goals simply sent, legs and all", said("replay")),
        ("joints that do not carry it, against sub-goals, nothing touching", degrees(metrics["joint_rmse_deg"])),
        ("the same while parts of it touch each other", degrees(metrics["joint_rmse_touching_deg"])),
        ("joints that carry it, against the teacher's", degrees(metrics["carrying_joints_rmse_deg"])),
        ("ticks at which parts of it touch", f"{metrics['contact_frames_share']:.0%}"),
        ("largest pressure, of 1", " / ".join(f"{x:.2f}" for x in metrics["pressure_largest"])),
        ("pressure foretold, root mean square", f"{metrics['pressure_foretold_rmse']:.3f}"),
        (
            "learning to stand",
            f"{metrics['balance_body_minutes']:.1f} body-minutes, {sum(stands.balance.falls):g} falls",
        ),
    ]
    if np.abs(metrics["first_pressure_foretold"]).max() > SATURATED:
        margin = 1 - np.abs(metrics["first_pressure_foretold"]).max()
        rows.append(("the first posture cannot stand", f"margin {margin:.2f}; it begins as near as it can"))
    told = f"**{stands.config.demonstration}**, {metrics['frames'] * metrics['tick']:.1f} s, standing\n\n{table(rows)}"
    if "falls" in metrics:
        told += "\n\n" + study_table(metrics)
    return told


def study_table(metrics: dict[str, Any]) -> str:
    """Falls by speed, then everything else of the study."""
    falls, runs, each = metrics["falls"], metrics["runs"], metrics["hardship_runs"]
    speeds = list(falls["ours"])

    def share(who: str, speed: str) -> str:
        if speed not in falls[who]:
            return "-"
        count = runs[who][speed]
        return f"{falls[who][speed]} of {count} (to {interval_95(falls[who][speed], count)[1]:.0%})"

    rows = [(f"{speed} times as fast", *(share(who, speed) for who in falls)) for speed in speeds]
    parts = [table(rows, ("falls", *falls))]
    facing = next(iter(metrics["hardships"].values()))
    hardships = [(name, *(f"{n} of {each}" for n in one.values())) for name, one in metrics["hardships"].items()]
    parts.append(table(hardships, ("falls", *facing)))
    shown = [
        (f"{name} ({ENOUGH[name]:g})", *(f"{n} of {each}" for n in one.values()))
        for name, one in metrics["shown_enough"].items()
    ]
    parts.append(table(shown, ("done (degrees, s on one leg, steps)", *facing)))
    pushes = [
        (f"{when}, {who}", f"{np.mean(one):.2f}", f"{min(one):.1f}")
        for when, all_ in metrics["push_impulse_ns"].items()
        for who, one in all_.items()
    ]
    parts.append(table(pushes, ("push survived by half of the runs [N s]", "mean of 8 directions", "least")))
    free = [
        (clip, f"{np.mean(told):.3f}", f"{np.max(told):.3f}", f"{metrics['touching_share'][clip]:.0%}")
        for clip, one in metrics["joint_rmse_free_deg"].items()
        if (told := [error for error in one if error is not None])
    ]
    parts.append(table(free, ("joints that do not carry, nothing touching [deg]", "mean", "worst of 20", "touching")))
    return "\n\n".join(parts)
