"""Which joint of HOAP-2 carries which body part, and where the part points: the robot's side of limb directions."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final, NamedTuple

from models.hoap2.facts import SIDES


class Segment(NamedTuple):
    """A body part's direction: the unit vector `axis` in the frame of the body that `joint` moves."""

    joint: str
    axis: tuple[float, float, float]


_OF_A_SIDE: Final = {
    "upper_arm": Segment("arm_joint_3", (1, 0, 0)),
    "forearm": Segment("arm_joint_4", (1, 0, 0)),
    "thigh": Segment("leg_joint_3", (0, 0, -1)),
    "shank": Segment("leg_joint_4", (0, 0, -1)),
    "foot": Segment("leg_joint_6", (1, 0, 0)),
}
SEGMENTS: Final[Mapping[str, Segment]] = MappingProxyType(
    {f"{side}_{part}": Segment(f"{side}_{joint}", axis) for side in SIDES for part, (joint, axis) in _OF_A_SIDE.items()}
    | {"head": Segment("head_joint_2", (1, 0, 0)), "trunk": Segment("body_joint_1", (0, 0, 1))}
)
"""Part -> its segment, in the order of `models.teachers.PARTS`."""
