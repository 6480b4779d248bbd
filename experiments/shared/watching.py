"""Watching: a demonstration, by name or from a file, becomes a movement in the imitator's own senses."""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from babbling.axes import FloatArray
from experiments.shared.oracle import Retargeted, retarget
from imitation.acting.movement import Movement, slowed
from imitation.correspondence.smooth_path import SLOWEST, within_speed
from models.body import SimulatedBody
from models.errors import BodyError
from models.hoap2.facts import JOINTS
from models.motion import FORMATS, JointTrajectory, read_motion
from models.motion.checks import beyond, gaps
from models.motion.tables import Unit
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
    slowed: float
    """How many times as long as demonstrated the movement takes, so that the servos keep up."""
    performance: Performance | None = None
    """The teacher as it was seen; None when joint angles were given directly."""
    oracle: Retargeted | None = None
    """What inverse kinematics makes of the teacher; None when joint angles were given directly."""
    learned: Retargeted | None = None
    """What the learned correspondence made of it; None where inverse kinematics or joint angles were taken."""
    remarks: tuple[str, ...] = ()
    """What of a movement was missing, did not correspond or was bent, a line each."""

    @property
    def teacher(self) -> Performance | None:
        """The teacher at the pace at which it is imitated."""
        return self.performance and replace(self.performance, time=self.performance.time * self.slowed)

    @classmethod
    def paced(cls, name: str, angles: FloatArray, factor: float, body: SimulatedBody) -> "Seen":
        """Joint angles (T, J), one a tick, to be taken `factor` times as slowly."""
        angles = np.clip(slowed(angles, factor), *body.joint_range.T)
        if 1 < factor < SLOWEST:  # the spline may swing beyond sharp corners
            angles = within_speed(angles, fastest(body))
        return cls(Movement(name, body.tick_s, body.sensations(angles)), angles, factor)

    def learning(self, found: Retargeted, body: SimulatedBody) -> "Seen":
        """The same, with what the learned correspondence makes of it as sub-goals."""
        paced = self.paced(self.movement.name, found.angles, found.found.slowed, body)
        return replace(paced, performance=self.performance, oracle=self.oracle, learned=found, remarks=self.remarks)


def watch(demonstration: str, body: SimulatedBody, motion: Path | None = None, unit: Unit | None = None) -> Seen:
    """See a demonstration with this body's eyes.

    Joint trajectories (`models.motion.FORMATS`; `unit` of their angles, where given, overrules what they say) are taken
    as they are, but slower where the servos would not keep up; teachers (built-in, .amc, .bvh) through limb directions
    and the identity correspondence of the chapter (inverse kinematics on HOAP-2); so is a URDF that performs `motion`,
    the joint angles in a file.

    Raises:
        BodyError: an unknown name, a broken file, joints this body does not have.
    """
    suffix = Path(demonstration).suffix.lower()
    if motion is not None and suffix != ".urdf":
        raise BodyError(f"--motion {motion}: only a robot's .urdf performs a motion, {demonstration!r} is none")
    if suffix in FORMATS:
        return told(watch_angles(Path(demonstration), body, unit))
    performance, remarks = (
        watch_urdf(demonstration, motion, unit) if suffix == ".urdf" else (perform(demonstration), ())
    )
    try:
        limbs_of(body.name, body.joints)
    except BodyError as error:
        columns = f"{' or '.join(sorted(FORMATS))} with columns {', '.join(body.joints[:3])} ..."
        raise BodyError(f"{error}; give this robot joint angles ({columns})") from None
    oracle = retarget(performance, body.tick_s)
    time = np.arange(len(oracle.angles), dtype=float) * body.tick_s
    trajectory = JointTrajectory(performance.name, time, JOINTS, oracle.angles).reordered(body.joints)
    paced = Seen.paced(performance.name, trajectory.angles, oracle.found.slowed, body)
    return told(replace(paced, performance=performance, oracle=oracle, remarks=remarks + performance.remarks))


def told(seen: Seen) -> Seen:
    """The same; its remarks are said."""
    for line in seen.remarks:
        print(f"imitate: {line}", file=sys.stderr)
    return seen


def watch_angles(path: Path, body: SimulatedBody, unit: Unit | None) -> Seen:
    """Joint angles in a file; joints that it does not name stay where they are (at home, as long as it did not move).

    Raises:
        BodyError: see `watch`.
    """
    ranges = dict(zip(body.joints, map(tuple, body.joint_range), strict=True))
    slides = [joint for joint, one in zip(body.joints, body.units, strict=True) if one == "m"]
    given = read_motion(path, ranges, unit, slides)
    movement = given.reordered(body.joints, body.joint_angles[0]).resampled(body.tick_s)
    factor = in_time(movement.angles, body)
    resting = [joint for joint in body.joints if joint not in given.joints]
    remarks = [*gaps(given), *beyond(movement, body.joint_range, slides)]
    if resting:
        most = ", ".join(resting[:3]) + (" ..." if len(resting) > 3 else "")
        remarks.insert(0, f"{path}: names {len(given.joints)} of {len(body.joints)} joints; at rest stay {most}")
    if factor > 1:
        pace = np.abs(np.diff(movement.angles, axis=0)) / fastest(body)
        tick, joint = np.unravel_index(int(pace.argmax()), pace.shape)
        remarks.append(
            f"{path}: joint {body.joints[joint]!r} moves {pace.max():.1f} times as fast as its servo can at "
            f"{tick * body.tick_s:.2f} s; the whole is done {factor:.2f} times as slowly"
        )
    return replace(Seen.paced(movement.name, movement.angles, factor, body), remarks=tuple(remarks))


def fastest(body: SimulatedBody) -> FloatArray:
    """(J,) how far each joint can go within a tick, as the ranges of its speed senses have it."""
    return np.asarray(body.senses.read(body.sense_high, "speed") * body.tick_s)


def in_time(angles: FloatArray, body: SimulatedBody) -> float:
    """How many times as long the body needs for joint angles (T, J), one a tick: 1 to SLOWEST."""
    factor, over = 1.0, np.inf
    while over > 1 and factor < SLOWEST:
        over = float((np.abs(np.diff(slowed(angles, factor), axis=0)) / fastest(body)).max())
        factor = min(1.001 * over * factor, SLOWEST) if over > 1 else factor
    return factor


def watch_urdf(
    demonstration: str, motion: Path | None, unit: Unit | None = None
) -> tuple[Performance, tuple[str, ...]]:
    """A robot out of a URDF, and what was not found in it.

    Raises:
        BodyError: no motion; a URDF without any limb; a motion of joints it does not have.
    """
    teacher = read_urdf(demonstration)
    if motion is None:
        raise BodyError(
            f"{demonstration}: a URDF does not move by itself; give its joint angles with --motion FILE.csv"
        )
    movement = read_motion(motion, None, unit, teacher.slides, teacher.limits)
    performance, found = perform_urdf(demonstration, movement)
    return performance, (*remarks(found, demonstration), *gaps(movement))
