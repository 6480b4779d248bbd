"""A robot's card: what it is as a body that babbles, what would be refused, and a movement it can begin with."""

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from babbling.axes import FloatArray
from babbling.whole import whole
from experiments.errors import ExperimentError
from experiments.robot.options import Config
from experiments.shared.baselines import direct_replay
from experiments.shared.tables import show, table
from models.body import SimulatedBody
from models.card import as_written, closed, model_rows, motor_rows, number, span
from models.loading import TICK_S, compiled, load_body
from models.robots import Robot, find

SECONDS, SWINGS, WIDEST, SPEED_SHARE = 8.0, 3, 0.6, 0.5
"""Of the template: s; joints swing once, twice, three times, once ...; most rad; share of the speed sense's range."""
INSET = 0.03
"""Share of a joint's range that the template leaves free at either end."""


def command(config: Config) -> None:
    """Print the card; leave the template.

    Raises:
        BodyError: what `load_body` says of such a robot, after the card; without one where it does not compile.
        ExperimentError: the template cannot be written.
    """
    config.check()
    robot = find(config.robot) or Robot(Path(config.robot), config.robot)
    model = compiled(robot)
    raw, motors = as_written(robot), list(motor_rows(model, config.robot, give=config.servos))
    show(f"**{config.robot}**" + (f": {robot.about}" if robot.about != config.robot else ""))
    show(table(motors, ("#", "joint", "range", "what moves it")))
    show(table(model_rows(robot, raw, model), ("model", "")))
    body = load_body(config.robot, give_servos=config.servos, threads=1)
    show(table(sense_rows(body), ("sense", "lines", "range")))
    wanted = template(body)
    away = np.abs(direct_replay(body, wanted) - wanted).max(0) * body.shown_scale
    worst = int(np.argmax(away))
    print(
        f"sent a gentle movement of all joints, it is off by {number(away[worst])} {body.shown_units[worst]} at most "
        f"({body.joints[worst]})"
    )
    if config.template is not None:
        write(config.template, body, wanted)
        also = " --servos" if config.servos else ""
        print(f"\nwritten to {config.template}: imitate gesture --robot {config.robot}{also} "
              f"--demonstration {config.template}")  # fmt: skip


def sense_rows(body: SimulatedBody) -> Iterator[tuple[str, str, str]]:
    """Every channel, its lines counted by unit, in what people read where that is joints."""
    for channel in body.senses.channels.values():
        low, high = (np.broadcast_to(v, channel.shape).ravel() for v in (channel.low, channel.high))
        jointed, per = channel.labels == body.joints, "/s" if channel.name == "speed" else ""
        units = [unit + per for unit in body.shown_units] if jointed else [channel.unit] * len(low)
        scale = body.shown_scale if jointed else np.ones(len(low))
        for unit in dict.fromkeys(units):
            here = np.array([one == unit for one in units])
            ends = (scale * low)[here].min(), (scale * high)[here].max()
            yield channel.name, str(here.sum()), span(np.array(ends), unit)


def template(body: SimulatedBody) -> FloatArray:
    """(T, J) rad or m: from rest to rest, joints go out to their roomier sides and back, one to three times, by half of
    what servos can be asked for and at half their speed at most. Where chains are closed, what becomes of that."""
    body.reset()
    low, high = body.joint_range.T
    asked = body.commands(np.array([np.full(len(body.joints), -1.0), np.full(len(body.joints), 1.0)]))
    low, high = np.maximum(low, asked.min(0)), np.minimum(high, asked.max(0))
    inset = INSET * (high - low)  # who rests at a joint's end is pushed back by it
    rest = np.clip(body.joint_angles[0], low + inset, high - inset)
    side = np.where(high - rest >= rest - low, high - rest, low - rest)
    swings = 1 + np.arange(len(rest)) % SWINGS
    fast = SPEED_SHARE * body.senses.read(body.sense_high, "speed") * SECONDS / (np.pi * swings)
    turns = np.where([unit == "rad" for unit in body.units], WIDEST, np.inf)
    out = np.sign(side) * np.minimum(np.abs(side) / 2, np.minimum(fast, turns))
    time = np.linspace(0, 1, round(SECONDS / TICK_S) + 1)[:, None]
    wanted = rest + out * (1 - np.cos(2 * np.pi * swings * time)) / 2
    return np.asarray(np.clip(direct_replay(body, wanted), low, high) if closed(body.model) else wanted)


def write(path: Path, body: SimulatedBody, angles: FloatArray) -> None:
    """A movement (T, J), one row a tick, as a table that people read; whole or not at all, over nothing.

    Raises:
        ExperimentError: it cannot be written, or something is there.
    """
    header = ["time", *(f"{joint} [{unit}]" for joint, unit in zip(body.joints, body.shown_units, strict=True))]
    try:
        with whole(path, over=False) as beside, beside.open("w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(header)
            for tick, row in enumerate(angles * body.shown_scale):
                rows.writerow([f"{tick * TICK_S:.2f}", *(f"{value:.6f}" for value in row)])
    except OSError as error:
        why = error.strerror or error
        raise ExperimentError(f"--template {path}: cannot be written ({why}); name a place that can") from error
