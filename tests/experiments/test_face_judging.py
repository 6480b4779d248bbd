"""What a judge sees of a face: labels of gestures done exactly, organs of what is believed, and what a face shows."""

from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray

from babbling.relations import RELATIONS
from experiments.face.judging import MAIN, ORGAN_SHOWN, ORGANS, RANGE, labels, largest_change, organs
from experiments.face.showing import HOLD_S, SHOWN, SIDED, Shown, drawn, performed, still, truth
from experiments.face.theories import GESTURES, LABELS
from imitation.correspondence.own_acts import OwnActs
from models.face import FACES, JOINTS, SLIDES, Face, relations
from models.face.body import face_model
from models.servos import resting
from tests.babbling.mouth import Mouth, grown

Array = NDArray[np.float64]
LIPS = ("upper_lip_left", "upper_lip_right", "lower_lip_left", "lower_lip_right")
STRONG, WEAK = 0, 1
NOTHING = LABELS - 1
JUDGED = ("newborn", "adult", "adult-long", "adult-round")


def related(face: Face, angles: Array) -> Array:
    """(N, 8) true relations of (N, 8) joints exactly so, all halves of the lips alike."""
    model = face_model(face)
    configurations = np.tile(resting(model), (len(angles), 1))
    for joint, column in zip(JOINTS, angles.T, strict=True):
        for one in LIPS if joint in LIPS else (joint,):
            configurations[:, int(model.joint(one).qposadr[0])] = column
    return truth(face).of(configurations)


def corners(face: Face, gesture: str, strength: int) -> Array:
    """(N, 8) joints of the least and the most that the gesture is, to either side, and of twenty between."""
    ranges = SHOWN[gesture][strength]
    rng, found = np.random.default_rng(3), []
    ends = [
        (least, most, -least, -most) if joint in SIDED else (least, most) for joint, (least, most) in ranges.items()
    ]
    some = [tuple(rng.uniform(least, most) for least, most in ranges.values()) for _ in range(20)]
    for amounts in (*product(*ends), *some):
        angles = np.zeros(len(JOINTS))
        for joint, amount in zip(ranges, amounts, strict=True):
            unit = 1e-3 * face.proportions.size if joint in SLIDES else np.deg2rad(1)
            angles[JOINTS.index(joint)] = amount * unit
        found.append(angles)
    return np.stack(found)


# ------------------------------------------------------------------------------------------------ labels


@pytest.mark.parametrize("name", JUDGED)
def test_every_gesture_is_told_strong_or_weak_from_all_others(name: str) -> None:
    for strength, (number, gesture) in product((STRONG, WEAK), enumerate(GESTURES)):
        found = labels(related(FACES[name], corners(FACES[name], gesture, strength)))
        assert (found == number).all(), (gesture, strength)


@pytest.mark.parametrize("name", JUDGED)
def test_gestures_performed_in_physics_are_told_too_and_a_face_at_rest_does_nothing(name: str) -> None:
    face, rng = FACES[name], np.random.default_rng(1)
    shown = [drawn(face, gesture, strong, rng) for gesture in range(len(GESTURES)) for strong in (True, False)]
    nothing = Shown(NOTHING, True, np.zeros(len(JOINTS)))
    found = labels(truth(face).of(performed(face, [*shown, nothing])[-1]))
    np.testing.assert_array_equal(found, [*(one.gesture for one in shown), NOTHING])


def test_nothing_is_nothing_and_so_is_a_trace() -> None:
    assert labels(np.zeros(8)) == NOTHING
    at_rest = related(FACES["newborn"], np.zeros((1, 8)))
    assert labels(at_rest[0]) == NOTHING
    for relation in range(8):
        for sign in (-1, 1):
            trace = at_rest[0] * 0
            trace[relation] = sign * 0.04 * RANGE[relation]
            assert labels(trace) == NOTHING
    assert labels(np.zeros((2, 3, 8))).shape == (2, 3)


