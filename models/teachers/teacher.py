"""A robot as a teacher: where its landmarks are, which joints carry its parts, and how it moves.

Limbs are found by joint names and by where the joints sit, the same way for every robot: hip, knee, ankle, shoulder,
elbow, wrist, with left and right in one of the usual spellings; two arms whose joints have other names, by their build
(`models.teachers.arms`). A limb needs the joints at both of its ends (`models.teachers.anatomy.ENDS`). Meshes are not
read: kinematics is enough.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from models.arrays import FloatArray
from models.errors import unknown
from models.motion.trajectory import JointTrajectory
from models.teachers.anatomy import CARRIED, ENDS, BodyPoses, upright
from models.teachers.arms import built_arms
from models.teachers.names import plain, side_of
from models.teachers.performance import SIDES, TeacherError

WORDS: Mapping[str, tuple[str, ...]] = {
    "shoulder": ("shoulder", "uarm", "upperarm", "upper_arm", "humerus"),
    "elbow": ("elbow", "forearm", "lower_arm", "lowerarm"),
    "wrist": ("wrist", "hand"),
    "hip": ("hip", "thigh", "upper_leg", "upperleg", "femur"),
    "knee": ("knee", "shank", "lower_leg", "lowerleg", "calf", "tibia"),
    "ankle": ("ankle", "foot"),
}
"""Landmark -> what joints at it are called, in order of trust."""
ROOTS = ("shoulder", "hip")
OUTERMOST = (*ROOTS, "wrist")
"""Of several joints there (pitch, roll, yaw) the last is taken; of the others the first."""
BALL = 0.35
"""Joints within this share of the next limb's length are one ball."""
NUMBERED = {"arm": ("shoulder", "elbow", "wrist"), "leg": ("hip", "knee", "ankle")}
"""Limbs whose joints are only counted (arm_left_1, ...): three joints make a ball, the third carries on, then these."""
CARRIED_BY = {"head": ("head", "neck", "cervical"), "left_foot": ("ankle", "foot"), "right_foot": ("ankle", "foot")}
"""Body -> what the last joint before it is called."""


@dataclass(frozen=True, eq=False)
class Teacher:
    """A robot that can be watched.

    landmarks: "left_knee" -> number of its joint. carriers: "torso", "head", ... -> number of the joint that carries it
    (0: the root body).
    """

    name: str
    model: pin.Model
    landmarks: Mapping[str, int]
    carriers: Mapping[str, int]

    @classmethod
    def found(cls, name: str, model: pin.Model, told: Mapping[str, str] | None = None) -> "Teacher":
        """Landmarks and carriers found by names and places; `told` puts joints in their stead, landmark by landmark."""
        landmarks = _landmarks(model)
        carriers = _carriers(model, landmarks)
        for part, joint in (told or {}).items():
            number = model.getJointId(joint)
            if number >= model.njoints:
                raise TeacherError(f"teacher {name}: its file has no joint {joint!r} for {part}")
            (landmarks if part in landmarks else carriers)[part] = number
        return cls(name, model, landmarks, carriers)

    @property
    def missing(self) -> dict[str, str]:
        """Part that cannot be seen -> what it lacks."""
        lacks = {}
        for side in SIDES:
            for part, ends in ENDS.items():
                if absent := [end for end in ends if f"{side}_{end}" not in self.landmarks]:
                    lacks[f"{side}_{part}"] = " and ".join(absent)
        return lacks | {part: body for part, (body, _) in CARRIED.items() if body not in self.carriers}

    @property
    def limits(self) -> dict[str, tuple[float, float]]:
        """Joint -> lowest and highest angle that its file allows, radians."""
        low, high = self.model.lowerPositionLimit, self.model.upperPositionLimit
        places = zip(list(self.model.names)[1:], list(self.model.idx_qs)[1:], strict=True)
        return {joint: (float(low[place]), float(high[place])) for joint, place in places}

    @property
    def slides(self) -> tuple[str, ...]:
        """Joints whose numbers are metres."""
        kinds = zip(list(self.model.names)[1:], list(self.model.joints)[1:], strict=True)
        return tuple(joint for joint, kind in kinds if kind.shortname().startswith("JointModelP"))

    def postures(self, trajectory: JointTrajectory) -> FloatArray:
        """(T, nq) configurations when it moves like this; joints that are not named stay at zero.

        Raises:
            TeacherError: a joint that it does not have.
        """
        model, names = self.model, list(self.model.names)[1:]
        found = np.tile(pin.neutral(model), (len(trajectory.time), 1))
        for joint, values in zip(trajectory.joints, trajectory.angles.T, strict=True):
            if joint not in names:
                raise TeacherError(f"{trajectory.name}: {unknown(f'joint of {self.name}', joint, names)}")
            number = model.getJointId(joint)
            place = model.idx_qs[number]
            if model.nqs[number] == 2:  # a continuous joint is kept as cosine and sine
                found[:, place], found[:, place + 1] = np.cos(values), np.sin(values)
            else:
                found[:, place] = values
        return found

    def motion(self, configurations: FloatArray, standing_on: str = "left") -> BodyPoses:
        """Poses of its body parts through time, (T, nq) configurations, with one foot resting where it stands.

        The world's x is where the upright robot faces, z is up; its ankles stand at the origin. `standing_on` names
        the foot that stays put; of a robot without feet the root body does.
        """
        model, data = self.model, self.model.createData()
        ids = {**self.carriers, **self.landmarks}
        anchor = self.carriers.get(f"{standing_on}_foot", 0)
        pin.forwardKinematics(model, data, pin.neutral(model))
        at = {part: data.oMi[number].translation.copy() for part, number in ids.items()}
        ankles = [at[f"{side}_ankle"] for side in SIDES if f"{side}_ankle" in at] or [np.zeros(3)]
        facing = upright(at).T
        stand = pin.SE3(facing, -facing @ np.mean(ankles, axis=0)) * data.oMi[anchor]
        positions = {part: np.empty((len(configurations), 3)) for part in ids}
        rotations = {part: np.empty((len(configurations), 3, 3)) for part in self.carriers}
        for frame, configuration in enumerate(configurations):
            pin.forwardKinematics(model, data, configuration)
            root = stand * data.oMi[anchor].inverse()
            for part, number in ids.items():
                pose = root * data.oMi[number]
                positions[part][frame] = pose.translation
                if part in rotations:
                    rotations[part][frame] = pose.rotation
        return BodyPoses(rotations, positions)

    @property
    def reference(self) -> BodyPoses:
        """Standing upright: all joints at zero."""
        return self.motion(pin.neutral(self.model)[None])


