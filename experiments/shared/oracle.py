"""The oracle: what the correspondence makes of a teacher when the body image is exact instead of learned.

HOAP-2's directions come from Pinocchio. A body of hinges is met exactly by the body image's table of harmonics
(`babbling.body_image`), so three looks per joint say all: nothing else differs between the oracle and who learned.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from types import MappingProxyType

import numpy as np
from scipy.interpolate import CubicSpline

from babbling.axes import BoolArray, FloatArray
from babbling.body_image import LIBRARY, Image, PartImage
from babbling.mirroring import angles_between
from imitation.correspondence.correspondence import Corresponded, correspond
from models.hoap2.facts import JOINTS, SPEED_LIMIT, joint_class
from models.hoap2.kinematics import directions, ranges
from models.hoap2.limbs import SEGMENTS
from models.motion.trajectory import frame_times
from models.teachers.performance import Performance, unit

REST = np.deg2rad([90.0 * joint.endswith("arm_joint_1") for joint in JOINTS])
"""Where joints stay that nothing seen decides: arms hanging, all else at zero."""
SPEED = np.array([SPEED_LIMIT[joint_class(joint)] for joint in JOINTS])
ALIKE_DEG = 3.0
"""Parts that never point further apart than this may be taken for each other: both thighs of somebody who stands."""
FROM_LOOKS = np.array([[0.0, 1.0, 0.0], [-0.5, 0.0, 0.5], [0.5, -1.0, 0.5]])
"""Weights of 1, sin and 1 - cos out of values at -90, 0 and 90 degrees."""


@dataclass(frozen=True, eq=False)
class Retargeted:
    """A teacher's movement that went through a correspondence, learned or the oracle's, for those who judge.

    Frames are the teacher's own; `found.slowed` says how much slower the body is to take them. angles (T, J): the
    sub-goals in the body's own joint order, rad. shown (T, P, 3): where the body really points with them; teacher
    (T, P, 3): where the teacher pointed; both in the order of found.parts.
    """

    found: Corresponded
    angles: FloatArray
    shown: FloatArray
    teacher: FloatArray
    mistaken_deg: Mapping[str, float] = field(default_factory=dict)
    """Parts that were taken for others of the teacher's, and how far these differed at most."""

    @property
    def error_deg(self) -> FloatArray:
        """(T, P) degrees between what the body shows and what the teacher showed."""
        return np.rad2deg(angles_between(self.shown, self.teacher))

    @property
    def error_deg_by_part(self) -> dict[str, float]:
        """Part -> its mean error."""
        return dict(zip(self.found.parts, self.error_deg.mean(0).tolist(), strict=True))

    @property
    def recognised(self) -> dict[str, float]:
        """Share of parts taken for what they are, and of those or others that pointed within ALIKE_DEG all the time."""
        away, count = self.mistaken_deg.values(), len(self.found.parts)
        unlike = sum(one > ALIKE_DEG for one in away)
        return {"parts_right_share": 1 - len(away) / count, "parts_alike_share": 1 - unlike / count}

    def speeds(self, tick_s: float) -> FloatArray:
        """(T - 1, J) of the sub-goals, rad/s."""
        return np.asarray(np.abs(np.diff(self.angles, axis=0)) / (self.found.slowed * tick_s))

    @property
    def best_deg(self) -> FloatArray:
        """(T, P) the oracle's alone, the limit of HOAP-2's joints: what the posture found for a frame by itself, as if
        there were time to reach it, misses of the steadied directions. Among postures MARGIN inside the ranges it is
        the most probable path's, which weighs a limb's inner parts above its outer ones."""
        return np.rad2deg(angles_between(_pointing(self.found.chosen, self.found.parts), self.found.wanted))

    @property
    def changed_deg(self) -> FloatArray:
        """By how much what can be shown (reachable parts and frames) was turned on the way to sub-goals: steadying and
        smoothing, added up."""
        turned = angles_between(self.found.wanted, self.teacher) + self.found.moved
        return np.rad2deg(turned[self.found.reachable])

    def mean_error_deg(self, where: BoolArray) -> float:
        """Mean over the parts and frames (T, P) named; 0 for none."""
        values = self.error_deg[where]
        return float(values.mean()) if len(values) else 0.0


def retarget(performance: Performance, dt: float = 0.02) -> Retargeted:
    """HOAP-2's angles for a performance, one frame every `dt` seconds; joints in the order of JOINTS."""
    teacher = at_ticks(performance, dt)
    found = correspond(known_image(), performance.name, teacher, dt, SPEED)
    shown = _pointing(found.postures, found.parts)
    return Retargeted(found, found.postures, shown, np.stack([teacher[part] for part in found.parts], 1))


def _pointing(angles: FloatArray, parts: tuple[str, ...]) -> FloatArray:
    """(T, P, 3) where these parts of HOAP-2 point."""
    return np.asarray(directions(angles)[:, [list(SEGMENTS).index(part) for part in parts]])


def at_ticks(performance: Performance, tick_s: float) -> dict[str, FloatArray]:
    """Part -> (T, 3) directions of a teacher at the imitator's ticks, seen without noise."""
    time = frame_times(float(performance.time[-1]), tick_s, performance.name)
    return {
        part: unit(CubicSpline(performance.time, values, axis=0)(time))
        for part, values in performance.directions.items()
    }


@cache
def known_image() -> Image:
    """HOAP-2's body image as its kinematics say: exact in every posture."""
    low, high = ranges()
    centre = (low + high) / 2
    library = np.random.default_rng(0).uniform(low, high, (LIBRARY, len(low)))
    some = library[:20]
    turned = [directions(some + joint) - directions(some) for joint in np.eye(len(low))]
    moves = np.abs(turned).max((1, 3)).T > 1e-9
    images = {}
    for number, (part, moved) in enumerate(zip(SEGMENTS, moves, strict=True)):
        joints = np.flatnonzero(moved)
        corners = np.indices((3,) * len(joints)).reshape(len(joints), -1).T - 1
        postures = np.tile(centre, (len(corners), 1))
        postures[:, joints] += np.pi / 2 * corners
        weights = directions(postures)[:, number].reshape(*(3,) * len(joints), 3)
        for axis in range(len(joints)):
            weights = np.moveaxis(np.tensordot(FROM_LOOKS, weights, (1, axis)), 0, axis)
        images[part] = PartImage(joints, centre[joints], weights.reshape(-1, 3), 0.0)
    return Image(MappingProxyType(images), low, high, REST, library, np.zeros((LIBRARY, len(SEGMENTS))))
