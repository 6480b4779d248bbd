"""A robot's card: what it is as a body that babbles, what would be refused, and a movement it can begin with."""

import csv
import os
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import mujoco
import numpy as np

from babbling.axes import FloatArray
from experiments.errors import ExperimentError
from experiments.robot.options import Config
from experiments.shared.baselines import direct_replay
from experiments.shared.tables import show, table
from models.body import SimulatedBody
from models.errors import BodyError
from models.loading import TICK_S, compiled, load_body
from models.robots import Robot, find
from models.servos import driven, reach, servo
from models.units import SHOWN

SECONDS, SWINGS, WIDEST, SPEED_SHARE = 8.0, 3, 0.6, 0.5
"""Of the template: s; joints swing once, twice, three times, once ...; most rad; share of the speed sense's range."""
INSET = 0.03
"""Share of a joint's range that the template leaves free at either end."""
FEW = 6
_EQ = mujoco.mjtEq
CHAINS = (int(_EQ.mjEQ_CONNECT), int(_EQ.mjEQ_WELD))


def command(config: Config) -> None:
    """Print the card; leave the template.

    Raises:
        BodyError: what `load_body` says of such a robot, after the card; without one where it does not compile.
        ExperimentError: the template cannot be written.
    """
    config.check()
    robot = find(config.robot) or Robot(Path(config.robot), config.robot)
    model = compiled(robot)
    raw = mujoco.MjSpec.from_file(str(robot.path)).compile()
    motors = list(motor_rows(model, config))
    show(f"**{config.robot}**" + (f": {robot.about}" if robot.about != config.robot else ""))
    show(table(motors, ("#", "joint", "range", "what moves it")))
    show(table(model_rows(robot, raw, model), ("model", "")))
    body = load_body(config.robot, give_servos=config.servos, threads=1)
    show(table(sense_rows(body), ("sense", "lines", "range")))
    wanted = template(body)
    away = np.abs(direct_replay(body, wanted) - wanted).max(0) * body.shown_scale
    worst = int(np.argmax(away))
    print(
        f"sent a gentle movement of all joints, it is off by {_number(away[worst])} {body.shown_units[worst]} at most "
        f"({body.joints[worst]})"
    )
    if config.template is not None:
        write(config.template, body, wanted)
        also = " --servos" if config.servos else ""
        print(f"\nwritten to {config.template}: imitate gesture --robot {config.robot}{also} "
              f"--demonstration {config.template}")  # fmt: skip


def motor_rows(model: mujoco.MjModel, config: Config) -> Iterator[tuple[object, ...]]:
    """Every actuator: its joint or tendon, range in what people read, and its servo or what is wrong with it. The model
    is rewritten as `models.servos` does."""
    taken = set[int]()
    for i in range(model.nu):
        name = model.actuator(i).name or f"number {i}"
        joint, ends = name, "-"
        try:
            try:
                given = servo(model, i, config.robot, taken, give=config.servos)[1] is not None
            finally:
                moved = driven(model, i, config.robot)
                joint, (unit, scale) = moved.name, SHOWN[moved.unit]
                if model.jnt_limited[list(moved.joints)].all() or (np.ptp(reach(model, moved)) > 0):
                    ends = _range(scale * reach(model, moved), unit)
                if len(moved.joints) > 1:
                    parts = zip(moved.shares, moved.joints, strict=True)
                    joint += " = " + " + ".join(
                        f"{share:g} ".removeprefix("1 ") + model.joint(one).name for share, one in parts
                    )
        except BodyError as error:
            wrong = str(error).removeprefix(f"{config.robot}: actuator {name!r} ").split(";")[0]
            yield i + 1, joint, ends, f"REFUSED: {wrong}"
            continue
        per, (kp, kv) = moved.unit, np.abs(model.actuator_biasprm[i, 1:3])
        says = f"servo, kp {_number(kp)} N{' m' * (per == 'rad')}/{per}, kv {_number(kv)}"
        if model.actuator_forcelimited[i]:
            says += f", {_range(model.actuator_forcerange[i], 'N m' if per == 'rad' else 'N')}"
        asked, able = model.actuator_ctrlrange[i], reach(model, moved)
        if ((asked - able) * [1, -1] > 0.01 * np.ptp(able)).any():  # more than it can do is a margin
            says += f", asked for {_range(scale * asked, unit)}"
        yield i + 1, joint, ends, says + (", given by --servos" if given else "")