def test_a_tongue_behind_lips_or_in_a_shut_mouth_is_no_tongue_out() -> None:
    behind, shut, out, aside = np.zeros((4, 8))
    behind[:3], shut[:3], out[:3], aside[:3] = (0.4, -0.1, 0.3), (0.05, 0.2, 0.3), (0.4, 0.1, 0.02), (0.4, 0.1, -0.1)
    assert labels(np.stack([behind, shut, out, aside])).tolist() == [2, NOTHING, 0, 1]


def test_the_larger_share_is_the_label_brows_and_heads_counting_twice() -> None:
    """They go both ways from rest, so that half their range is all that they can do."""
    for first, second in ((4, 5), (0, 6), (5, 7), (0, 4)):
        for more in (first, second):
            relations = np.where(np.arange(8) == 1, -0.4, 0.0)  # the tongue inside
            for one in (first, second):
                half = 0.5 if one in (5, 6, 7) else 1.0
                relations[one] = (0.6 if one == more else 0.5) * half * RANGE[one]
            assert labels(relations) == {0: 2, 4: 3, 5: 4, 6: 5, 7: 5}[more], (first, second, more)
    assert labels(-np.eye(8)[7] * 0.3) == labels(np.eye(8)[6] * 0.3) == GESTURES.index("head turn")


def test_ranges_are_what_a_newborn_s_motors_can_do() -> None:
    model = face_model(FACES["newborn"])
    low, high = np.array([
        model.actuator_ctrlrange[next(a for a in range(model.nu) if model.actuator_trnid[a, 0] == model.joint(j).id)]
        for j in JOINTS
    ]).T  # fmt: skip
    ends = [related(FACES["newborn"], np.diag(end)) for end in (low, high)]
    ends[0][0, 0] = 0.0  # lips part there, further they do not shut
    reach = np.abs(ends[1] - ends[0]).diagonal()
    np.testing.assert_allclose(RANGE, reach, atol=0.012)


# ------------------------------------------------------------------------------------------------ organs


@pytest.fixture(scope="module")
def acts() -> OwnActs:
    return OwnActs(grown(300))


@pytest.fixture(scope="module")
def joints() -> NDArray[np.int64]:
    """(M,) joint that each motor moves."""
    return np.argsort(Mouth().motor)


def believed(acts: OwnActs, joints: NDArray[np.int64], *moved: int) -> dict[str, float]:
    """Organs, where it is certain that these joints were moved."""
    sure = np.array([{int(joints[motor]) for motor in one.motors} == set(moved) for one in acts.acts], float)
    assert sure.sum() == 1
    found = organs(acts, sure, joints)
    assert found.sum() == pytest.approx(1)
    return {name: p for name, p in zip((*ORGANS, "nothing"), found, strict=True) if p > 0}


def test_organs_are_those_of_the_joints_and_the_mouth_counts_alone_only(
    acts: OwnActs, joints: NDArray[np.int64]
) -> None:
    alone = ("jaw", "tongue", "tongue", "tongue", "lips", "brows", "head", "head")
    for joint, organ in enumerate(alone):
        assert believed(acts, joints, joint) == {organ: 1.0}
        if joint:
            assert believed(acts, joints, 0, joint) == {organ: 1.0}
    assert believed(acts, joints) == {"nothing": 1.0}
    assert believed(acts, joints, 0, 1, 2) == believed(acts, joints, 2, 3) == {"tongue": 1.0}
    assert believed(acts, joints, 0, 1, 5) == {"tongue": 0.5, "brows": 0.5}
    assert believed(acts, joints, 4, 7) == {"lips": 0.5, "head": 0.5}


def test_organs_sum_to_one_and_mix_as_beliefs_do(acts: OwnActs, joints: NDArray[np.int64]) -> None:
    rng = np.random.default_rng(0)
    beliefs = rng.dirichlet(np.ones(len(acts.acts)), (3, 2))
    found = organs(acts, beliefs, joints)
    assert found.shape == (3, 2, len(ORGANS) + 1) and (found >= 0).all()
    np.testing.assert_allclose(found.sum(-1), 1)
    np.testing.assert_allclose(
        organs(acts, 0.3 * beliefs[0] + 0.7 * beliefs[1], joints), 0.3 * found[0] + 0.7 * found[1]
    )


