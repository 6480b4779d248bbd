"""Robots one can ask for by name, and everything that an experiment may have to know of one beforehand."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Literal

import numpy as np

from models import biclops, hoap2
from models.biclops.facts import CAMERA_HEIGHT, MAX_ACCELERATION_DEG_S2, MAX_SPEED_DEG_S, PAN_HEIGHT
from models.errors import BodyError, unknown
from models.hoap2 import facts
from models.hoap2.limbs import SEGMENTS, Segment
from models.wear import Spring, Wear

EYE_HEIGHT = PAN_HEIGHT + CAMERA_HEIGHT
"""Metres of every robot's eyes above the table it is put before."""


@dataclass(frozen=True)
class Head:
    """A head that sees, and how to put it before something."""

    motors: tuple[str, str]
    """Actuators (and joints) of pan and tilt."""
    max_speed: tuple[float, float]
    """rad/s, of the run profile."""
    max_acceleration: tuple[float, float]
    """rad/s^2, of the run profile."""
    table: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Origin of the table's frame in the robot's world, m."""
    eyes: tuple[str, str] = ("left_eye", "right_eye")
    """Cameras."""
    rest: tuple[float, float] = (0.0, 0.0)
    """Pan and tilt to rest at, rad."""
    tilt: tuple[float, float] = (-0.40, 0.62)
    """How far it is tilted up and down in babbling, rad."""
    room: Path | None = None
    """The robot at its table; None puts table and walls around it."""


@dataclass(frozen=True)
class Stance:
    """How a robot stands on its own feet, on the floor of its MJCF."""

    sensors: tuple[str, ...]
    """<sensor> elements that it feels there, besides its joints: loads on its soles, a balance organ."""
    hips: str
    """Body that is upright while it stands, however it bows."""
    pushed: str
    """Body that is pushed."""
    feet: tuple[str, str] = ("left_foot", "right_foot")
    """Bodies that it stands on."""


@dataclass(frozen=True)
class Seat:
    """How a robot sits at a table and handles what stands on it."""

    parts: tuple[str, str, str] = ("left_palm", "right_palm", "forehead")
    """Sites that reach for things: two that can hold, and one that only pushes. A sensor NAME_touch feels each."""
    hands: tuple[str, str] = ("left_hand", "right_hand")
    """Bodies of the two that hold."""
    touching: tuple[str, ...] = ("left_hand_collision", "right_hand_collision", "head_collision")
    """Geoms that may touch what is on the table."""
    holding: tuple[str, str] = ("left_hand_collision", "right_hand_collision")
    """Of those, the two that hold."""
    outline: tuple[str, ...] = ("left_forearm", "right_forearm", "left_shoulder_bracket", "right_shoulder_bracket")
    """Bodies whose origins, elbows and shoulders, are seen too where one looks at what it is that moves."""
    table: float = facts.WAIST_HEIGHT
    """m, height of the table's top."""


@dataclass(frozen=True)
class Robot:
    """A body one can ask for by name."""

    path: Path
    """MJCF; a robot that stands free in it is hung by its root. It rests at the keyframe `home`, if there is one."""
    about: str
    hangs_at: float | None = None
    """Height of its root on a stand, m; None leaves the root where its file has it."""
    wear: Wear = Wear()  # noqa: RUF009  (frozen)
    springs: Mapping[str, Spring] = field(default_factory=dict)
    """Elastic stops, by joint."""
    carries: Mapping[str, float] = field(default_factory=dict)
    """kg held, by the body (with an <inertial>) at whose centre of mass they are: a steel ball."""
    sensors: tuple[str, ...] = ()
    """<sensor> elements of its MJCF that it feels, besides its joints."""
    head: Head | None = None
    """None for a robot without eyes."""
    limbs: Mapping[str, Segment] = field(default_factory=dict)
    """Parts of limbs whose directions can be shown to it: by a teacher, in a mirror."""
    stance: Stance | None = None
    """None for a robot without soles and balance organ."""
    size: float = 1.0
    """Share of its lengths that it has; masses stay."""
    seat: Seat | None = None
    """None for a robot that does not sit at a table."""
    babbles: Literal["joints", "eyes"] = "joints"
    """What its babbling is about: its joints, or what its movements do to what it sees."""


_HOAP2 = Robot(
    hoap2.SCENE,
    "HOAP-2 hung by its torso on a stand, 25 joints",
    hangs_at=facts.TORSO_HEIGHT,
    head=Head(  # eyes at waist + neck + tilt axis - 5 mm; speed as in its MJCF; acceleration: .2 s to top speed
        motors=("head_joint_1", "head_joint_2"),
        max_speed=(4.0, 4.0),
        max_acceleration=(20.0, 20.0),
        table=(0.0, 0.0, facts.TORSO_HEIGHT + 0.090 + 0.081 - 0.005 - EYE_HEIGHT),
        rest=(0.0, 0.16),
        tilt=(-0.24, 0.62),  # its neck bends only 15 degrees up
    ),
    limbs=SEGMENTS,
    stance=Stance((*facts.LOAD_CELLS, "gyro", "accelerometer"), hips="pelvis", pushed="torso"),
)
_BLIND = replace(_HOAP2, head=None)
_BACKLASH = (float(np.deg2rad(facts.WORN_BACKLASH_DEG)),)


