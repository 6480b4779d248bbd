"""Which joint of a skeleton is which: by the usual names, and where these say nothing by its build.

Build: two chains alike part from one joint (hips) and two from another (shoulders), beside which a middle one goes on
(neck and head). Of each chain the two longest bones that follow each other are thigh and shank, or upper arm and
forearm; bones that never bend are one. Left and right are told by words or letters in names, else by where toes, or
knees that bend, point.
"""

import re
from collections.abc import Mapping, Sequence
from itertools import combinations, pairwise, zip_longest

import numpy as np

from models.arrays import FloatArray
from models.teachers.names import side_of
from models.teachers.performance import SIDES, TeacherError, unit

CALLED = {
    "shoulder": ("arm", "upperarm", "uparm", "shoulder", "humerus"),
    "elbow": ("forearm", "lowerarm", "elbow", "radius"),
    "wrist": ("wrist", "hand"),
    "hip": ("upleg", "thigh", "upperleg", "hip", "femur"),
    "knee": ("leg", "shin", "lowerleg", "calf", "knee", "tibia"),
    "ankle": ("ankle", "foot"),
}
"""Landmark -> what the joint there is called, side and prefix left out, in order of trust."""
LIMBS = {"leg": ("hip", "knee", "ankle"), "arm": ("shoulder", "elbow", "wrist")}
ALIKE = 0.15
"""Chains whose bones differ by less than this share of their lengths are a pair."""
POINT = 0.01
"""Joints within this share of a chain's length are at one place."""
STRAIGHT = 1 - 1e-5
"""Bones are one whose ends never come nearer than this share of their lengths (half a degree between two alike)."""
SHOULDERS = 0.15
"""Shoulders stand apart by more than this share of the legs' chains; nearer ones are collar bones."""
SHOWS = 0.01
"""Toes and knees tell where forward is if they stand out by this share of the leg."""
UPRIGHT = np.cos(np.deg2rad(35))
MOST_CHILDREN, MOST_PAIRS, MOST_BONES = 8, 60, 16
"""How much is looked at of what strangers call a skeleton."""
END = " end"
"""How the name of a bone's mere end goes on."""


def uprightness(at: Mapping[str, FloatArray]) -> FloatArray:
    """(T,) how upright somebody stands whose landmarks are at (T, 3): cosine of the trunk with that of four leg bones
    which is furthest from it; UPRIGHT or more is."""
    trunk = unit(np.sum([at[f"{side}_shoulder"] - at[f"{side}_hip"] for side in SIDES], axis=0))
    bones = [at[f"{side}_{a}"] - at[f"{side}_{b}"] for side in SIDES for a, b in pairwise(LIMBS["leg"])]
    return np.asarray(np.min([np.einsum("ti,ti->t", unit(bone), trunk) for bone in bones], axis=0))


