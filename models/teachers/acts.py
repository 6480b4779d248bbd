"""Single acts: a robot holds a posture, moves the joints of one body part alone, and holds still again."""

from functools import cache

import numpy as np

from models.errors import unknown
from models.motion.trajectory import JointTrajectory
from models.teachers import robots
from models.teachers.anatomy import perform
from models.teachers.performance import PARTS, Performance, TeacherError

RATE_HZ = 50.0
HOLD_S, ACT_S = 0.2, 0.6
LEAST = np.deg2rad(15.0)
"""A part turns at least this far in its act; what turns less is hardly an act."""
WIDEST = 1.2
"""Joints stay within this of zero, rad, and inside their range."""
ATTEMPTS = 60


def joints_of(robot: str, part: str) -> tuple[str, ...]:
    """Joints between the part and the next one inwards: those that turn it, and do not turn that.

    Raises:
        TeacherError: an unknown part, or a robot that cannot move it by itself.
    """
    if part not in PARTS:
        raise TeacherError(unknown("body part", part, PARTS))
    teacher = robots.load(robot)
    model, places = teacher.model, {**teacher.carriers, **teacher.landmarks}
    side, _, name = part.partition("_")

    def above(landmark: str, *, itself: bool = True) -> set[int]:
        number = places[landmark if landmark in places else f"{side}_{landmark}"]
        ids = set(model.supports[number]) - {0}
        return ids if itself else ids - {number}

    torso, pelvis = above("torso"), above("pelvis")
    own = {
        "upper_arm": lambda: above("elbow", itself=False) - torso - pelvis,
        "forearm": lambda: above("wrist", itself=False) - above("elbow", itself=False),
        "thigh": lambda: above("knee", itself=False) - torso - pelvis,
        "shank": lambda: above("knee") - above("knee", itself=False),
        "foot": lambda: above("foot") - above("knee"),
    }.get(name, lambda: above("head") - torso - pelvis if part == "head" else torso ^ pelvis)()
    own = {joint for joint in own if model.joints[joint].nq == 1}
    if not own:
        raise TeacherError(f"teacher {robot}: no joint moves its {part} alone")
    return tuple(model.names[joint] for joint in sorted(own))


@cache
def movable(robot: str) -> tuple[str, ...]:
    """Parts that this robot can visibly move by themselves (a waist that only turns about the spine does not count)."""
    found = []
    for part in PARTS:
        try:
            single_act(robot, part, np.random.default_rng(0))
        except TeacherError:
            continue
        found.append(part)
    return tuple(found)


def single_act(
    robot: str, part: str, rng: np.random.Generator, share: float = 1.0, along: tuple[str, ...] = ()
) -> Performance:
    """What is seen of a random act of one part, out of a random posture of the whole robot; or of a `share` of that
    way only, and with the joints of other parts moving `along`, each part half as far in root mean square of joints.

    Raises:
        TeacherError: see `joints_of`; or no act of that part turns it by LEAST.
    """
    own = joints_of(robot, part)
    teacher = robots.load(robot)
    limits = teacher.limits
    names = tuple(limits)
    low, high = np.clip(np.array([limits[name] for name in names]), -WIDEST, WIDEST).T
    low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
    columns = [names.index(joint) for joint in own]
    hold, act = round(HOLD_S * RATE_HZ), round(ACT_S * RATE_HZ)
    time = np.clip((np.arange(2 * hold + act) - hold + 1) / act, 0, 1)
    way = (time**3 * (10 - 15 * time + 6 * time**2))[:, None]
    time = np.arange(len(way)) / RATE_HZ
    reference = teacher.reference
    for _ in range(ATTEMPTS):
        start = low + (high - low) * rng.random(len(names))
        start *= 0.5  # an everyday posture, not a contortion
        end = start.copy()
        end[columns] = (low + (high - low) * rng.random(len(names)))[columns]
        ends = JointTrajectory("act", np.arange(3.0), names, np.stack([start, start, end]))
        seen = perform("act", robot, ends.time, teacher.motion(teacher.postures(ends)), reference)
        if seen.directions[part][0] @ seen.directions[part][2] > np.cos(LEAST):
            continue
        way_rms = np.sqrt(np.mean((end - start)[columns] ** 2))
        for other in along:
            beside = [names.index(joint) for joint in joints_of(robot, other)]
            turn = (low + (high - low) * rng.random(len(names)) - start)[beside]
            end[beside] = start[beside] + turn * 0.5 * way_rms / np.sqrt(np.mean(turn**2))
        end = start + share * (end - start)
        trajectory = JointTrajectory(f"{robot} moves its {part}", time, names, start + way * (end - start))
        motion = teacher.motion(teacher.postures(trajectory))
        return perform(trajectory.name, robot, time, motion, reference)
    raise TeacherError(f"teacher {robot}: no act of its {part} was found that turns it by 15 degrees")