def _spring(joint: str) -> Spring:
    """From mid range on, against bending: at the end of the range it takes its share of the servo's torque."""
    low, high = np.deg2rad(facts.RANGES_DEG[joint]).tolist()
    middle, limit = (low + high) / 2, facts.TORQUE_LIMIT[facts.joint_class(joint)]
    stiffness = facts.SPRING_SHARE * limit / (high - middle)
    return Spring(stiffness, high=middle) if high > -low else Spring(stiffness, low=middle)


_SPRINGS = {joint: _spring(joint) for joint in facts.SPRUNG}
ROBOTS: Mapping[str, Robot] = MappingProxyType(
    {
        "hoap2": _HOAP2,
        "hoap2-worn": replace(
            _BLIND,
            about=f"the same with worn gears: stiction x {facts.WORN_FRICTION_FACTOR:g}, "
            f"backlash {facts.WORN_BACKLASH_DEG:g} deg",
            wear=Wear(facts.WORN_FRICTION_FACTOR, _BACKLASH),
        ),
        "hoap2-backlash": replace(
            _BLIND,
            about=f"the same with fresh friction and a worn gear's backlash, {facts.WORN_BACKLASH_DEG:g} deg",
            wear=Wear(backlash=_BACKLASH),
        ),
        "hoap2-spring": replace(
            _BLIND, about="the same whose elbows and knees bend against a spring from mid range on", springs=_SPRINGS
        ),
        "hoap2-payload": replace(
            _BLIND,
            about=f"the same with {1000 * facts.PAYLOAD:g} g in its right hand",
            carries={"right_hand": facts.PAYLOAD},
        ),
        "hoap2-hysteresis": replace(
            _BLIND,
            about="the same whose joints lag as pneumatic ones do: a sum of plays of several widths",
            wear=Wear(1.0, tuple(np.deg2rad(facts.HYSTERESIS_DEG).tolist()), facts.HYSTERESIS_SHARES),
        ),
        "hoap2-seated": Robot(
            hoap2.SEAT,
            "the same on a seat, its pelvis fixed: what plays with objects on a table",
            seat=Seat(),
        ),
        "hoap2-seated-small": Robot(
            hoap2.SEAT,
            f"a smaller one on its seat, {facts.SMALL:g} of the length, as heavy: a peer",
            seat=Seat(),
            size=facts.SMALL,
        ),
        "biclops": Robot(
            biclops.ROBOT,
            "a Biclops-like pan-tilt head with two cameras",
            head=Head(
                motors=("pan", "tilt"),
                max_speed=(np.deg2rad(MAX_SPEED_DEG_S[0]), np.deg2rad(MAX_SPEED_DEG_S[1])),
                max_acceleration=(np.deg2rad(MAX_ACCELERATION_DEG_S2[0]), np.deg2rad(MAX_ACCELERATION_DEG_S2[1])),
                room=biclops.SCENE,
            ),
            babbles="eyes",
        ),
    }
)
"""Every robot."""


def find(name_or_path: str) -> Robot | None:
    """The registered robot of this name; None for what looks like a path.

    Raises:
        BodyError: neither.
    """
    path = Path(name_or_path)
    known = name_or_path in ROBOTS
    if not known and not (path.suffix.lower() in (".xml", ".mjcf") or len(path.parts) > 1 or os.path.exists(path)):
        raise BodyError(unknown("robot", name_or_path, ROBOTS) + ", or the path of an MJCF file")
    return ROBOTS.get(name_or_path)


def head_of(robot: str) -> Head:
    """The head of this robot.

    Raises:
        BodyError: no such robot, or one that cannot see; those that can are listed.
    """
    heads = {name: one.head for name, one in ROBOTS.items() if one.head is not None}
    if robot not in heads:
        raise BodyError(unknown("robot with eyes", robot, heads))
    return heads[robot]


def limbs_of(name: str, joints: Iterable[str]) -> Mapping[str, Segment]:
    """The limbs whose directions can be shown to a body with these joints, registered or out of a file.

    Raises:
        BodyError: it has no such limbs; robots that have are listed.
    """
    have = set(joints)
    for limbs in (one.limbs for one in ROBOTS.values() if one.limbs):
        if have >= {segment.joint for segment in limbs.values()}:
            return limbs
    fit = ", ".join(robot for robot, one in ROBOTS.items() if one.limbs)
    raise BodyError(f"{name}: limb directions can be shown to {fit} only")
