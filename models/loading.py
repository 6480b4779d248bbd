"""Bodies by name or from any MJCF file with position actuators: the door between files and `SimulatedBody`."""

import os
from pathlib import Path

import mujoco
import numpy as np

from models.body import SimulatedBody
from models.errors import BodyError
from models.files import checked
from models.robots import ROBOTS, Robot, find
from models.standing import Individuals, StandingBody
from models.wear import ball_radius


def load_body(
    name_or_path: str | os.PathLike[str],
    *,
    copies: int = 1,
    threads: int = 2,
    noise: float = 0.0,
    scramble: int | None = None,
    seed: int = 0,
) -> SimulatedBody:
    """A registered robot, or any MJCF whose actuators are position servos.

    A body from a file is hung by its root (free joints removed) and touches nothing (contacts off), as the registered
    ones are: a body that falls over or knocks itself learns its falls, not its joints.

    Args:
        name_or_path: a name in `ROBOTS`, or a path that ends in .xml or .mjcf.
        copies: how many bodies.
        threads: worker threads.
        noise: standard deviation of the angle senses, rad.
        scramble: seed of an unknown wiring between mind and body.
        seed: randomness of the sensor noise.

    Raises:
        BodyError: an unknown name; a file that is missing, too large, does not compile or has no position actuators.
    """
    text = str(name_or_path)
    robot = find(text) or Robot(Path(text), text)
    model = compiled(robot)
    servos(model, text)
    return SimulatedBody(
        model,
        name=text,
        copies=copies,
        threads=threads,
        noise=noise,
        wear=robot.wear,
        sensors=robot.sensors,
        scramble=scramble,
        seed=seed,
    )


def load_standing(
    name: str,
    *,
    copies: int = 1,
    threads: int = 2,
    noise: float = 0.0,
    scramble: int | None = None,
    seed: int = 0,
    individuals: Individuals = Individuals(),  # noqa: B008  (frozen)
    tilt_deg: tuple[float, float] = (0.0, 0.0),
) -> StandingBody:
    """A registered robot on its own feet: see `load_body` and `StandingBody`.

    Raises:
        BodyError: a robot that cannot stand (those that can are listed).
    """
    robot = find(name)
    if robot is None or robot.stance is None:
        able = [one for one, known in ROBOTS.items() if known.stance]
        raise BodyError(
            f"{name}: it has no soles to stand on and feel with, or no balance organ; these have: {', '.join(able)}"
        )
    model = equipped(mujoco.MjSpec.from_file(str(robot.path)), robot).compile()
    how = {"copies": copies, "threads": threads, "noise": noise, "scramble": scramble, "seed": seed, "wear": robot.wear}
    return StandingBody(model, robot.stance, individuals=individuals, tilt_deg=tilt_deg, name=name, **how)


def hung(robot: Robot) -> mujoco.MjSpec:
    """A robot where it babbles: hung by its root (no free joint, nor its part of the keys), touching springs alone."""
    spec = mujoco.MjSpec.from_file(str(robot.path))
    free = [joint for joint in spec.joints if joint.type == mujoco.mjtJoint.mjJNT_FREE]
    if free:
        model = spec.compile()
        first = {int(model.jnt_qposadr[joint.id]) for joint in free}
        kept = [i for i in range(model.nq) if first.isdisjoint(range(i - 6, i + 1))]
        for key in spec.keys:
            key.qpos, key.qvel = np.array(key.qpos)[kept], []
    for joint in free:
        if robot.hangs_at is not None:
            joint.parent.pos = (0, 0, robot.hangs_at)
        spec.delete(joint)
    if robot.hangs_at is not None:
        top, look = robot.hangs_at + 0.09, {"group": 2, "contype": 0, "conaffinity": 0, "rgba": (0.35, 0.36, 0.38, 1)}
        stand, kind = spec.worldbody.add_body(name="stand", pos=(-0.22, 0, 0)), mujoco.mjtGeom
        stand.add_geom(name="stand_foot", type=kind.mjGEOM_CYLINDER, size=(0.12, 0.008, 0), pos=(0, 0, 0.008), **look)
        for name, size, line in (("pole", 0.012, (0, 0, 0, 0, 0, top)), ("arm", 0.01, (0, 0, top, 0.09, 0, top))):
            stand.add_geom(name=f"stand_{name}", type=kind.mjGEOM_CAPSULE, size=(size, 0, 0), fromto=line, **look)
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return equipped(spec, robot)


def equipped(spec: mujoco.MjSpec, robot: Robot) -> mujoco.MjSpec:
    """At a robot's size, with the springs that it has and the loads it carries."""
    if robot.size != 1:
        _resize(spec, robot.size)
    for joint, spring in robot.springs.items():
        ends = (spring.low, spring.high)
        spec.add_tendon(name=f"{joint}_spring", stiffness=spring.stiffness, springlength=ends).wrap_joint(joint, 1.0)
    for name, kg in robot.carries.items():
        held = spec.body(name)
        ball = held.add_body(name=f"{name}_payload", pos=held.ipos)
        ball.add_geom(size=(ball_radius(kg), 0, 0), mass=kg, group=2, contype=0, conaffinity=0)
    return spec


def _resize(spec: mujoco.MjSpec, size: float) -> None:
    for body in spec.bodies:
        body.pos, body.ipos = body.pos * size, body.ipos * size
    for thing in (*spec.geoms, *spec.sites):
        thing.pos, thing.size, thing.fromto = thing.pos * size, thing.size * size, thing.fromto * size
    for thing in (*spec.joints, *spec.cameras):
        thing.pos = thing.pos * size


def compiled(robot: Robot) -> mujoco.MjModel:
    """The compiled model of a robot where it babbles; see `hung`.

    Raises:
        BodyError: see `load_body`.
    """
    checked(robot.path)
    try:
        return hung(robot).compile()
    except (ValueError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise BodyError(f"{robot.path}: MuJoCo cannot compile it ({reason})") from error


def servos(model: mujoco.MjModel, name: str) -> None:
    """Check that every actuator is a position servo on a joint of its own, and give it a bounded command range.

    Raises:
        BodyError: no actuators, or one that is not a position servo; the actuator is named.
    """
    if model.nu == 0:
        raise BodyError(f"{name}: it has no position actuators; add <position joint=... kp=...> for each joint to move")
    taken: set[int] = set()
    for i in range(model.nu):
        label = model.actuator(i).name or f"number {i}"
        joint = int(model.actuator_trnid[i, 0])
        kp = model.actuator_gainprm[i, 0]
        single = int(model.actuator_trntype[i]) == int(mujoco.mjtTrn.mjTRN_JOINT) and int(model.jnt_type[joint]) in (
            int(mujoco.mjtJoint.mjJNT_HINGE),
            int(mujoco.mjtJoint.mjJNT_SLIDE),
        )
        if not single or kp <= 0 or not np.isclose(model.actuator_biasprm[i, 1], -kp) or joint in taken:
            raise BodyError(
                f"{name}: actuator {label!r} is not a position servo on a hinge or slide joint of its own; "
                "use <position joint=... kp=...>, one per joint"
            )
        taken.add(joint)
        if not model.jnt_limited[joint]:
            model.jnt_range[joint] = (-np.pi, np.pi)
        if not model.actuator_ctrllimited[i]:
            model.actuator_ctrlrange[i] = model.jnt_range[joint]
            model.actuator_ctrllimited[i] = 1
