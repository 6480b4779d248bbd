"""Position servos: what a body's motors must be, however an MJCF writes them, and servos for motors that have none.

Normal form, per motor with joint (or fixed tendon) position q: torque = kp (command - q) - kv q', the command in the
joint's own unit. MuJoCo writes force = g c + b0 + b1 L + b2 L' with L = gear q and torque = gear force; hence

    kp = -gear^2 b1,   kv = -gear^2 b2,   command = gear (g c + b0) / kp,

and limits of c and of the force are carried over. A servo for a bare torque motor follows from one bandwidth and one
damping ratio, all other joints held still:

    I q'' + (damping + kv) q' + kp q = kp command        =>   kp = I w^2,   kv = 2 zeta I w - damping

I is the joint's diagonal entry of the joint-space inertia at rest, armature included. The diagonal, and not the inverse
of the inverse's diagonal, because the other joints are servos too: they hold, they do not swing freely. w (rad/s)
follows from the bandwidth b, the frequency at which an isolated joint's answer to its command has fallen by 3 dB:
b = w / 2 pi * sqrt(1 - 2 zeta^2 + sqrt((1 - 2 zeta^2)^2 + 1)).
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.errors import BodyError

BANDWIDTH_HZ: Final = 8.0
"""-3 dB, within the 7 to 15 Hz of small servos; models/hoap2/README.md argues for it."""
DAMPING_RATIO: Final = 0.9
"""Overshoot 0.2 %, which no eye would see; a ratio of 1 needs 34 % more stiffness for the same bandwidth."""
_TRN, _JNT = mujoco.mjtTrn, mujoco.mjtJoint
PULLS = (int(_TRN.mjTRN_JOINT), int(_TRN.mjTRN_JOINTINPARENT), int(_TRN.mjTRN_TENDON))
"""Transmissions that move joints; adhesive palms, propellers and the like are others."""
_UNITS = {int(_JNT.mjJNT_HINGE): "rad", int(_JNT.mjJNT_SLIDE): "m"}


class Gains(NamedTuple):
    """What one servo gets: `inertia` kg m^2, `kp` N m/rad, `kv` N m s/rad (of a slide kg, N/m, N s/m)."""

    inertia: float
    kp: float
    kv: float


def natural_frequency_hz() -> float:
    """Undamped natural frequency of the second-order loop whose answer is down by 3 dB at BANDWIDTH_HZ."""
    a = 1 - 2 * DAMPING_RATIO**2
    return float(BANDWIDTH_HZ / np.sqrt(a + np.sqrt(a**2 + 1)))


def gains(inertia: float, damping: float) -> Gains:
    """The law above, to four digits; a joint that is damped more than that gets no damping besides."""
    w = 2 * np.pi * natural_frequency_hz()
    kv = max(2 * DAMPING_RATIO * inertia * w - damping, 0.0)
    return Gains(inertia, float(f"{inertia * w**2:.4g}"), float(f"{kv:.4g}"))


class Motor(NamedTuple):
    """What one motor of a model moves."""

    name: str
    unit: str
    """rad, or m of what slides."""
    joints: tuple[int, ...]
    """Joints that it moves together, by number."""
    shares: tuple[float, ...]
    """How much of each counts in its position: position = sum share q."""


def driven(model: mujoco.MjModel, actuator: int, name: str) -> Motor:
    """What an actuator pulls: a hinge, a slide, or a tendon over several of one kind.

    Raises:
        BodyError: anything else; `name` is the body's.
    """
    said = f"{name}: actuator {model.actuator(actuator).name or f'number {actuator}'!r}"
    kind, pulled = int(model.actuator_trntype[actuator]), int(model.actuator_trnid[actuator, 0])
    if kind not in PULLS:
        raise BodyError(
            f"{said} pulls neither a joint nor a tendon of joints (its transmission is {_TRN(kind).name[6:].lower()}); "
            "leave it out"
        )
    joints, shares = [pulled], [1.0]
    if kind != int(_TRN.mjTRN_TENDON):
        label = model.joint(pulled).name
    else:
        first, count = int(model.tendon_adr[pulled]), int(model.tendon_num[pulled])
        wraps = range(first, first + count)
        if any(model.wrap_type[i] != int(mujoco.mjtWrap.mjWRAP_JOINT) for i in wraps):
            raise BodyError(f"{said} pulls a tendon through space; only <fixed> tendons of joints are understood")
        label, joints = model.tendon(pulled).name, [int(model.wrap_objid[i]) for i in wraps]
        shares = [float(model.wrap_prm[i]) for i in wraps]
        if not any(shares):
            raise BodyError(f"{said} pulls tendon {label!r}, whose coefficients are all 0; it moves nothing")
    units = {_UNITS.get(int(model.jnt_type[joint]), "") for joint in joints}
    if len(units) != 1 or "" in units:
        raise BodyError(f"{said} moves no hinges alone and no slides alone; a servo turns hinges or drives slides")
    return Motor(label or f"joint {pulled}", units.pop(), tuple(joints), tuple(shares))


def resting(model: mujoco.MjModel) -> FloatArray:
    """(nq,) configuration of a model at rest: its keyframe `home`, or zero."""
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
    return np.array(model.key_qpos[key] if key >= 0 else model.qpos0)


def position(model: mujoco.MjModel, moved: Motor, qpos: FloatArray) -> FloatArray:
    """(...) where a motor's joints are in (..., nq) configurations, in its own unit."""
    return np.asarray(qpos[..., model.jnt_qposadr[list(moved.joints)]] @ np.array(moved.shares))


