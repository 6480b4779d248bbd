"""Which joints of HOAP-2 show which body part: the robot's side of imitating by limb directions."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final


@dataclass(frozen=True)
class Segment:
    """A body part's direction: the unit vector `axis` in the frame of the body that `joint` moves.

    weight: what a squared error of this part counts against the others of its limb. A part nearer the torso counts
    more than the next one out: what the shoulder does wrong, everything beyond it inherits. The foot counts least: the
    ankle cannot turn it sideways, and the hip may do so only while the knee is straight.
    """

    part: str
    joint: str
    axis: tuple[float, float, float]
    weight: float = 1.0


@dataclass(frozen=True)
class Limb:
    """A chain of joints, outwards, and the segments whose directions it decides.

    stiffness: joint -> what a squared radian away from rest counts against those weights, for joints that a nearly
    straight limb leaves almost free: they do not whirl round to mend a tenth of a degree.
    hangs_from: the joint, itself on the torso, that turns what the chain hangs from; None for the torso.
    """

    joints: tuple[str, ...]
    segments: tuple[Segment, ...]
    stiffness: Mapping[str, float] = field(default_factory=dict)
    hangs_from: str | None = None


def _arm(side: str) -> Limb:
    joint = f"{side}_arm_joint_"
    return Limb(
        tuple(f"{joint}{i}" for i in range(1, 5)),
        (
            Segment(f"{side}_upper_arm", f"{joint}3", (1, 0, 0)),
            Segment(f"{side}_forearm", f"{joint}4", (1, 0, 0), 1e-2),
        ),
        stiffness={f"{joint}3": 1e-7},
    )


def _leg(side: str) -> Limb:
    joint = f"{side}_leg_joint_"
    return Limb(
        tuple(f"{joint}{i}" for i in range(1, 7)),
        (
            Segment(f"{side}_thigh", f"{joint}3", (0, 0, -1)),
            Segment(f"{side}_shank", f"{joint}4", (0, 0, -1), 0.1),
            Segment(f"{side}_foot", f"{joint}6", (1, 0, 0), 5e-4),
        ),
        stiffness={f"{joint}1": 5e-6},
        hangs_from="body_joint_1",
    )


LIMBS: Final[Mapping[str, Limb]] = MappingProxyType(
    {
        "trunk": Limb(("body_joint_1",), (Segment("trunk", "body_joint_1", (0, 0, 1)),)),
        "head": Limb(("head_joint_1", "head_joint_2"), (Segment("head", "head_joint_2", (1, 0, 0)),)),
        "left_arm": _arm("left"),
        "right_arm": _arm("right"),
        "left_leg": _leg("left"),
        "right_leg": _leg("right"),
    }
)
"""Limbs in the order in which they are solved: the trunk first, for the legs hang from the pelvis it turns."""