class Skeleton:
    """J joints: names; parents (-1: none), each before its children; places (F, J, 3): at rest, then in some frames."""

    def __init__(self, names: Sequence[str], parents: Sequence[int], places: FloatArray) -> None:
        self.names, self.parents, self.places = names, parents, places
        self.children = [[i for i, above in enumerate(parents) if above == joint] for joint in range(len(parents))]
        self.bones = np.array([np.linalg.norm(places[0, i] - places[0, max(p, 0)]) for i, p in enumerate(parents)])
        self.reach = self.bones.copy()
        for joint in reversed(range(len(parents))):
            self.reach[joint] += max((self.reach[child] for child in self.children[joint]), default=0)

    def found(self) -> tuple[dict[str, int], dict[str, int]]:
        """Landmarks (left_knee ...) and carriers (torso, pelvis, head, left_foot ...), as joints counted from 0.

        Raises:
            TeacherError: neither names nor build tell; what was looked for.
        """
        landmarks = self._named() or self._built()
        roots = {root: [landmarks[f"{side}_{root}"] for side in SIDES] for root in ("hip", "shoulder")}
        pelvis, torso = (max({*self._above(left)} & {*self._above(right)}) for left, right in roots.values())
        carriers = {"pelvis": pelvis, "torso": torso}
        taken = {above for pair in roots.values() for joint in pair for above in self._above(joint)}
        middle = [child for child in self._joints_below(torso) if child not in taken]
        if middle:
            carriers["head"] = max(middle, key=lambda child: self.reach[child])
            while len(below := self._joints_below(carriers["head"])) == 1:
                carriers["head"] = below[0]
        for side in SIDES:
            *_, carriers[f"{side}_foot"] = self._at_one_place(landmarks[f"{side}_ankle"])
        return landmarks, carriers

    def _named(self) -> dict[str, int] | None:
        """All landmarks, if each has a usual name and comes below the one before in its limb."""
        names = [name for name in self.names if not name.endswith(END)]
        shared = next((i for i, letters in enumerate(zip(*names, strict=False)) if len({*letters}) > 1), 0)
        plain = [re.sub("[^a-z0-9]", "", re.split("[:/|]", name[shared:])[-1].lower()) for name in self.names]
        found = {}
        for side in SIDES:
            for mark, words in CALLED.items():
                forms = (form for w in words for form in (side + w, w + side, side[0] + w, w + side[0]))
                found[f"{side}_{mark}"] = next((plain.index(form) for form in forms if form in plain), -1)
            for limb in LIMBS.values():
                marks = [found[f"{side}_{mark}"] for mark in limb]
                if -1 in marks or any(above not in self._above(below) for above, below in pairwise(marks)):
                    return None
        return found

    def _built(self) -> dict[str, int]:
        """All landmarks by build."""
        both = [
            (one, two)
            for one, two in combinations(self._pairs(), 2)
            if one[0] != two[0] and not {*one[1:]} & {*self._above(two[0])} and not {*two[1:]} & {*self._above(one[0])}
        ]
        if not both:
            raise TeacherError("no two legs and two arms, alike in pairs, and no names such as LeftUpLeg or lThigh")
        legs, arms = max(both, key=lambda pairs: sum(self.reach[joint] for pair in pairs for joint in pair[1:]))
        if self._goes_on(legs, arms[0]) and not self._goes_on(arms, legs[0]):
            legs, arms = arms, legs
        chains = {"leg": [self._limb(child) for child in legs[1:]]}
        apart = SHOULDERS * self.reach[list(legs[1:])].max()
        chains["arm"] = [self._limb(one, other, apart) for one, other in (arms[1:], arms[:0:-1])]
        found: dict[str, int] = {}
        for limb, pair in chains.items():
            sides = [next((side for joint in chain if (side := side_of(self.names[joint]))), "") for chain in pair]
            if {*sides} != {*SIDES}:
                at, left = self._leftwards(chains)
                sides = list(SIDES if (at[pair[0][0]] - at[pair[1][0]]) @ left > 0 else SIDES[::-1])
            for side, chain in zip(sides, pair, strict=True):
                found |= {f"{side}_{mark}": joint for mark, joint in zip(LIMBS[limb], chain, strict=True)}
        return found

    def _pairs(self) -> list[tuple[int, int, int]]:
        """Joints and two of their children each from which chains go out that are alike: the longest, parents first."""
        found = []
        for joint, children in enumerate(self.children):
            far = sorted(sorted(children, key=lambda child: -self.reach[child])[:MOST_CHILDREN])
            for one, two in combinations(far, 2):
                least = POINT * self.reach[one]
                bones = [[bone for bone in self.bones[self.chain(child)] if bone > least] for child in (one, two)]
                unlike = sum(abs(a - b) for a, b in zip_longest(*bones, fillvalue=0.0))
                if unlike < ALIKE * max(map(sum, bones)):
                    found.append((joint, one, two))
        return sorted(sorted(found, key=lambda pair: -self.reach[pair[1]])[:MOST_PAIRS])

    def _goes_on(self, pair: tuple[int, int, int], other: int) -> bool:
        """Whether a third chain goes on from where a pair begins, and not to where another pair does."""
        return any(child not in (*pair[1:], *self._above(other)) for child in self._joints_below(pair[0]))

    def _limb(self, child: int, other: int | None = None, apart: float = 0.0) -> tuple[int, int, int]:
        """The joints where the two longest bones of a chain begin and end; the shorter of both counts. It begins where
        it is `apart`, or more, from the `other` chain of its pair."""
        chain = self.chain(child)
        points = [joint for i, joint in enumerate(chain) if not i or self.bones[joint] > POINT * self.reach[child]]
        if other is not None:
            gap = self.places[:, points] - self.places[:, [other]]
            away = np.median(np.linalg.norm(gap, axis=2), axis=0)
            points = [joint for joint, far in zip(points, away, strict=True) if far > apart]
        points = points[:MOST_BONES]
        at = self.places[:, points]

        def bone(first: int, last: int) -> float:
            parts = np.linalg.norm(np.diff(at[:, first : last + 1], axis=1), axis=2).sum(1)
            whole = np.linalg.norm(at[:, last] - at[:, first], axis=1)
            return float(parts[0]) if (whole >= STRAIGHT * parts).all() else 0.0

        limbs = list(combinations(range(len(points)), 3))
        if not limbs:
            raise TeacherError(f"the chain from {self.names[child]!r} on has too few joints for a limb")
        best = max(limbs, key=lambda limb: min(bone(*limb[:2]), bone(*limb[1:])))
        return points[best[0]], points[best[1]], points[best[2]]

    def _leftwards(self, chains: Mapping[str, Sequence[tuple[int, int, int]]]) -> tuple[FloatArray, FloatArray]:
        """Places (J, 3) in a frame in which it stands most upright, and where its left is there, by toes or knees.

        Raises:
            TeacherError: they do not tell.
        """
        marks = {
            f"{side}_{mark}": joint
            for limb, pair in chains.items()
            for side, chain in zip(SIDES, pair, strict=True)
            for mark, joint in zip(LIMBS[limb], chain, strict=True)
        }
        at = {mark: self.places[:, joint] for mark, joint in marks.items()}
        how = uprightness(at)
        frame = 0 if how[0] >= UPRIGHT else int(how.argmax())
        across = at["left_hip"] - at["right_hip"]
        trunk = np.sum([at[f"{side}_shoulder"] - at[f"{side}_hip"] for side in SIDES], axis=0)
        forward = unit(np.cross(across, trunk))  # if the first of each pair is left
        toes, knees = 0.0, 0.0
        for side in SIDES:
            leg = unit(at[f"{side}_hip"] - at[f"{side}_ankle"])
            size = np.linalg.norm(at[f"{side}_hip"] - at[f"{side}_ankle"], axis=1).max()
            bend = at[f"{side}_knee"] - at[f"{side}_ankle"]
            bend = bend - np.einsum("fi,fi->f", bend, leg)[:, None] * leg
            knees += float(np.einsum("fi,fi->f", bend, forward).mean() / size)
            *_, last = self._at_one_place(marks[f"{side}_ankle"])
            foot = self.places[frame, self.chain(last)[-1]] - at[f"{side}_ankle"][frame]
            toes += float(foot @ forward[frame] / size)
        told = next((one for one in (toes, knees) if abs(one) > 2 * SHOWS), 0.0)
        if not told:
            raise TeacherError(
                "left and right cannot be told: no names such as LeftUpLeg or lThigh, no toes, no knees that bend"
            )
        return self.places[frame], np.sign(told) * across[frame]

    def _above(self, joint: int) -> list[int]:
        """The joint and all above it."""
        found = []
        while joint >= 0:
            found.append(joint)
            joint = self.parents[joint]
        return found

    def _joints_below(self, joint: int) -> list[int]:
        return [child for child in self.children[joint] if not self.names[child].endswith(END)]

    def chain(self, joint: int) -> list[int]:
        """The joint and those below it, along the longest way."""
        found = [joint]
        while self.children[found[-1]]:
            found.append(max(self.children[found[-1]], key=lambda child: self.reach[child]))
        return found

    def _at_one_place(self, joint: int) -> list[int]:
        """The joint and those below it that are where it is, along the longest way."""
        first, *below = self.chain(joint)
        away = next((i for i, one in enumerate(below) if self.bones[one] > POINT * self.reach[joint]), len(below))
        return [first, *below[:away]]