def _landmarks(model: pin.Model) -> dict[str, int]:
    """See the module; of a ball's joints the last that still sits near the first, measured by the limb beyond."""
    found: dict[str, int] = {}
    names, supports = list(model.names), model.supports
    of_legs = [word for landmark in NUMBERED["leg"] for word in WORDS[landmark]]
    built = built_arms(model, [joint for joint, name in enumerate(names) if any(w in plain(name) for w in of_legs)])
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))

    def apart(one: int, other: int) -> float:
        return float(np.linalg.norm(data.oMi[one].translation - data.oMi[other].translation))

    for side in SIDES:
        ours = [number for number in range(1, model.njoints) if side_of(names[number]) == side]
        ours.sort(key=lambda number: len(supports[number]))
        balls: dict[str, list[int]] = {}
        for landmark, words in WORDS.items():
            near = next((n for word in words if (n := [j for j in ours if word in plain(names[j])])), [])
            if near:
                balls[landmark] = near
                found[f"{side}_{landmark}"] = near[-1 if landmark in OUTERMOST else 0]
        if f"{side}_elbow" not in found:
            found |= {mark: joint for mark, joint in built.items() if mark.startswith(side)}
        for word, counted in NUMBERED.items():
            chain = [number for number in ours if word in plain(names[number]).split("_")]
            if len(chain) >= 5 and not any(f"{side}_{landmark}" in found for landmark in counted):
                found |= {f"{side}_{landmark}": joint for landmark, joint in zip(counted, chain[2:5], strict=True)}
        for start, end in ENDS.values():
            first, second = found.get(f"{side}_{start}"), found.get(f"{side}_{end}")
            if first is None or second is None:
                continue
            if start in ROOTS and start in balls:
                ball = [joint for joint in balls[start] if joint in list(supports[second])]
                near = [joint for joint in ball if apart(joint, ball[0]) <= BALL * apart(second, ball[0])]
                first = found[f"{side}_{start}"] = near[-1] if near else first
            if first not in list(supports[second]):  # on another branch: not of this limb
                del found[f"{side}_{end}"]
    return found


def _carriers(model: pin.Model, landmarks: Mapping[str, int]) -> dict[str, int]:
    """Joints that carry the torso, and the pelvis, the head and the feet where there are any."""
    depth = [len(support) for support in model.supports]
    common: dict[str, int] = {}
    for root in ROOTS:
        roots = [landmarks[f"{side}_{root}"] for side in SIDES if f"{side}_{root}" in landmarks]
        if len(roots) == 2:
            shared = set(model.supports[roots[0]]) & set(model.supports[roots[1]])
            common[root] = int(max(shared, key=lambda joint: depth[joint]))
    carriers = {"torso": common.get("shoulder", common.get("hip", 0))}
    if "shoulder" in common and "hip" in common:
        carriers["pelvis"] = common["hip"]
    for body, words in CARRIED_BY.items():
        side = next((side for side in SIDES if body.startswith(side)), None)
        near = [
            number
            for number in range(1, model.njoints)
            if any(word in plain(model.names[number]) for word in words)
            and (side is None or (side_of(model.names[number]) == side and f"{side}_ankle" in landmarks))
        ]
        if side is not None and not near and f"{side}_ankle" in landmarks:
            ankle = landmarks[f"{side}_ankle"]
            near = [number for number in range(1, model.njoints) if ankle in list(model.supports[number])]
        if near:
            carriers[body] = max(near, key=lambda number: depth[number])
    return carriers
