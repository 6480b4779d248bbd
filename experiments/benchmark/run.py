"""Peers in one table: same body, same babbling, same loop, each inverse model at its best gain; and what it costs."""

import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from babbling.loop import babble, bouts
from babbling.mind import Mind
from experiments.benchmark import maze as maze_benchmark
from experiments.benchmark.options import Config
from experiments.gesture.figures import babbling_curve
from experiments.shared.baselines import direct_replay, replay_commands
from experiments.shared.experiment import Result
from experiments.shared.judging import LearningCurve, rmse_deg
from experiments.shared.minds import COPIES, HeldOut, bare_rate, body_of, learn_mind
from experiments.shared.options import BodyOptions
from experiments.shared.peers import ForwardLine, InverseLine
from experiments.shared.progress import progress
from experiments.shared.tables import table
from experiments.shared.watching import watch
from imitation.acting.loop import imitate
from imitation.acting.rehearsal import REHEARSERS, best_eagerness
from imitation.inference.moving import AveragedInverse, MovingInverse
from models.feedforward import feedforward_angles


def run(config: Config) -> Result:
    """Babble once, imitate with everyone, measure the babble's own speed."""
    config.check()
    body = body_of(config, 1, stream=3)
    seen = {name: watch(name, body) for name in config.demonstrations}
    with progress("babbling") as report:
        learned = learn_mind(config, config.babbling_minutes, report)
    mind = learned.mind
    peers = inverse_models(mind, config)
    errors: dict[str, dict[str, float]] = {}
    metrics: dict[str, Any] = {"robot": config.robot, "seed": config.seed, **learned.metrics}
    with progress("imitating") as report:
        gains = {
            peer: mind.temper.eagerness
            if isinstance(inverse, AveragedInverse)
            else best_eagerness(body_of(config, REHEARSERS, stream=1), mind, inverse, config.seed)
            for peer, inverse in peers.items()
        }
        for done, (name, one) in enumerate(seen.items()):
            row = {"direct replay": rmse_deg(direct_replay(body, one.angles), one.angles)}
            for peer, inverse in peers.items():
                attempts = imitate(
                    body,
                    one.movement,
                    mind,
                    inverse=inverse,
                    eagerness=gains[peer],
                    attempts=config.attempts if peer == "Bayesian, mean" else 1,
                    rng=np.random.default_rng([config.seed, 8]),
                    witness=lambda: body.joint_angles,
                )
                row[peer] = rmse_deg(attempts[0].truth[:, 0], one.angles)
                if len(attempts) > 1:
                    row[f"Bayesian, mean, attempt {len(attempts)}"] = rmse_deg(attempts[-1].truth[:, 0], one.angles)
                if peer == "Bayesian, mean":
                    select = 1e3 * np.concatenate([a.select_s for a in attempts])
                    metrics["select_p50_ms"], metrics["select_p99_ms"] = np.quantile(select, (0.5, 0.99))
            fed_forward = replay_commands(body, one.angles, partial(feedforward_angles, body))
            row["true inverse dynamics"] = rmse_deg(fed_forward, one.angles)
            errors[name] = row
            report((done + 1) / len(seen))
    metrics["rmse_deg"] = errors
    metrics["babbling_efficiency_factor"] = efficiency(config, mind)
    floor = None
    assert learned.curve is not None  # it has babbled
    if config.floor > 0:
        floor = curve_floor(config, mind, config.babbling_minutes * config.floor)
        metrics["learning_curve_floor_body_minutes"], metrics["learning_curve_floor_deg"] = floor
    maze = maze_benchmark.rows(peers=config.peers, seed=config.seed)
    metrics |= maze_benchmark.metrics(maze)
    figures = {"peers": bars(errors), "learning_curve": babbling_curve(learned.curve, floor)}
    return Result(metrics, summarise(errors, metrics, learned.curve, maze), figures)


