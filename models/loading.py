"""Bodies by name or from any MJCF file with position actuators: the door between files and `SimulatedBody`."""

import os
from pathlib import Path

import mujoco
import numpy as np

from models.body import SimulatedBody
from models.errors import BodyError
from models.files import checked
from models.robots import Robot, find


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
    model = compiled(robot.path)
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


def compiled(path: Path) -> mujoco.MjModel:
    """The compiled model of an MJCF file, hung by its root and without contacts.

    Raises:
        BodyError: see `load_body`.
    """
    checked(path)
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        free = [joint for joint in spec.joints if joint.type == mujoco.mjtJoint.mjJNT_FREE]
        if free:
            for joint in free:
                spec.delete(joint)
            for key in list(spec.keys):  # their qpos has the free joint in it
                spec.delete(key)
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        return spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise BodyError(f"{path}: MuJoCo cannot compile it ({reason})") from error


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
