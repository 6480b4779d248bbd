"""What is seen of a teacher: where its body parts point, in its own torso's frame.

Bodies differ in lengths, joints and zero postures; the direction in which a forearm points does not. Directions of
body parts are the in-between format from which any body with limbs can imitate (the supramodal frame of active
intermodal mapping; Meltzoff and Moore 1997, and Figure 9 of Rao, Shon and Meltzoff 2007).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from models.arrays import BoolArray, FloatArray
from models.errors import BodyError

SIDES = ("left", "right")
LIMB_PARTS = ("upper_arm", "forearm", "thigh", "shank", "foot")
PARTS: tuple[str, ...] = (*(f"{side}_{part}" for side in SIDES for part in LIMB_PARTS), "head", "trunk")
"""Body parts with a direction: upper arm and forearm point to the hand, thigh and shank to the foot, the foot to its
toes, the head along its nose, and the trunk is the pelvis' upward axis (so that bending at the waist shows)."""
BEGINS_AT: Mapping[str, str] = MappingProxyType({"forearm": "upper_arm", "shank": "thigh", "foot": "shank"})
"""Part of a limb -> the one at whose end it begins."""


class TeacherError(BodyError):
    """Something about a teacher or its movement that the user can mend."""


@dataclass(frozen=True, eq=False)
class Performance:
    """A movement as it is seen.

    name, teacher: which movement, and whose.
    time: (T,) seconds, strictly increasing from 0.
    directions: part of PARTS -> (T, 3) unit vectors in the torso's frame, x forward, y left, z up.
    points: (T, K, 3) metres in the world, z up: where the teacher's joints are, to draw it.
    bones: pairs of point indices that are connected.
    remarks: what of it was not as usual, a line each.
    torso: (T, 3, 3) its rotation among the points, to draw it from in front; None where it is not known.
    begins: part -> index of the point where it begins, as far as both are known.
    The arrays are copied and read-only.
    """

    name: str
    teacher: str
    time: FloatArray
    directions: Mapping[str, FloatArray]
    points: FloatArray
    bones: tuple[tuple[int, int], ...]
    remarks: tuple[str, ...] = ()
    torso: FloatArray | None = None
    begins: Mapping[str, int] = field(default_factory=dict)

    @property
    def ahead(self) -> FloatArray:
        """(T, K, 3) the points about the torso's upright, turned to face x as nearly as it can: by the psi that
        maximises tr(Rz(psi) R) of its rotation R, -atan2(R10 - R01, R00 + R11)."""
        return self.points if self.torso is None else self._turned(self.torso, self.points)

    @property
    def pointing(self) -> dict[str, FloatArray]:
        """Part of `begins` -> (T, 3) unit vector that it points along among the points that look `ahead`."""
        if self.torso is None:
            return {}
        ways = np.stack([self.directions[part] for part in self.begins], 1)
        ahead = self._turned(self.torso, np.einsum("tij,tpj->tpi", self.torso, ways))
        return dict(zip(self.begins, np.moveaxis(ahead, 1, 0), strict=True))

    @staticmethod
    def _turned(torso: FloatArray, points: FloatArray) -> FloatArray:
        yaw = np.arctan2(torso[:, 1, 0] - torso[:, 0, 1], torso[:, 0, 0] + torso[:, 1, 1])
        cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
        x, y, z = np.moveaxis(points, -1, 0)
        return np.stack([cos * x + sin * y, cos * y - sin * x, z], -1)

    def __post_init__(self) -> None:
        directions = {part: _frozen(values) for part, values in self.directions.items()}
        object.__setattr__(self, "time", _frozen(self.time))
        object.__setattr__(self, "points", _frozen(self.points))
        object.__setattr__(self, "directions", MappingProxyType(directions))
        object.__setattr__(self, "torso", None if self.torso is None else _frozen(self.torso))
        object.__setattr__(self, "begins", MappingProxyType(dict(self.begins)))


def unit(vectors: FloatArray) -> FloatArray:
    """The same directions with length 1 along the last axis; a zero vector has none and raises TeacherError."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    if not (length > 1e-12).all():
        raise TeacherError("a body part has no length, so it points nowhere; check the teacher's landmarks")
    return np.asarray(vectors / length)


def touching(parts: Sequence[str]) -> BoolArray:
    """(P, P) whether one of two parts begins where the other ends: who looks at them sees that."""
    inner = {f"{side}_{part}": f"{side}_{one}" for side in SIDES for part, one in BEGINS_AT.items()}
    hangs = np.array([[inner.get(part) == one for one in parts] for part in parts])
    return np.asarray(hangs | hangs.T)


def upright_frame(left: FloatArray, up: FloatArray) -> FloatArray:
    """Rotation whose columns are forward, left and up, from rough left and up vectors; up is made square to left."""
    left = unit(left)
    up = unit(up - (up @ left) * left)
    return np.column_stack([np.cross(left, up), left, up])


def _frozen(values: FloatArray) -> FloatArray:
    copy = np.array(values, dtype=float)
    copy.setflags(write=False)
    return copy
