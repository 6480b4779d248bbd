"""Watching: a demonstration, by name or from a file, becomes a movement in the imitator's own senses."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from imitation.acting.movement import Movement
from models.body import SimulatedBody
from models.errors import BodyError
from models.motion import FORMATS, JointTrajectory, read_motion
from models.retargeting import Retargeted, retarget
from models.robots import limbs_of
from models.teachers.performance import Performance
from models.teachers.performing import perform
from models.teachers.urdf import perform_urdf, read_urdf, remarks

if TYPE_CHECKING:
    from experiments.shared.mirrors import Corresponded


@dataclass(frozen=True)
class Seen:
    """What was watched, for the imitator (`movement`) and for those who judge (all else)."""

    movement: Movement
    angles: NDArray[np.float64]
    """(T, J) demonstrated joint angles in the body's own order, rad."""
    performance: Performance | None
    """The teacher as it was seen; None when joint angles were given directly."""
    retargeted: Retargeted | None
    corresponded: "Corresponded | None" = None
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
        trajectory = read_motion(Path(demonstration), ranges).reordered(body.joints)
        return _seen(trajectory, body, None, None)
    performance, remarks = watch_urdf(demonstration, motion) if suffix == ".urdf" else (perform(demonstration), ())
    try:
        limbs_of(body.name, body.joints)
    except BodyError as error:
        columns = f"{' or '.join(sorted(FORMATS))} with columns {', '.join(body.joints[:3])} ..."
        raise BodyError(f"{error}; give this robot joint angles ({columns})") from None
    retargeted = retarget(performance, body.tick_s)
    seen = _seen(retargeted.trajectory.reordered(body.joints), body, performance, retargeted)
    return replace(seen, remarks=remarks)


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


def _seen(
    trajectory: JointTrajectory, body: SimulatedBody, performance: Performance | None, retargeted: Retargeted | None
) -> Seen:
    even = trajectory if retargeted is not None else trajectory.resampled(body.tick_s)
    angles = np.asarray(even.angles, float)
    return Seen(Movement(trajectory.name, body.tick_s, body.sensations(angles)), angles, performance, retargeted)


def retarget_metrics(seen: Seen) -> Mapping[str, Any]:
    """How well limb directions could be met at all; zeros when joint angles were given."""
    r = seen.retargeted
    if r is None:
        return {"retarget_error_deg": 0.0, "retarget_reachable_error_deg": 0.0, "unreachable_share": 0.0}
    return {
        "retarget_error_deg": r.mean_error_deg,
        "retarget_reachable_error_deg": float(np.mean(r.reachable_error_deg)),
        "unreachable_share": r.unreachable_share,
        "retarget_error_deg_by_part": {part: float(np.mean(e)) for part, e in r.error_deg.items()},
    }