def inverse_models(mind: Mind, options: BodyOptions) -> dict[str, MovingInverse]:
    """Everyone who answers "what action leads there", by name."""
    models: dict[str, MovingInverse] = {
        f"Bayesian, {rule}": AveragedInverse(mind.forward_model, rule, trust=mind.temper.trust)
        for rule in ("mean", "map", "matching")
    }
    return {**models, "linear": InverseLine(mind.forward_model), "forward line": ForwardLine(mind.forward_model)}


def efficiency(options: BodyOptions, mind: Mind, rounds: int = 5, ticks: int = 250) -> float:
    """Babbling (exploring, acting, feeling, counting) against bare `mujoco.batch` stepping of the same bodies through
    the same commands, in turn; the median of the rates' ratio.
    """
    body = body_of(options, COPIES)
    model = mind.pilot.forward_model()
    ratios = []
    for number in range(rounds):
        started = time.perf_counter()
        babble(body, mind.pilot, (ticks,), options.seed + number, onto=model)
        ours = time.perf_counter() - started
        bare = ticks / bare_rate(body, mind.pilot, np.random.default_rng([options.seed + number, 3, 0]), ticks)
        ratios.append(bare / ours)
    return float(np.median(ratios))


def curve_floor(options: BodyOptions, mind: Mind, minutes: float) -> tuple[float, float]:
    """(body-minutes, degrees) held-out error of the same table after a far longer babble."""
    body = body_of(options, COPIES)
    plan = bouts(minutes, body)
    with progress(f"{minutes:.0f} body-minutes for the floor of the learning curve") as report:
        model = babble(body, mind.pilot, plan, options.seed, after_bout=lambda done, so_far: report(done / len(plan)))
    held_out = HeldOut(options, mind.pilot)
    held_out.note(sum(plan) * COPIES * body.tick_s / 60, model)
    minutes, table, _ = held_out.points[0]
    return minutes, table


def summarise(
    errors: dict[str, dict[str, float]], metrics: dict[str, Any], curve: LearningCurve, maze: list[maze_benchmark.Row]
) -> str:
    """Peers, degrees; then the costs; then the maze's questions: three markdown tables."""
    peers = list(next(iter(errors.values())))
    end = f"{curve.table[-1]:.4f} deg after {curve.minutes[-1]:.0f} body-minutes"
    costs = [
        ("babbling against bare stepping of the same bodies", f"{metrics['babbling_efficiency_factor']:.2f}"),
        ("one selection for all joints", f"{metrics['select_p50_ms']:.2f} ms"),
        ("held-out prediction error", f"{end} (line {curve.line[-1]:.4f})"),
    ]
    if "learning_curve_floor_deg" in metrics:
        what = f"the same after {metrics['learning_curve_floor_body_minutes']:.0f} body-minutes"
        costs.append((what, f"{metrics['learning_curve_floor_deg']:.4f} deg"))
    answers = [
        (r.question, r.who, f"{r.each_us:.3f}", f"{r.times_ours_factor:.2f}", f"{r.largest_difference:.1e}")
        for r in maze
    ]
    return "\n\n".join([
        "Joint error, root mean square over all joints and frames, degrees",
        table(
            ((peer, *(f"{row[peer]:.4f}" for row in errors.values())) for peer in peers),
            ("peer", *(Path(name).name for name in errors)),
        ),
        table(costs, ("cost", "")),
        table(answers, ("maze question", "who", "us each", "times ours", "largest difference")),
    ])  # fmt: skip


def bars(errors: dict[str, dict[str, float]]) -> Figure:
    """Error of every peer on every demonstration."""
    figure = Figure(figsize=(10, 4.8), layout="constrained")
    axis = figure.subplots()
    peers = list(next(iter(errors.values())))
    width = 0.85 / len(errors)
    for i, (name, row) in enumerate(errors.items()):
        axis.bar(np.arange(len(peers)) + i * width, [row[peer] for peer in peers], width, label=Path(name).name)
    axis.set_xticks(np.arange(len(peers)) + 0.4, peers, rotation=20, ha="right")
    axis.set_yscale("log")
    axis.set_ylabel("joint error [deg]")
    axis.set_title("Same body, same babbling, same loop, each at its best gain")
    axis.legend(frameon=False, fontsize=8)
    return figure
