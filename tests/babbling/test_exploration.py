"""Ways to explore: inside their range, all over it, the same again with the same seed."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from numpy.typing import NDArray

import babbling.exploration
from babbling.exploration import MotorRange, choices, in_turn, smooth

LOW, HIGH = np.array([0.0, -2.0, 1.0]), np.array([4.0, 1.0, 2.0])
MOTORS = MotorRange(LOW, HIGH, rest=np.array([2.0, 0.0, 1.0]), speed=(HIGH - LOW) / 0.3, jitter=np.zeros(3))


@pytest.mark.parametrize("explore", [smooth, choices])
def test_an_exploration_stays_in_its_range_and_can_be_repeated(explore) -> None:  # type: ignore[no-untyped-def]
    def commands(seed: int) -> NDArray[np.float64]:
        return np.array(list(islice(explore(MOTORS, 4, 0.02, np.random.default_rng(seed)), 400)))

    sent = commands(7)
    assert sent.shape == (400, 4, 3) and np.isfinite(sent).all()
    assert (sent >= LOW - 1e-12).all() and (sent <= HIGH + 1e-12).all()
    assert (np.ptp(sent, axis=(0, 1)) > 0.5 * (HIGH - LOW)).all()  # and it explores
    np.testing.assert_array_equal(sent, commands(7))
    assert (sent != commands(8)).any()


def test_smooth_moves_keep_to_the_speed_they_are_given() -> None:
    sent = np.array(list(islice(smooth(MOTORS, 8, 0.02, np.random.default_rng(0)), 2000)))
    speed = np.abs(np.diff(sent, axis=0)) / 0.02
    assert (speed <= 1.001 * MOTORS.speed).all()
    assert (speed.max((0, 1)) > 0.5 * MOTORS.speed).all()  # and it comes near it
    slow = (speed < 0.1 * MOTORS.speed).mean()
    assert 0.2 < slow < 0.95  # speeds over two decades


@pytest.mark.parametrize("decades", [1e-6, 0.5, 0.9])
def test_peak_speeds_lie_over_as_many_decades_as_asked(decades: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A move's mean speed is 8/15 of its peak; over time that is 8/15 top / E[top / peak], peaks log-uniform."""
    monkeypatch.setattr(babbling.exploration, "SHORTEST_S", 0.02)
    monkeypatch.setattr(babbling.exploration, "LONGEST_S", 1e3)  # neither end is what is asked here
    slow = replace(MOTORS, speed=(HIGH - LOW) / 3)
    sent = np.array(list(islice(smooth(slow, 40, 0.02, np.random.default_rng(1), decades=decades), 4000)))
    mean = np.abs(np.diff(sent, axis=0)).mean((0, 1)) / 0.02 / slow.speed
    wanted = 8 / 15 * decades * np.log(10) / (10**decades - 1)
    np.testing.assert_allclose(mean, wanted, rtol=0.06)


def test_choices_are_whole_numbers_each_as_likely() -> None:
    sent = np.array(list(islice(choices(MOTORS, 50, 1.0, np.random.default_rng(0)), 400)))[..., 0]
    share = np.bincount(sent.astype(int).ravel(), minlength=5) / sent.size
    assert (sent == np.round(sent)).all()
    np.testing.assert_allclose(share, 0.2, atol=4 * np.sqrt(0.16 / sent.size))


def turns(motors: MotorRange, slot_s: float, ticks: int, seed: int = 0, copies: int = 3) -> NDArray[np.float64]:
    """(T, B, M)."""
    stream = in_turn(motors, copies, 0.02, np.random.default_rng(seed), slot_s, 0.2)
    return np.array(list(islice(stream, ticks)))


@pytest.mark.parametrize("slot_s", [0.2, 0.35, 3.0])
def test_in_turn_one_motor_moves_at_a_time_and_each_has_its_turn(slot_s: float) -> None:
    slot = int(slot_s / 0.02 + 1e-9)
    sent = turns(MOTORS, slot_s, 10 + 3 * slot * 4)
    np.testing.assert_array_equal(sent[:10], np.broadcast_to(MOTORS.rest, (10, 3, 3)))  # before them nothing moves
    assert (sent >= LOW - 1e-12).all() and (sent <= HIGH + 1e-12).all()
    moved = np.diff(sent[9:], axis=0) != 0
    assert moved.sum(-1).max() == 1
    who = moved.reshape(4, 3, slot, 3, 3).any(2)  # round, turn, copy, motor
    assert (who.sum(-1) == 1).all() and (who.sum(1) == 1).all()
    orders = who.argmax(-1).transpose(0, 2, 1).reshape(-1, 3)
    assert len({*map(tuple, orders)}) > 3, "in an order of each copy's own"


def test_in_turn_moves_are_minimum_jerk_at_half_the_speed_either_way() -> None:
    slow = replace(MOTORS, rest=(LOW + HIGH) / 2, speed=(HIGH - LOW) / 4)
    sent = turns(slow, 0.4, 10 + 20 * 300, copies=2)
    step = np.diff(sent[9:], axis=0)
    fastest = np.abs(step).max((0, 1)) / 0.02 / slow.speed
    np.testing.assert_allclose(fastest, 0.5, rtol=0.01)  # and nothing jumps
    ways = step.reshape(300, 20, 2, 3).sum(1)
    np.testing.assert_allclose(np.abs(ways).max(-1), np.take(slow.speed * 0.4 * 4 / 15, np.abs(ways).argmax(-1)))
    first = turns(slow, 0.4, 30, copies=200)
    assert 0.35 < ((first[-1] - first[0]).sum(-1) > 0).mean() < 0.65
    np.testing.assert_array_equal(sent, turns(slow, 0.4, 10 + 20 * 300, copies=2))
    assert (sent != turns(slow, 0.4, 10 + 20 * 300, seed=1, copies=2)).any()
