"""HOAP-2 in numbers: what hoap2.xml declares, said a second time so that tests can compare the compiled body with it.

Sources and honesty grades: README.md beside this file. Degrees where people read them (`_deg`, `_DEG`), else SI.
"""

from types import MappingProxyType
from typing import Final

SIDES: Final = ("left", "right")

JOINTS: Final[tuple[str, ...]] = (
    "body_joint_1",
    *(f"{side}_leg_joint_{i}" for side in SIDES for i in range(1, 7)),
    "head_joint_1",
    "head_joint_2",
    *(f"{side}_arm_joint_{i}" for side in SIDES for i in range(1, 6)),
)
"""The 25 joints in the order of qpos, of the actuators and of the position and velocity sensors."""

LOAD_CELLS: Final = tuple(
    f"{side}_sole_{end}_{edge}_load" for side in SIDES for end in ("front", "rear") for edge in ("left", "right")
)
"""Four under each sole."""

_LEFT_LEG = ((-31, 91), (-21, 31), (-82, 71), (-1, 130), (-61, 61), (-25, 25))
_LEFT_ARM = ((-91, 151), (-1, 96), (-91, 91), (-115, 1), (-60, 60))
_MIRRORED = frozenset({"leg_joint_1", "leg_joint_2", "leg_joint_6", "arm_joint_2", "arm_joint_3", "arm_joint_5"})


def mirror(name: str) -> tuple[str, int]:
    """The joint of the other side, and the sign its angle takes in a mirrored posture (yaw and roll turn over)."""
    for side, other in (SIDES, SIDES[::-1]):
        if name.startswith(side + "_"):
            limb = name.removeprefix(side + "_")
            return f"{other}_{limb}", -1 if limb in _MIRRORED else 1
    return name, -1 if name == "head_joint_1" else 1


def _ranges() -> dict[str, tuple[float, float]]:
    left = {f"left_leg_joint_{i}": pair for i, pair in enumerate(_LEFT_LEG, 1)}
    left |= {f"left_arm_joint_{i}": pair for i, pair in enumerate(_LEFT_ARM, 1)}
    ranges = {"body_joint_1": (-1, 90), "head_joint_1": (-60, 60), "head_joint_2": (-15, 60), **left}
    for name, (low, high) in left.items():
        other, sign = mirror(name)
        ranges[other] = (low, high) if sign > 0 else (-high, -low)
    return {name: (float(ranges[name][0]), float(ranges[name][1])) for name in JOINTS}


RANGES_DEG: Final = MappingProxyType(_ranges())
"""Mechanical range of each joint, degrees."""


def joint_class(name: str) -> str:
    """waist, leg, arm, head or hand: joints of a class share servo type, torque limit, armature and friction."""
    if name.startswith("body"):
        return "waist"
    if name.startswith("head"):
        return "head"
    if "_leg_" in name:
        return "leg"
    return "hand" if name.endswith("_5") else "arm"


TORQUE_LIMIT: Final = MappingProxyType({"waist": 8.0, "leg": 9.0, "arm": 3.0, "head": 1.0, "hand": 1.0})
"""N·m at the joint."""
SPEED_LIMIT: Final = MappingProxyType({"waist": 5.0, "leg": 5.0, "arm": 5.0, "head": 4.0, "hand": 5.0})
"""rad/s; MuJoCo does not enforce it: whoever writes commands keeps to it."""
ARMATURE: Final = MappingProxyType({"waist": 0.01, "leg": 0.01, "arm": 0.005, "head": 0.003, "hand": 0.003})
"""kg·m², rotor inertia behind the gear."""
DAMPING: Final = MappingProxyType({"waist": 0.1, "leg": 0.1, "arm": 0.05, "head": 0.02, "hand": 0.02})
"""N·m·s/rad."""
FRICTION_SHARE: Final = 0.005
"""Dry friction of a fresh joint as a share of its torque limit."""

