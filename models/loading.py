"""Bodies by name or from any MJCF file with position actuators: the door between files and `SimulatedBody`."""

import os
from pathlib import Path

import mujoco
import numpy as np

from models.body import SimulatedBody
from models.errors import BodyError
from models.files import checked
from models.robots import ROBOTS, Robot, find
from models.servos import PULLS, driven, servos
from models.standing import Individuals, StandingBody
from models.trial import moved, quiet, spec_of
from models.wear import ball_radius

TICK_S, MOST_STEPS = 0.02, 1000
"""Seconds of a control tick, and how many physics steps it may take."""


def load_body(
    name_or_path: str | os.PathLike[str],
    *,
    copies: int = 1,
    threads: int = 2,
    noise: float = 0.0,
    scramble: int | None = None,
    seed: int = 0,
    give_servos: bool = False,
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
        give_servos: whether motors that know only torques, or speeds, get position servos; see `models.servos`.

    Raises:
        BodyError: an unknown name; a file that is missing, too large, does not compile or has no position actuators.
    """
    text = str(name_or_path)
    robot = find(text) or Robot(Path(text), text)
    model = compiled(robot)
    with quiet(robot.path):
        given = servos(model, text, give=give_servos)
        body = SimulatedBody(
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
    body.given = given
    return body


def rehearse(path: Path) -> None:
    """Load and move a stranger's robot, as far as its motors are servos, or can be given some.

    Raises:
        BodyError: see `load_body` and `models.trial.moved`.
    """
    model = compiled(Robot(path, str(path)))
    try:
        servos(model, str(path), give=True)
    except BodyError:  # is said in its place, after a card
        return
    moved(SimulatedBody(model, name=str(path), threads=1))


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
    spec = spec_of(robot.path, "models.loading:rehearse")
    model = spec.compile()
    roots = _roots(model, str(robot.path))
    free = [joint for joint in spec.joints if joint.id in roots]
    if free:
        gone = {place for joint in free for place in _places(model, joint.id)}
        kept = [i for i in range(model.nq) if i not in gone]
        for key in spec.keys:
            key.qpos, key.qvel = np.array(key.qpos)[kept] if len(key.qpos) else [], []
        names = {joint.name for joint in free}
        for sensor in [*spec.sensors]:
            if sensor.objtype == mujoco.mjtObj.mjOBJ_JOINT and sensor.objname in names:
                spec.delete(sensor)
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
    equipped(spec, robot)
    if not any(key.name == "home" for key in spec.keys):
        _find_home(spec)
    return spec


def _roots(model: mujoco.MjModel, name: str) -> set[int]:
    """Joints that only let a whole robot go where it will: free ones, and those between the world and the body that all
    its motors are on, which no motor, tendon or equality uses (planar bases)."""
    pulls = np.flatnonzero(np.isin(model.actuator_trntype, PULLS))
    pulled = {joint for i in pulls for joint in driven(model, int(i), name).joints}
    tied, wraps = model.eq_type == int(mujoco.mjtEq.mjEQ_JOINT), model.wrap_type == int(mujoco.mjtWrap.mjWRAP_JOINT)
    used = {*pulled, *model.wrap_objid[wraps], *model.eq_obj1id[tied], *model.eq_obj2id[tied]}
    carried = {int(model.body_rootid[model.jnt_bodyid[joint]]) for joint in pulled}
    kinds = zip(model.jnt_type, model.jnt_bodyid, strict=True)
    free = {joint for joint, (kind, _) in enumerate(kinds) if kind == int(mujoco.mjtJoint.mjJNT_FREE)}
    return free | {j for j in range(model.njnt) if j not in used and int(model.jnt_bodyid[j]) in carried}


def _places(model: mujoco.MjModel, joint: int) -> range:
    """Where a joint stands in a configuration."""
    size = {int(mujoco.mjtJoint.mjJNT_FREE): 7, int(mujoco.mjtJoint.mjJNT_BALL): 4}
    first = int(model.jnt_qposadr[joint])
    return range(first, first + size.get(int(model.jnt_type[joint]), 1))


def _find_home(spec: mujoco.MjSpec) -> None:
    """A keyframe `home` where there is none: the first keyframe, or zero as far as the joints' ranges allow it."""
    model = spec.compile()
    rest = np.array(model.key_qpos[0] if model.nkey else model.qpos0)
    for joint in range(model.njnt):
        place = _places(model, joint)
        if model.jnt_limited[joint] and len(place) == 1:
            rest[place[0]] = np.clip(rest[place[0]], *model.jnt_range[joint])
    if not np.array_equal(rest, model.qpos0):
        spec.add_key(name="home", qpos=rest)


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
        with quiet(robot.path):
            model = hung(robot).compile()
    except BodyError:
        raise
    except (ValueError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise BodyError(f"{robot.path}: MuJoCo cannot compile it ({reason})") from error
    steps = max(1.0, np.ceil(TICK_S / model.opt.timestep - 1e-9)) if model.opt.timestep > 0 else np.inf
    if steps > MOST_STEPS:
        raise BodyError(
            f"{robot.path}: its timestep of {model.opt.timestep:g} s makes {steps:g} steps of every control tick of "
            f"{TICK_S:g} s; {TICK_S / MOST_STEPS:g} s or more is possible"
        )
    model.opt.timestep = TICK_S / steps  # whole steps, none longer than it asked for
    return model
