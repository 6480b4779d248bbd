"""A robot on its seat, a table before it, and an object on the table."""

from typing import Final

import mujoco

from models.errors import BodyError
from models.files import checked
from models.loading import equipped
from models.objects import Toy
from models.robots import Robot, Seat

TABLE: Final = (0.13, 0.26, 0.006)
"""m, half extents."""
TABLE_X: Final = 0.21
HAND, THING, EVERYTHING = 1, 2, 3
"""Collision bits: hands and head meet things, things meet each other and the table."""
GRIP_N: Final = 6.0
"""N that a palm holds with at full effort (grade D: it stands for fingers)."""
GRASP_M: Final = 0.004
"""m from a palm within which it still holds: fingers bend round what tilts (grade D)."""
PARTS: Final = 3
"""Two hands and a forehead."""
TOUCHED: Final = ("a", "b")
"""Sites that every object has."""
MARKED: Final = ((1.0, 0.05, 0.9), (0.08, 0.25, 1.0), (0.0, 0.9, 0.1))
"""Red, green, blue of what the parts are seen by: fingers of the left and the right hand, a patch on the forehead."""
OFF, LIT = (1.0, 0.45, 0.0), (1.0, 0.85, 0.0)
"""Of a light that is off, as any `a`, and on."""
PATCH_M: Final = 0.011
"""m, radius of the patch."""


def seated(robot: Robot, seat: Seat, toy: Toy | None, table: float | None = None) -> mujoco.MjSpec:
    """The scene; `table` is the height of the table's top, m, where it is not the usual one.

    Raises:
        BodyError: an object without the sites it is known by, or that MuJoCo cannot read.
    """
    spec = equipped(mujoco.MjSpec.from_file(str(robot.path)), robot)
    for geom in spec.geoms:
        touches = geom.name in seat.touching
        geom.contype, geom.conaffinity = (HAND, THING) if touches else (0, 0)
        if geom.name in seat.holding:
            geom.gap = GRASP_M
    mark(spec, seat)
    for exclude in list(spec.excludes):
        spec.delete(exclude)
    top = seat.table * robot.size if table is None else table
    spec.worldbody.add_geom(
        name="table", type=mujoco.mjtGeom.mjGEOM_BOX, size=TABLE, pos=(TABLE_X, 0, top - TABLE[2]), contype=THING,
        conaffinity=EVERYTHING, rgba=(0.62, 0.6, 0.57, 1), friction=(0.8, 0.01, 0.001), condim=4,
    )  # fmt: skip
    for hand in seat.hands:
        grip = spec.add_actuator(name=f"{hand}_grip", target=hand, trntype=mujoco.mjtTrn.mjTRN_BODY)
        grip.set_to_adhesion(GRIP_N)
        grip.ctrlrange, grip.ctrllimited = (0, 1), 1
    for key in spec.keys:
        key.ctrl = [*key.ctrl, *(0.0 for _ in seat.hands)]
    for part, hand in zip(seat.parts, seat.hands, strict=False):
        _bindable(spec, part, hand)
    if toy is not None:
        spec.attach(read(toy), prefix=PREFIX, frame=spec.worldbody.add_frame(pos=(0, 0, top)))
    return spec


def mark(spec: mujoco.MjSpec, seat: Seat) -> None:
    """Give a robot the colours its parts are seen by, and make everything else of it grey."""
    for geom in spec.geoms:
        geom.rgba[:3] = geom.rgba[:3].mean()
    for colour, hand in zip(MARKED, seat.hands, strict=False):
        for geom in spec.body(hand).geoms:
            if geom.name.endswith("finger_visual"):
                geom.rgba[:3] = colour
    forehead = spec.site(seat.parts[-1])
    forehead.parent.add_geom(
        name="forehead_patch", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(PATCH_M, 0, 0), pos=forehead.pos, group=2,
        mass=0, rgba=(*MARKED[-1], 1), contype=0, conaffinity=0,
    )  # fmt: skip


PREFIX: Final = "toy_"
"""Stands before every name of an object's, in the scene."""


def read(toy: Toy) -> mujoco.MjSpec:
    """An object by itself.

    Raises:
        BodyError: see `seated`.
    """
    checked(toy.path)
    try:
        spec = mujoco.MjSpec.from_file(str(toy.path))
        spec.copy().compile()
    except (ValueError, mujoco.FatalError) as error:
        raise BodyError(f"{toy.path}: MuJoCo cannot compile it ({' '.join(str(error).split())})") from error
    have = {site.name for site in spec.sites}
    missing = [site for site in TOUCHED if site not in have]
    if missing:
        raise BodyError(
            f"{toy.path}: it has no site {missing[0]!r}; an object is known by two parts, "
            '<site name="a"/> and <site name="b"/>'
        )
    return spec


def _bindable(spec: mujoco.MjSpec, palm: str, hand: str) -> None:
    """A blanket that may be held round oneself: the palm bound to the chest while it is."""
    side = 1.0 if hand.startswith("left") else -1.0
    hold = spec.body("torso").add_site(name=f"{palm}_hold", pos=(0.0, side * 0.15, -0.03), group=4)
    spec.add_equality(
        name=f"{palm}_bound", type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_SITE, name1=palm,
        name2=hold.name, active=False, solref=(0.02, 1),
    )  # fmt: skip