def posed(model: mujoco.MjModel, motors: Sequence[Motor], rest: FloatArray, positions: FloatArray) -> FloatArray:
    """(T, nq) configurations in which motors have (T, M) positions, all else as at `rest` (nq,): to draw a body.

    Joints that share a motor share its way; those that an equality ties to another follow it.
    """
    found = np.tile(rest, (len(positions), 1))
    for moved, told in zip(motors, positions.T, strict=True):
        shares = np.array(moved.shares)
        found[:, model.jnt_qposadr[list(moved.joints)]] = told[:, None] * shares / (shares @ shares)
    ties = (model.eq_type == int(mujoco.mjtEq.mjEQ_JOINT)) & (model.eq_obj2id >= 0) & model.eq_active0.astype(bool)
    driven = {joint for moved in motors for joint in moved.joints}
    for tie in np.flatnonzero(ties):
        follower, leader = int(model.eq_obj1id[tie]), int(model.eq_obj2id[tie])
        if follower not in driven:
            here, there = model.jnt_qposadr[follower], model.jnt_qposadr[leader]
            away = found[:, there] - model.qpos0[there]
            found[:, here] = model.qpos0[here] + np.polynomial.polynomial.polyval(away, model.eq_data[tie, :5])
    return found


def servos(model: mujoco.MjModel, name: str, *, give: bool = False) -> dict[str, Gains]:
    """See that every actuator is a position servo on joints of its own and bring it to normal form, in place.

    Args:
        model: compiled; its motors are rewritten where they are not in normal form.
        name: of the body, for errors.
        give: whether motors that have only torque (or a speed servo) get position servos.

    Returns:
        Joint -> gains of those that were given.

    Raises:
        BodyError: no actuators, or one that is no position servo; the actuator is named.
    """
    if model.nu == 0:
        raise BodyError(f"{name}: it has no position actuators; add <position joint=... kp=...> for each joint to move")
    taken, given, motors = set[int](), dict[str, Gains](), dict[str, Motor]()
    silent = ~model.key_ctrl.any(1)
    for i in range(model.nu):
        moved, found = servo(model, i, name, taken, give=give)
        if found is not None:
            given[moved.name] = found
        if moved.name in motors:
            raise BodyError(
                f"{name}: actuator {model.actuator(i).name or f'number {i}'!r} is one of two motors that move what is "
                f"named {moved.name!r}, a joint or a tendon; rename one of them"
            )
        motors[moved.name] = moved
    if given:  # explicit steps would have to be far shorter where a light joint sits on a heavy one
        model.opt.integrator = int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST)
    for i, moved in enumerate(motors.values()):  # without commands, or with torques, a key holds its posture
        keys = silent | (moved.name in given)
        held = position(model, moved, model.key_qpos[keys])
        model.key_ctrl[keys, i] = np.clip(held, *model.actuator_ctrlrange[i])
    return given


def servo(
    model: mujoco.MjModel, i: int, name: str, taken: set[int], *, give: bool = False
) -> tuple[Motor, Gains | None]:
    """See that actuator i is a position servo on joints not yet `taken` (they are added) and bring it to normal form.

    Raises:
        BodyError: see `servos`.
    """
    moved = driven(model, i, name)
    said = f"{name}: actuator {model.actuator(i).name or f'number {i}'!r}"
    if not taken.isdisjoint(moved.joints):
        raise BodyError(f"{said} is not a position servo on a joint of its own: another one moves it too")
    taken |= {*moved.joints}
    bare = _bare(model, i, said, give)
    _limit(model, i, moved, said)
    if bare:
        return moved, _give(model, i, moved)
    _normal(model, i, moved, said)
    return moved, None