def test_the_largest_change_is_a_share_of_what_can_be() -> None:
    rest = np.random.default_rng(2).uniform(-0.3, 0.3, 8)
    whose = [ORGANS.index(name) for name in ("jaw", "tongue", "tongue", "tongue", "lips", "brows", "head", "head")]
    for sign in (-1, 1):
        np.testing.assert_array_equal(largest_change(rest + sign * 0.2 * np.diag(RANGE), rest), whose)
    both = rest.copy()
    both[[0, 5]] += 0.2, -0.12  # more of the mouth in widths, of brows in what they can do
    assert ORGANS[int(largest_change(both, rest))] == "brows"
    assert largest_change(np.tile(rest, (2, 3, 1)), rest).shape == (2, 3)


def test_every_gesture_is_about_the_organ_that_shows_it() -> None:
    alone = np.eye(8)[MAIN] * RANGE
    np.testing.assert_array_equal(largest_change(alone, np.zeros(8)), ORGAN_SHOWN)
    at_rest = related(FACES["newborn"], np.zeros((1, 8)))[0]
    for number, gesture in enumerate(GESTURES):
        for strength in (STRONG, WEAK):
            change = np.abs(related(FACES["newborn"], corners(FACES["newborn"], gesture, strength)) - at_rest)
            assert (change[:, MAIN[number]] > 0.02).all(), RELATIONS[MAIN[number]]
        strong, weak = (related(FACES["newborn"], corners(FACES["newborn"], gesture, s)) for s in (STRONG, WEAK))
        least, most = (np.abs(one[:, MAIN[number]] - at_rest[MAIN[number]]) for one in (strong, weak))
        assert least.min() > most.max(), f"strong {gesture} is more than weak"


# ------------------------------------------------------------------------------------------------- shows


def test_what_is_drawn_lies_within_what_is_shown_whatever_the_size() -> None:
    for name, size in (("newborn", 1.0), ("adult", FACES["adult"].proportions.size)):
        rng = np.random.default_rng(5)
        for gesture, (strong, weak) in SHOWN.items():
            for is_strong, ranges in ((True, strong), (False, weak)):
                one = [drawn(FACES[name], GESTURES.index(gesture), is_strong, rng).angles for _ in range(30)]
                for joint, column in zip(JOINTS, np.array(one).T, strict=True):
                    least, most = ranges.get(joint, (0.0, 0.0))
                    unit = 1e-3 * size if joint in SLIDES else np.deg2rad(1)
                    amount = np.abs(column) / unit
                    assert ((amount >= least - 1e-9) & (amount <= most + 1e-9)).all()
                    assert (np.ptp(np.sign(column)) == 2) == (joint in SIDED and joint in ranges)
                    assert joint not in ranges or np.ptp(amount) > 0.5 * (most - least)


def test_acts_are_performed_side_by_side_and_seen_through_to_their_end() -> None:
    face, rng = FACES["newborn"], np.random.default_rng(6)
    shown = [drawn(face, gesture, True, rng) for gesture in (0, 2, 5)]
    frames = performed(face, shown, 0.02)
    assert frames.shape == (round(HOLD_S / 0.02), 3, face_model(face).nq)
    np.testing.assert_allclose(frames[-1], performed(face, shown)[-1], atol=1e-6)
    way = truth(face).of(frames)[:, [0, 1, 2], MAIN[[0, 2, 5]]]
    gone = np.abs(way - way[0]) / np.abs(way[-1] - way[0])
    assert (gone[5] < 1).all() and (gone[3] > 0.05).all(), "they take their time"
    np.testing.assert_array_equal(performed(face, shown[1:])[-1, 0], performed(face, shown)[-1, 1])
    assert np.abs(truth(face).of(still(face))[[0, 2, 3, 4, 5, 6, 7]]).max() < 5e-3


def test_body_and_mind_speak_of_the_same_relations() -> None:
    assert RELATIONS == relations.RELATIONS
