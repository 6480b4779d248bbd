"""Watching: a demonstration, by name or from a file, becomes a movement in the imitator's own senses."""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from babbling.axes import FloatArray
from experiments.shared.oracle import Retargeted, retarget
from imitation.acting.movement import Movement
from models.body import SimulatedBody
from models.errors import BodyError
from models.hoap2.facts import JOINTS
from models.motion import FORMATS, JointTrajectory, read_motion
from models.robots import limbs_of
from models.teachers.performance import Performance
from models.teachers.performing import perform
from models.teachers.urdf import perform_urdf, read_urdf, remarks


@dataclass(frozen=True)
class Seen:
    """What was watched, for the imitator (`movement`) and for those who judge (all else)."""

    movement: Movement
    angles: FloatArray
    """(T, J) demonstrated joint angles in the body's own order, rad."""
    performance: Performance | None
    """The teacher as it was seen; None when joint angles were given directly."""
    oracle: Retargeted | None
    """What inverse kinematics makes of the teacher; None when joint angles were given directly."""
    learned: Retargeted | None = None
    """What the learned correspondence made of it; None where inverse kinematics or joint angles were taken."""
    remarks: tuple[str, ...] = ()
    """What of a teacher did not correspond or was missing, a line each."""


def watch(demonstration: str, body: SimulatedBody, motion: Path | None = None) -> Seen:
    """See a demonstration with this body's eyes.

    Joint trajectories (.csv, .npz) are taken as they are; teachers (built-in, .amc) through limb directions and the
    identity correspondence of the chapter (inverse kinematics on HOAP-2); so is a URDF that performs `motion`, the
    joint angles in a file.

    Raises:
        BodyError: an unknown name, a broken file, joints this body does not have.
    """
    suffix = Path(demonstration).suffix.lower()
    if motion is not None and suffix != ".urdf":
        raise BodyError(f"--motion {motion}: only a robot's .urdf performs a motion, {demonstration!r} is none")
    if suffix in FORMATS:
        ranges = dict(zip(body.joints, map(tuple, body.joint_range), strict=True))
        trajectory = read_motion(Path(demonstration), ranges).reordered(body.joints).resampled(body.tick_s)
        return Seen(_felt(trajectory, body), trajectory.angles, None, None)
    performance, remarks = watch_urdf(demonstration, motion) if suffix == ".urdf" else (perform(demonstration), ())
    try:
        limbs_of(body.name, body.joints)
    except BodyError as error:
        columns = f"{' or '.join(sorted(FORMATS))} with columns {', '.join(body.joints[:3])} ..."
        raise BodyError(f"{error}; give this robot joint angles ({columns})") from None
    oracle = retarget(performance, body.tick_s)
    time = np.arange(len(oracle.angles), dtype=float) * body.tick_s
    trajectory = JointTrajectory(performance.name, time, JOINTS, oracle.angles).reordered(body.joints)
    return Seen(_felt(trajectory, body), trajectory.angles, performance, oracle, remarks=remarks)


def _felt(trajectory: JointTrajectory, body: SimulatedBody) -> Movement:
    return Movement(trajectory.name, body.tick_s, body.sensations(trajectory.angles))


def watch_urdf(demonstration: str, motion: Path | None) -> tuple[Performance, tuple[str, ...]]:
    """A robot out of a URDF, and what was not found in it.

    Raises:
        BodyError: no motion; a URDF without any limb; a motion of joints it does not have.
    """
    if motion is None:
        read_urdf(demonstration)
        raise BodyError(
            f"{demonstration}: a URDF does not move by itself; give its joint angles with --motion FILE.csv"
        )
    performance, found = perform_urdf(demonstration, read_motion(motion))
    said = remarks(found, demonstration)
    for line in said:
        print(f"imitate: {line}", file=sys.stderr)
    return performance, said
