"""Wiring: whatever is crossed, flipped and scaled, every posture stays within reach and the way back is exact."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.loading import load_body
from models.wiring import Wiring

seeds = st.integers(0, 2**31)


@given(seeds, st.integers(1, 30))
def test_lines_undo_fractions(seed: int, motors: int) -> None:
    wiring = Wiring.scrambled(motors, 2 * motors, seed)
    fractions = np.random.default_rng(seed).uniform(-1, 1, (7, motors))
    np.testing.assert_allclose(wiring.fractions(wiring.lines(fractions)), fractions, atol=1e-12)


def test_every_posture_is_within_reach_for_a_hundred_wirings() -> None:
    ends = np.array([[-1.0], [1.0]]) * np.ones((1, 25))
    for seed in range(100):
        wiring = Wiring.scrambled(25, 50, seed)
        assert np.abs(wiring.lines(ends)).max() <= 1 + 1e-12
        assert sorted(wiring.motor) == list(range(25)) and sorted(wiring.sense) == list(range(50))
        assert ((np.abs(wiring.gain) >= 0.5) & (np.abs(wiring.gain) <= 2)).all()


def test_wirings_differ_and_are_the_same_for_one_seed() -> None:
    one, same, other = (Wiring.scrambled(25, 50, seed) for seed in (7, 7, 8))
    for name in ("motor", "gain", "offset", "sense"):
        np.testing.assert_array_equal(getattr(one, name), getattr(same, name))
        assert not np.array_equal(getattr(one, name), getattr(other, name))
    assert (one.gain < 0).any() and (one.gain > 0).any()


def test_straight_wiring_is_the_middle_and_the_ends() -> None:
    straight = Wiring.straight(3, 6)
    np.testing.assert_array_equal(straight.fractions(np.array([0.0, 0.5, -0.5])), [0, 1, -1])
    np.testing.assert_array_equal(straight.fractions(np.array([1.0, -1.0, 0.25])), [1, -1, 0.5])


@pytest.mark.parametrize("scramble", [None, 0, 1])
def test_labels_say_what_the_lines_are(arm, scramble: int | None) -> None:
    """A push of the line labelled with a joint moves that joint, and the sense so labelled reports its angle."""
    body = load_body(arm, scramble=scramble)
    rest = body.command_angles(np.zeros(3))
    for line, label in enumerate(body.motor_labels):
        body.reset()
        motors = rest.copy()
        motors[line] += 0.1 * body.wiring.gain[np.flatnonzero(body.wiring.motor == line)[0]]
        felt = np.zeros(6)
        for _ in range(25):
            felt = body.act(motors[None])[0]
        true = dict(zip(body.joints, body.joint_angles[0], strict=True))
        assert true[label] > 0.1
        for joint, angle in true.items():
            assert felt[body.sense_labels.index(joint)] == pytest.approx(angle, abs=1e-12)
        sensed = body.sensations(body.joint_angles)[0]
        angles = [i for i, name in enumerate(body.sense_labels) if "speed" not in name]
        np.testing.assert_allclose(sensed[angles], felt[angles], atol=1e-12)
        assert np.isnan(np.delete(sensed, angles)).all()
