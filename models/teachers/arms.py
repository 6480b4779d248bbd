"""Two arms of a robot, whatever its joints are called: chains that are mirror images, and in each its rigid bones.

A bone is what (nearly) keeps its length however joints are turned: a joint that only rolls it, such as Baxter's e0, is
none of its ends. Upper arm and forearm are the two longest that follow each other.
"""

from collections.abc import Collection
from itertools import combinations

import numpy as np
import pinocchio as pin

from models.arrays import FloatArray
from models.teachers.names import side_of
from models.teachers.performance import SIDES

LEAST_JOINTS, MOST_JOINTS = 5, 12
"""Of an arm (legs of four-legged robots have three, fingers four) and as far as it is looked at."""
ALIKE = 0.05
"""Mirror images differ by less than this share of the arm's length."""
RIGID = 0.15
"""Joints between which no joint bends keep their distance to this share, where a roll's axis passes by them."""
POSTURES = 20


def built_arms(model: pin.Model, legs: Collection[int]) -> dict[str, int]:
    """Landmarks left_shoulder ... right_wrist -> number of the joint there; none unless a joint has exactly one pair of
    chains below it that mirror each other (x is forward, y left, z up) without joints of `legs`, the highest if several
    have."""
    places = _places(model)
    found: list[tuple[float, list[list[int]]]] = []
    for joint in range(model.njoints):
        below = [child for child in range(1, model.njoints) if model.parents[child] == joint]
        chains = [
            chain for child in below if len(chain := _chain(model, child)) >= LEAST_JOINTS and not {*chain} & {*legs}
        ]
        pairs = [[one, two] for one, two in combinations(chains, 2) if _mirrored(places[0, one], places[0, two])]
        if len(pairs) == 1:
            found.append((float(places[0, pairs[0][0][0], 2]), pairs[0]))
    if not found:
        return {}
    _, (one, two) = max(found)
    sides = [side_of(model.names[chain[0]]) for chain in (one, two)]
    if {*sides} != {*SIDES}:
        sides = list(SIDES if places[0, one[0], 1] > places[0, two[0], 1] else SIDES[::-1])
    marks = ("shoulder", "elbow", "wrist")
    limbs = zip(sides, (_bones(places, one), _bones(places, two)), strict=True)
    return {f"{side}_{mark}": joint for side, limb in limbs for mark, joint in zip(marks, limb, strict=True)}


def _places(model: pin.Model) -> FloatArray:
    """(1 + POSTURES, joints, 3) at zero and in postures at random."""
    data, rng = model.createData(), np.random.default_rng(0)
    found = np.empty((1 + POSTURES, model.njoints, 3))
    for posture, places in enumerate(found):
        pin.forwardKinematics(
            model, data, pin.integrate(model, pin.neutral(model), (posture > 0) * rng.normal(size=model.nv))
        )
        places[:] = [pose.translation for pose in data.oMi]
    return found


def _chain(model: pin.Model, joint: int) -> list[int]:
    """A joint and those below it as far as there is one way on."""
    found = [joint]
    while len(found) < MOST_JOINTS:
        below = [child for child in range(1, model.njoints) if model.parents[child] == found[-1]]
        if len(below) != 1:
            break
        found += below
    return found


def _mirrored(one: FloatArray, two: FloatArray) -> bool:
    """Whether chains begin at mirrored places and have bones of the same lengths (they may be held unlike at zero)."""
    if len(one) != len(two):
        return False
    bones, others = (np.linalg.norm(np.diff(chain, axis=0), axis=1) for chain in (one, two))
    away = np.linalg.norm(one[0] - two[0] * (1, -1, 1))
    return bool(max(np.abs(bones - others).max(), away) < ALIKE * bones.sum())


def _bones(places: FloatArray, chain: list[int]) -> tuple[int, ...]:
    """The three joints between which the two longest rigid bones are; the shorter of both counts."""

    def length(first: int, last: int) -> float:
        apart = np.linalg.norm(places[:, first] - places[:, last], axis=1)
        return float(apart[0]) if np.ptp(apart) <= RIGID * apart.max() else 0.0

    return max(combinations(chain, 3), key=lambda limb: min(length(*limb[:2]), length(*limb[1:])))
