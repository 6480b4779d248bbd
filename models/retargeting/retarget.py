"""From what is seen of a teacher to HOAP-2's joint angles, computed from the robot's own kinematics.

The identity correspondence of the chapter, and the oracle that a learned one is compared with.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from models.hoap2.facts import SPEED_LIMIT, joint_class
from models.hoap2.limbs import LIMBS
from models.motion.trajectory import JointTrajectory, frame_times
from models.retargeting.chain import chain, hoap2_directions, joints, pose
from models.retargeting.smooth import smooth
from models.retargeting.solve import solve
from models.teachers.performance import Performance, unit

Array = NDArray[np.float64]
MARGIN = np.deg2rad(1.0)
"""Distance kept from every joint stop."""
REACHABLE_DEG = 5.0
"""A direction counts as reachable in a frame where inverse kinematics alone comes nearer than this."""
LEAST_STIFFNESS = 1e-9
"""Pull towards rest of every joint; only felt where it changes no direction (a twist of a straight arm)."""
REST_DEG: Mapping[str, float] = MappingProxyType({"left_arm_joint_1": 90.0, "right_arm_joint_1": 90.0})
"""Where joints stay that nothing seen decides: arms hanging, all else at zero."""


@dataclass(frozen=True, eq=False)
class Retargeted:
    """A teacher's movement as HOAP-2 can do it.

    trajectory: all 25 joints, every `dt` seconds.
    error_deg: seen part -> (T,) degrees between the teacher's direction and HOAP-2's.
    reachable: seen part -> (T,) whether inverse kinematics alone comes within REACHABLE_DEG.
    moved_deg: seen part -> (T,) degrees by which smoothing and speed limits moved the direction.
    hurried: seen part -> (T,) whether a joint of its limb works at its speed limit nearby, so that it comes late.
    """

    trajectory: JointTrajectory
    error_deg: Mapping[str, Array]
    reachable: Mapping[str, NDArray[np.bool_]]
    moved_deg: Mapping[str, Array]
    hurried: Mapping[str, NDArray[np.bool_]]

    @property
    def reachable_error_deg(self) -> Array:
        """Errors of all reachable parts and frames, one after the other."""
        return np.concatenate([self.error_deg[part][self.reachable[part]] for part in self.error_deg])

    @property
    def mean_error_deg(self) -> float:
        """Mean error over all parts and frames, reachable or not."""
        return float(np.mean(list(self.error_deg.values())))

    @property
    def unreachable_share(self) -> float:
        """Share of parts and frames that are not reachable."""
        return float(1 - np.mean(list(self.reachable.values())))


def retarget(performance: Performance, dt: float = 0.02) -> Retargeted:
    """HOAP-2's angles for a performance, by inverse kinematics on limb directions in the torso's frame.

    Per limb, from the torso outwards: each frame on its own first, then the smoothest movement that shows the same
    directions within joint ranges (MARGIN inside) and speed limits. Parts not seen leave their joints at rest.
    """
    time = frame_times(float(performance.time[-1]), dt, performance.name)
    wanted = {
        part: unit(CubicSpline(performance.time, values, axis=0)(time))
        for part, values in performance.directions.items()
    }
    names = joints()
    angles = np.deg2rad(np.tile([REST_DEG.get(joint, 0.0) for joint in names], (len(time), 1)))
    reachable, moved, hurried = {}, {}, {}
    for limb in LIMBS.values():
        segments = [segment for segment in limb.segments if segment.part in wanted]
        if not segments:
            continue
        own = chain(limb.joints, segments, MARGIN)
        columns = [names.index(joint) for joint in limb.joints]
        targets = np.stack([wanted[segment.part] for segment in segments], axis=1)
        if limb.hangs_from is not None:
            carrier = pose(limb.hangs_from, angles[:, names.index(limb.hangs_from)])
            targets = np.einsum("tji,tsj->tsi", carrier, targets)
        rest = np.clip(angles[0, columns], own.low, own.high)
        weights = np.array([segment.weight for segment in segments])
        stiffness = np.array([limb.stiffness.get(joint, LEAST_STIFFNESS) for joint in limb.joints])
        single = solve(own, targets, weights, rest, stiffness)
        shown, _ = own.directions(single)
        near = _degrees_between(shown, targets) < REACHABLE_DEG
        speed = np.array([SPEED_LIMIT[joint_class(joint)] for joint in limb.joints])
        smoothed = smooth(own, single, np.sqrt(weights), near, rest, speed, dt)
        angles[:, columns] = smoothed.angles
        away = _degrees_between(own.directions(smoothed.angles)[0], shown)
        for number, segment in enumerate(segments):
            reachable[segment.part], moved[segment.part] = near[:, number], away[:, number]
            hurried[segment.part] = smoothed.hurried
    trajectory = JointTrajectory(performance.name, time, names, angles)
    final = hoap2_directions(trajectory)
    return Retargeted(
        trajectory,
        MappingProxyType({part: _degrees_between(final[part], wanted[part]) for part in reachable}),
        MappingProxyType(reachable),
        MappingProxyType(moved),
        MappingProxyType(hurried),
    )


def _degrees_between(first: Array, second: Array) -> Array:
    """Angles between unit vectors along the last axis; exact for small ones too."""
    return np.asarray(np.rad2deg(2 * np.arcsin(np.clip(np.linalg.norm(first - second, axis=-1) / 2, 0, 1))))
