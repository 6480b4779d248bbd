"""A face as a body that babbles: eight motors, what its joints feel, what its lips and its tongue touch."""

from copy import deepcopy
from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.body import SimulatedBody
from models.errors import BodyError
from models.face import ACT_S, JOINTS, SITES, SLIDES, TOUCH, Face, Proportions, face_of
from models.files import checked
from models.trial import moved, quiet, spec_of

NOISE = np.array(
    [np.deg2rad(0.2), 1e-4, np.deg2rad(0.2), np.deg2rad(0.2), 1e-4, 1e-4, np.deg2rad(0.2), np.deg2rad(0.2)]
)
"""Standard deviation of what each joint feels: 0.2 degrees, 0.1 mm."""
HELD = float(np.deg2rad(9))
"""How far a mouth opens that holds a pacifier."""
_BLUE, _AMBER = (0.2, 0.4, 0.9, 1.0), (0.85, 0.8, 0.5, 1.0)


def face_spec(face: Face, *, pacifier: bool = False) -> mujoco.MjSpec:
    """The MJCF of a face, shaped to its proportions, perhaps with a pacifier in its mouth.

    Raises:
        BodyError: a file that MuJoCo cannot read, or a face that lacks a part.
    """
    checked(face.path)
    try:
        spec = spec_of(face.path, "models.face.body:rehearse")
    except BodyError:
        raise
    except (ValueError, mujoco.FatalError) as error:
        raise BodyError(f"{face.path}: MuJoCo cannot read it ({' '.join(str(error).split())})") from error
    for what, have, needed in (
        ("joint", {joint.name for joint in spec.joints}, JOINTS),
        ("site", {site.name for site in spec.sites}, SITES),
        ("touch sensor", {sensor.name for sensor in spec.sensors}, TOUCH),
    ):
        missing = [name for name in needed if name not in have]
        if missing:
            raise BodyError(f"{face.path}: this face has no {what} {missing[0]!r}; a face has {', '.join(needed)}")
    if pacifier:
        _stop(spec)
    _shape(spec, face.proportions)
    return spec


@lru_cache(maxsize=16)
def face_model(face: Face, *, pacifier: bool = False) -> mujoco.MjModel:
    """Compiled; see `face_spec`."""
    spec = face_spec(face, pacifier=pacifier)
    try:
        with quiet(face.path):
            return spec.compile()
    except ValueError as error:
        raise BodyError(f"{face.path}: MuJoCo cannot compile it ({' '.join(str(error).split())})") from error


def face_body(
    face: Face,
    *,
    copies: int = 1,
    tick_s: float = ACT_S,
    pacifier: bool = False,
    scramble: int | None = None,
    threads: int = 2,
    noise: FloatArray = NOISE,
    seed: int = 0,
) -> SimulatedBody:
    """One tick is one act: a command is held until the face has settled.

    Only motors can be wired anyhow: which sense belongs to which relation is innate, for in the dark nothing else could
    tell it. `pacifier`: something stops the mouth, and no more is different: it is the same body.

    Raises:
        BodyError: see `face_spec`.
    """
    body = SimulatedBody(
        deepcopy(face_model(face, pacifier=pacifier)),  # bodies make their model their own
        name=face.about,
        copies=copies,
        threads=threads,
        tick_s=tick_s,
        noise=noise * np.where(np.isin(JOINTS, SLIDES), face.proportions.size, 1.0),
        wear=face.wear,
        motors=JOINTS,
        sensors=TOUCH,
        scramble=scramble,
        scramble_senses=False,
        seed=seed,
    )
    if pacifier:
        body.fingerprint = face_body(face, tick_s=tick_s, scramble=scramble).fingerprint
    return body


def rehearse(path: Path) -> None:
    """Load and move a stranger's face.

    Raises:
        BodyError: see `face_body` and `models.trial.moved`.
    """
    moved(face_body(face_of(str(path)), threads=1))


def _stop(spec: mujoco.MjSpec) -> None:
    """A teat between the lips and a shield before them, held to the head (a teat alone would not stop the tongue), and
    a mouth that keeps hold of it."""
    jaw, servo, unit = spec.joint("jaw"), spec.actuator("jaw"), 180 / np.pi if spec.compiler.degree else 1.0
    servo.ctrlrange, servo.inheritrange = jaw.range / unit, 0.0
    jaw.range = (jaw.range[0], HELD * unit)
    head, capsule = spec.body("head"), mujoco.mjtGeom.mjGEOM_CAPSULE
    touch = {"contype": 7, "conaffinity": 7, "mass": 0.0, "friction": (0.02, 0.005, 0.0001), "solref": (0.006, 1.0)}
    box, ball, look = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_SPHERE, {"contype": 0, "conaffinity": 0}
    teat = (0.052, 0, -0.031, 0.042, 0, -0.033)
    head.add_geom(name="teat", type=capsule, size=(0.004, 0, 0), fromto=teat, rgba=_AMBER, **touch)
    head.add_geom(name="shield", type=box, size=(0.0015, 0.02, 0.02), pos=(0.0595, 0, -0.036), rgba=_BLUE, **touch)
    head.add_geom(name="ring", type=ball, size=(0.008, 0, 0), pos=(0.066, 0, -0.036), rgba=_BLUE, mass=0.0, **look)


def _shape(spec: mujoco.MjSpec, has: Proportions) -> None:
    """Lengths, masses and servos after `Proportions`."""
    s = has.size
    along = s * np.array([has.deep, has.wide, has.tall])
    for body in spec.bodies[1:]:
        body.pos = body.pos * along
        if body.explicitinertial:
            body.ipos, body.mass, body.inertia = body.ipos * along, body.mass * s**3, body.inertia * s**5
    for thing in (*spec.geoms, *spec.sites):
        factor = along.copy()
        if thing.name.startswith(("eye_", "iris_", "brow_")):
            factor[1] *= has.eyes
        if "lip" in thing.name or thing.name.startswith(("corner", "blade", "tongue")):
            factor[1] *= has.mouth
        if thing.name == "nose":
            factor[0] *= 1 + (has.nose - 1) * thing.size[0] / thing.pos[0]  # its root stays where it is
        thing.pos = thing.pos * factor
        if not np.isnan(thing.fromto[0]):
            thing.fromto = thing.fromto * np.tile(factor, 2)
        round_ = thing.type in (mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_CAPSULE)
        if thing.name == "nose":
            factor = along * (has.nose, 1, 1)
        thing.size = thing.size * (s * (has.tall if "lip" in thing.name else 1.0) if round_ else factor)
    for geom in spec.geoms:
        geom.mass *= s**3
    for joint in spec.joints:
        slides = joint.type == mujoco.mjtJoint.mjJNT_SLIDE
        joint.pos = joint.pos * along
        joint.armature *= s**3 if slides else s**5
        joint.damping = joint.damping * (s**3 if slides else s**5)
        if slides:
            joint.range = joint.range * s
    for servo in spec.actuators:
        slides = spec.joint(servo.target).type == mujoco.mjtJoint.mjJNT_SLIDE
        power = s**3 if slides else s**5
        servo.gainprm[0] *= power
        servo.biasprm[1] *= power
        if servo.biasprm[2] < 0:  # a damping, not a damping ratio
            servo.biasprm[2] *= power
        if slides:
            servo.ctrlrange = servo.ctrlrange * s
