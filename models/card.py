"""What stands on a robot's card: its motors, and all else that its MJCF says of it, as rows of text."""

from collections import Counter
from collections.abc import Iterator
from contextlib import suppress

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.errors import BodyError
from models.loading import TICK_S
from models.robots import Robot
from models.servos import driven, reach, servo
from models.trial import quiet, spec_of
from models.units import SHOWN

FEW = 6
"""Names that are said."""
_EQ = mujoco.mjtEq
CHAINS = (int(_EQ.mjEQ_CONNECT), int(_EQ.mjEQ_WELD))


def closed(model: mujoco.MjModel) -> bool:
    """Whether a chain of it is closed, so that joints cannot go everywhere one by one."""
    return bool(np.isin(model.eq_type[model.eq_active0.astype(bool)], CHAINS).any())


def as_written(robot: Robot) -> mujoco.MjModel:
    """The model as it stands in its file, neither hung nor equipped."""
    with quiet(robot.path):
        return spec_of(robot.path, "models.loading:rehearse").compile()


def motor_rows(model: mujoco.MjModel, name: str, *, give: bool = False) -> Iterator[tuple[object, ...]]:
    """Every actuator: its joint or tendon, range in what people read, and its servo or what is wrong with it. The model
    is rewritten as `models.servos` does."""
    taken = set[int]()
    for i in range(model.nu):
        label = model.actuator(i).name or f"number {i}"
        joint, ends = label, "-"
        try:
            try:
                given = servo(model, i, name, taken, give=give)[1] is not None
            finally:
                moved = driven(model, i, name)
                joint, (unit, scale) = moved.name, SHOWN[moved.unit]
                if model.jnt_limited[list(moved.joints)].all() or (np.ptp(reach(model, moved)) > 0):
                    ends = span(scale * reach(model, moved), unit)
                if len(moved.joints) > 1:
                    parts = zip(moved.shares, moved.joints, strict=True)
                    joint += " = " + " + ".join(
                        f"{share:g} ".removeprefix("1 ") + model.joint(one).name for share, one in parts
                    )
        except BodyError as error:
            wrong = str(error).removeprefix(f"{name}: actuator {label!r} ").split(";")[0]
            yield i + 1, joint, ends, f"REFUSED: {wrong}"
            continue
        per, (kp, kv) = moved.unit, np.abs(model.actuator_biasprm[i, 1:3])
        says = f"servo, kp {number(kp)} N{' m' * (per == 'rad')}/{per}, kv {number(kv)}"
        if model.actuator_forcelimited[i]:
            says += f", {span(model.actuator_forcerange[i], 'N m' if per == 'rad' else 'N')}"
        asked, able = model.actuator_ctrlrange[i], reach(model, moved)
        if ((asked - able) * [1, -1] > 0.01 * np.ptp(able)).any():  # more than it can do is a margin
            says += f", asked for {span(scale * asked, unit)}"
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
    yield "mass", f"{number(sum(float(part.mass[0]) for part in parts))} kg, of which {number(moving)} kg move"
    sorts = Counter(mujoco.mjtSensor(kind).name.removeprefix("mjSENS_").lower() for kind in raw.sensor_type)
    felt = _some(robot.sensors) if robot.sensors else "none"
    yield "sensors", (", ".join(f"{count} {kind}" for kind, count in sorts.items()) or "none") + f"; felt: {felt}"
    if robot.babbles == "eyes":
        yield "babbling", "with its eyes; see `imitate saccades`"


def _pulled(model: mujoco.MjModel) -> Iterator[tuple[int, ...]]:
    for i in range(model.nu):
        with suppress(BodyError):
            yield driven(model, i, "").joints


def _some(names: tuple[str, ...] | list[str]) -> str:
    return ", ".join(names[:FEW]) + (" ..." if len(names) > FEW else "")


def number(value: float) -> str:
    """Three digits."""
    return f"{value:.3g}" if abs(value) < 100 else f"{value:.0f}"


def span(ends: FloatArray, unit: str) -> str:
    """From where to where."""
    return f"{number(ends[0])} .. {number(ends[1])} {unit}"