def model_rows(robot: Robot, raw: mujoco.MjModel, model: mujoco.MjModel) -> Iterator[tuple[str, str]]:
    """What the MJCF says besides: `raw` as it stands there, `model` where it babbles."""
    keys = [raw.key(i).name or f"number {i}" for i in range(raw.nkey)]
    rests = "'home'" if "home" in keys else f"the first, {keys[0]!r}" if keys else "zero, within the ranges"
    yield "keyframes", f"{', '.join(keys[:FEW]) or 'none'}; it rests at {rests}"
    steps = round(TICK_S / model.opt.timestep)
    yield "timestep", f"{raw.opt.timestep:g} s, {steps} physics steps to a tick of {TICK_S:g} s"
    gone = raw.njnt - model.njnt
    yield "base", f"free ({gone} joint{'s' * (gone > 1)}); it is hung" if gone else "fixed"
    pulled = {joint for joints in _pulled(model) for joint in joints}
    names = [model.joint(j).name or f"number {j}" for j in range(model.njnt) if j not in pulled]
    yield "joints without a motor", f"{len(names)}" + (f": {_some(names)}" if names else "")
    kinds = Counter(_EQ(kind).name.removeprefix("mjEQ_").lower() for kind in model.eq_type)
    tied = ", ".join(f"{count} {kind}" for kind, count in kinds.items()) or "none"
    if np.isin(model.eq_type, CHAINS).any():
        tied += ": closed chains or what is held; joints cannot go everywhere one by one"
    yield "equality constraints", tied
    parts = [model.body(i) for i in range(1, model.nbody) if model.body(i).name != "stand"]
    moving = sum(float(part.mass[0]) for part in parts if model.body_weldid[part.id])
    yield "mass", f"{_number(sum(float(part.mass[0]) for part in parts))} kg, of which {_number(moving)} kg move"
    sorts = Counter(mujoco.mjtSensor(kind).name.removeprefix("mjSENS_").lower() for kind in raw.sensor_type)
    felt = _some(robot.sensors) if robot.sensors else "none"
    yield "sensors", (", ".join(f"{count} {kind}" for kind, count in sorts.items()) or "none") + f"; felt: {felt}"
    if robot.babbles == "eyes":
        yield "babbling", "with its eyes; see `imitate saccades`"


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
            yield channel.name, str(here.sum()), _range(np.array(ends), unit)


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
    closed = np.isin(body.model.eq_type, CHAINS).any()
    return np.asarray(np.clip(direct_replay(body, wanted), low, high) if closed else wanted)


def write(path: Path, body: SimulatedBody, angles: FloatArray) -> None:
    """A movement (T, J), one row a tick, as a table that people read; whole or not at all, over nothing.

    Raises:
        ExperimentError: it cannot be written, or something is there.
    """
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    header = ["time", *(f"{joint} [{unit}]" for joint, unit in zip(body.joints, body.shown_units, strict=True))]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with beside.open("w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(header)
            for tick, row in enumerate(angles * body.shown_scale):
                rows.writerow([f"{tick * TICK_S:.2f}", *(f"{value:.6f}" for value in row)])
        os.link(beside, path)  # unlike a renaming, refused where something is there
    except OSError as error:
        why = error.strerror or error
        raise ExperimentError(f"--template {path}: cannot be written ({why}); name a place that can") from error
    finally:
        with suppress(OSError):
            beside.unlink(missing_ok=True)


def _pulled(model: mujoco.MjModel) -> Iterator[tuple[int, ...]]:
    for i in range(model.nu):
        with suppress(BodyError):
            yield driven(model, i, "").joints


def _some(names: tuple[str, ...] | list[str]) -> str:
    return ", ".join(names[:FEW]) + (" ..." if len(names) > FEW else "")


def _number(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 100 else f"{value:.0f}"


def _range(ends: FloatArray, unit: str) -> str:
    return f"{_number(ends[0])} .. {_number(ends[1])} {unit}"