WORN_FRICTION_FACTOR: Final = 30.0
"""A worn joint sticks this many times harder than a fresh one."""
WORN_BACKLASH_DEG: Final = 0.5
"""Total play between servo and limb of a worn joint, degrees."""
SPRING_SHARE: Final = 0.75
"""Of a servo's torque limit that an elastic stop, touched from the middle of the range on, takes at the range's end."""
SPRUNG: Final = tuple(f"{side}_{joint}" for side in SIDES for joint in ("arm_joint_4", "leg_joint_4"))
"""Joints with such a stop, against bending: elbows and knees."""
PAYLOAD: Final = 0.2
"""kg carried in the right hand."""
HYSTERESIS_DEG: Final = (0.0, 4.0, 12.0, 24.0)
"""Widths of the plays of a pneumatic joint, degrees."""
HYSTERESIS_SHARES: Final = (0.4, 0.3, 0.2, 0.1)
"""Their shares: a wide loop is 6 degrees wide."""

ENCODER_PULSES_PER_DEGREE: Final = 209.0
CONTROL_RANGE_FACTOR: Final = 1.2
"""A servo's command may leave its joint's range by 10 % of its width on each side (see README)."""

TOTAL_MASS: Final = 7.160
"""kg, sum of the bodies below."""
_LIMB_MASSES = {
    "hip_yaw": 0.03939,
    "hip_roll": 0.17270,
    "thigh": 0.43856,
    "shank": 0.28583,
    "ankle": 0.17113,
    "foot": 0.15675,
    "shoulder_bracket": 0.19903,
    "shoulder_block": 0.20144,
    "upper_arm": 0.21947,
    "forearm": 0.16757,
    "hand": 0.04720,
}
MASSES: Final = MappingProxyType(
    {"torso": 2.37622, "pelvis": 0.49768, "head_yaw": 0.02089, "head": 0.06699}
    | {f"{side}_{limb}": mass for side in SIDES for limb, mass in _LIMB_MASSES.items()}
)
"""kg by body; limbs are the mean of the published left and right."""

HEIGHT_STRAIGHT: Final = 0.491
"""m, soles to crown, legs straight."""
HEIGHT_CROUCHED: Final = 0.479
"""m, soles to crown in the posture `home`."""
SOLE_BELOW_ANKLE: Final = 0.0355
"""m, ankle axes above the floor a flat foot stands on."""

TORSO_HEIGHT: Final = 0.45
"""m, waist axis above the floor where it hangs on its stand and babbles, out of reach of everything."""

HOME_DEG: Final = MappingProxyType(
    {
        joint: angle
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True)
        for joint, angle in {
            f"{side}_leg_joint_3": -20.0,
            f"{side}_leg_joint_4": 40.0,
            f"{side}_leg_joint_5": -22.0,
            f"{side}_arm_joint_1": 90.0,
            f"{side}_arm_joint_2": sign * 10.0,
            f"{side}_arm_joint_3": sign * -10.0,
            f"{side}_arm_joint_4": -25.0,
        }.items()
    }
)
"""Walk-ready crouch, degrees; joints not named are at zero. First line of the real robot's walk."""

WAIST_HEIGHT: Final = 0.2
"""m, waist axis above the floor on its seat; the top of a table before it is level with it."""

SEATED_DEG: Final = MappingProxyType(
    {"head_joint_2": 15.0}
    | {
        joint: angle
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True)
        for joint, angle in {
            f"{side}_leg_joint_3": -80.0,
            f"{side}_leg_joint_4": 80.0,
            f"{side}_arm_joint_1": 45.0,
            f"{side}_arm_joint_2": sign * 25.0,
            f"{side}_arm_joint_4": -75.0,
        }.items()
    }
)
"""Upright on a seat, thighs level, hands before the chest, eyes on the table, degrees; joints not named are at zero."""

SMALL: Final = 0.85
"""Share of its lengths that a smaller peer has."""

PULSE_SIGNS: Final = MappingProxyType(
    {f"right_leg_joint_{i}": sign for i, sign in enumerate((1, 1, -1, 1, 1, -1), 1)}
    | {f"right_arm_joint_{i}": sign for i, sign in enumerate((1, 1, -1, -1), 1)}
    | {f"left_leg_joint_{i}": sign for i, sign in enumerate((1, 1, 1, -1, -1, -1), 1)}
    | {f"left_arm_joint_{i}": sign for i, sign in enumerate((-1, 1, -1, 1), 1)}
    | {"body_joint_1": 1}
)
"""Sign of an encoder pulse against the joint angles used here, in the column order of the real robot's motion files
(right leg, right arm, left leg, left arm, waist); head and hand joints have no column there."""