def _bare(model: mujoco.MjModel, i: int, said: str, give: bool) -> bool:
    """Whether it is a torque motor or a speed servo, which gets a servo."""
    fixed = model.actuator_gaintype[i] == int(mujoco.mjtGain.mjGAIN_FIXED)
    plain = fixed and model.actuator_dyntype[i] == int(mujoco.mjtDyn.mjDYN_NONE)
    affine = model.actuator_biastype[i] == int(mujoco.mjtBias.mjBIAS_AFFINE)
    bias = model.actuator_biasprm[i] if affine else np.zeros(3)
    if plain and affine and bias[1] < 0 and model.actuator_gainprm[i, 0] > 0:
        return False
    kind = "speed servo" if bias[2] < 0 else "torque motor"
    if not plain or bias[1] or not (affine or model.actuator_biastype[i] == int(mujoco.mjtBias.mjBIAS_NONE)):
        raise BodyError(
            f"{said} is not a position servo but has dynamics of its own (muscle, cylinder, filter or the like); "
            "use <position joint=... kp=...>, one per joint"
        )
    if not give:
        raise BodyError(
            f"{said} is not a position servo but a {kind}; --servos gives each such motor one, or use "
            "<position joint=... kp=...>, one per joint"
        )
    return True


def _limit(model: mujoco.MjModel, i: int, moved: Motor, said: str) -> None:
    """Joints that may go anywhere get a range: hinges a turn; a slide's would be a guess."""
    for joint in moved.joints:
        if not model.jnt_limited[joint]:
            if moved.unit == "m":
                raise BodyError(f"{said} drives slide {model.joint(joint).name!r}, which has no range; give it one")
            model.jnt_range[joint] = (-np.pi, np.pi)
        low, high = model.jnt_range[joint]
        if not low < high:
            raise BodyError(f"{said} moves {model.joint(joint).name!r}, whose range {low:g} to {high:g} is empty")


def reach(model: mujoco.MjModel, moved: Motor) -> FloatArray:
    """(2,) least and greatest position that the joints of a motor allow."""
    ends = model.jnt_range[list(moved.joints)] * np.array(moved.shares)[:, None]
    return np.asarray(np.sort(ends, axis=1).sum(0))


def _normal(model: mujoco.MjModel, i: int, moved: Motor, said: str) -> None:
    gear, gain, (b0, b1, b2) = model.actuator_gear[i, 0], model.actuator_gainprm[i, 0], model.actuator_biasprm[i, :3]
    limited = bool(model.actuator_ctrllimited[i])
    if gear != 1 or b0 != 0 or not np.isclose(gain, -b1):
        if not gear:
            raise BodyError(f"{said} has gear 0 and moves nothing; give it one")
        kp = -(gear**2) * b1
        for told in (model.actuator_ctrlrange[i : i + 1], model.key_ctrl[:, i : i + 1]):
            told[:] = gear * (gain * told + b0) / kp
        _write(model, i, kp, -(gear**2) * b2, gear)
    if not limited:
        model.actuator_ctrlrange[i] = reach(model, moved)
        model.actuator_ctrllimited[i] = 1


def _give(model: mujoco.MjModel, i: int, moved: Motor) -> Gains:
    gear, gain = model.actuator_gear[i, 0], model.actuator_gainprm[i, 0]
    data = mujoco.MjData(model)
    data.qpos[:] = resting(model)
    mujoco.mj_forward(model, data)
    full, way = np.zeros((model.nv, model.nv)), np.zeros(model.nv)
    mujoco.mj_fullM(model, data, full)
    shares = np.array(moved.shares)
    way[model.jnt_dofadr[list(moved.joints)]] = shares / (shares @ shares)
    found = gains(float(way @ full @ way), float(way**2 @ model.dof_damping))
    affine = model.actuator_biastype[i] == int(mujoco.mjtBias.mjBIAS_AFFINE)
    bias = model.actuator_biasprm[i] if affine else np.zeros(3)
    if not bias[2] and model.actuator_ctrllimited[i]:  # what it could be told is what it can do
        most = np.sort(gain * model.actuator_ctrlrange[i] + bias[0])
        if model.actuator_forcelimited[i]:
            most = np.clip(most, *model.actuator_forcerange[i])
        model.actuator_forcerange[i], model.actuator_forcelimited[i] = most, 1
    model.actuator_biastype[i] = int(mujoco.mjtBias.mjBIAS_AFFINE)
    _write(model, i, found.kp, found.kv, gear)
    model.actuator_ctrlrange[i], model.actuator_ctrllimited[i] = reach(model, moved), 1
    return found


def _write(model: mujoco.MjModel, i: int, kp: float, kv: float, gear: float) -> None:
    model.actuator_ctrlrange[i] = np.sort(model.actuator_ctrlrange[i])
    model.actuator_forcerange[i] = np.sort(gear * model.actuator_forcerange[i])
    model.actuator_gear[i], model.actuator_gainprm[i, 0] = [1, 0, 0, 0, 0, 0], kp
    model.actuator_biasprm[i, :3] = 0, -kp, -kv
