"""The body schema: any wiring of a body one cannot see is found by moving it, and dead motors are named."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import babbling.schema
from babbling.axes import FloatArray
from babbling.dynamics import fit_dynamics
from babbling.errors import BabblingError
from babbling.exploration import MotorRange, smooth
from babbling.pilot import pilot, wire
from babbling.schema import LEAST_BITS, find_schema, mutual_information, one_by_one, resolution, together
from tests.babbling.plant import TICK, Plant

seeds = st.integers(0, 2**32 - 1)


@settings(max_examples=8, deadline=None)
@given(seeds)
def test_every_permutation_sign_gain_and_offset_is_found(seed: int) -> None:
    plant = Plant(seed)
    found = pilot(plant, 0)
    servo = np.argsort(plant.drives)  # which each motor line drives
    np.testing.assert_array_equal(found.schema.posture, plant.sense_of(servo))
    np.testing.assert_array_equal(found.schema.rate, plant.sense_of(servo + 5))
    # what a command asks for is where the servo comes to rest
    np.testing.assert_allclose(found.schema.slope, plant.gain[servo], rtol=1e-6)
    np.testing.assert_allclose(found.schema.offset, plant.offset[servo], atol=1e-6)
    m = np.random.default_rng(seed).uniform(-1, 1, (3, 5))
    np.testing.assert_allclose(found.schema.motors(found.schema.efference(m)), m, atol=1e-9)


@settings(max_examples=4, deadline=None)
@given(seeds)
def test_relabelling_the_lines_relabels_the_schema_and_nothing_else(seed: int) -> None:
    """The same body behind other lines: the same axes and dynamics up to sign and order."""
    straight, crossed = Plant(1), Plant(1)
    order = np.random.default_rng(seed).permutation(10)
    crossed.lines = straight.lines[order]
    crossed.sense_low, crossed.sense_high = straight.sense_low[order], straight.sense_high[order]
    one, other = pilot(straight, 0), pilot(crossed, 0)
    np.testing.assert_array_equal(order[other.schema.posture], one.schema.posture)
    assert other.frame.same(one.frame)
    np.testing.assert_array_equal(other.dynamics.transition, one.dynamics.transition)


def test_a_dead_motor_is_named() -> None:
    for seed, dead in zip(range(5), (3, 0, 4, 2, 1), strict=True):
        with pytest.raises(BabblingError, match=f"motor {dead} moves nothing that is felt"):
            pilot(Plant(seed, dead=dead), 0)


def test_too_few_senses() -> None:
    rng = np.random.default_rng(0)
    motors, senses = rng.random((50, 4, 3)), rng.random((50, 4, 2))
    with pytest.raises(BabblingError, match="3 motors but only 2 senses"):
        find_schema(motors, senses, senses, np.zeros(2), np.ones(2), TICK)


def test_commands_that_the_drive_cut_do_not_bend_the_line() -> None:
    """What lies beyond what it accepts is sent as its end; the posture asked for is a line all the same."""
    rng = np.random.default_rng(0)
    motors = 0.3 * rng.standard_normal((300, 6, 2))
    cut = np.clip(motors, -0.7, 0.7)
    assert 0.01 < (cut != motors).mean() < 0.05
    felt = np.concatenate([0.1 + 0.8 * cut, rng.standard_normal(cut.shape)], axis=-1)
    found = find_schema(motors, felt, felt[:1], np.full(4, -2.0), np.full(4, 2.0), TICK)
    np.testing.assert_allclose(found.slope, 0.8, atol=1e-9)
    np.testing.assert_allclose(found.offset, 0.1, atol=1e-9)


def test_a_sense_that_rests_still_is_no_surer_than_its_steps() -> None:
    """Uniform rounding to steps of r leaves r / sqrt(12), beside what trembles at rest."""
    rng = np.random.default_rng(0)
    motors = rng.uniform(-1, 1, (200, 8, 2))
    senses = np.round(motors / 0.01) * 0.01
    resting = np.zeros((30, 8, 2))
    resting[..., 1] = 0.02 * rng.standard_normal((30, 8))
    found = find_schema(motors, senses, resting, np.full(2, -1.0), np.full(2, 1.0), 1.0)
    trembling = np.sqrt(resting.var(axis=0).mean(0)[1] + 0.01**2 / 12)
    np.testing.assert_allclose(found.noise, [0.01 / np.sqrt(12), trembling], rtol=1e-6)


def test_no_two_motors_share_a_sense(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sense 0 tells most about both motors; each motor gets a sense of its own all the same."""
    monkeypatch.setattr(babbling.schema, "HELD", 0)  # neither is a servo's
    rng = np.random.default_rng(0)
    motors = rng.uniform(-1, 1, (60, 8, 2))
    first = motors[..., 0] + 1.2 * motors[..., 1]
    second = motors[..., 1] + 0.7 * rng.standard_normal((60, 8))
    senses = np.stack([first, second], -1)
    found = find_schema(motors, senses, senses[:1], np.full(2, -4.0), np.full(2, 4.0), 1.0)
    assert found.information[1].argmax() == 0, "by itself motor 1 would take sense 0 too"
    assert found.posture.tolist() == [0, 1]


def test_where_nothing_tells_of_rates_the_schema_has_none_and_a_servo_cannot_be_learned() -> None:
    plant = Plant(0, motors=3)
    still = plant.sense_of(np.arange(3))

    class Numb:
        copies, tick_s, fingerprint = plant.copies, plant.tick_s, "numb"
        motor_low, motor_high = plant.motor_low, plant.motor_high
        sense_low, sense_high = plant.sense_low[still], plant.sense_high[still]

        def reset(self) -> FloatArray:
            return plant.reset()[:, still]

        def act(self, motors: FloatArray) -> FloatArray:
            return plant.act(motors)[:, still]

    one = np.ones(3)
    stream = smooth(MotorRange(-one, one, 0 * one, one, 0 * one), plant.copies, TICK, np.random.default_rng(0))
    schema, ticks = wire(Numb(), stream)
    servo = np.argsort(plant.drives)
    np.testing.assert_array_equal(schema.posture, servo)
    assert not len(schema.rate) and not len(schema.rate_noise) and ticks == 500
    with pytest.raises(BabblingError, match="3 motors but only 3 senses"):
        pilot(Numb(), 0)


def test_information_of_independent_and_of_identical_things() -> None:
    rng = np.random.default_rng(0)
    x = rng.standard_normal((6000, 3))
    information = mutual_information(x, np.concatenate([x, rng.standard_normal((6000, 3))], 1))
    np.testing.assert_allclose(np.diag(information[:, :3]), np.log2(12), atol=0.02)
    off = information[~np.eye(3, 6, dtype=bool)]
    assert off.max() < 0.01 and off.min() >= 0


@settings(max_examples=15, deadline=None)
@given(seeds)
def test_information_does_not_care_how_a_thing_is_measured(seed: int) -> None:
    """Rising changes of scale change no ranks; falling ones mirror the bins."""
    rng = np.random.default_rng(seed)
    x = rng.standard_normal((1200, 1))
    y = x + rng.standard_normal((1200, 1))
    plain = mutual_information(x, y)
    assert mutual_information(x, 3 * y**3 + 1) == pytest.approx(plain, abs=1e-12)
    assert mutual_information(-x, y) == pytest.approx(plain, abs=0.02)
    assert mutual_information(y, x) == pytest.approx(plain, abs=1e-12)


def test_information_of_correlated_gaussians() -> None:
    """I = -1/2 log2(1 - r^2), a little less for what twelve bins cannot tell apart."""
    rng = np.random.default_rng(3)
    x, e = rng.standard_normal((2, 200_000, 1))
    for r in (0.3, 0.6, 0.8):
        exact = -0.5 * np.log2(1 - r**2)
        assert 0.85 * exact < mutual_information(x, r * x + np.sqrt(1 - r**2) * e)[0, 0] < exact


def test_resolution_is_the_finest_step() -> None:
    x = np.random.default_rng(0).uniform(-1, 1, (5000, 1))
    assert resolution(np.rint(x * 200) / 200)[0] == pytest.approx(1 / 200)


def test_dynamics_of_a_known_line() -> None:
    """q' = q + 0.3 (c - q), v' = 0.3 (c - q) / tick: told to stay it does not coast."""
    plant = Plant(0)
    found = pilot(plant, 0)
    factor = 2
    np.testing.assert_allclose(found.dynamics.transition[factor, 0], [0.7, 0, 1], atol=1e-6)
    np.testing.assert_allclose(found.dynamics.transition[factor, 1, :2], [-0.3 / TICK, 0], atol=1e-4)
    np.testing.assert_allclose(found.dynamics.control[factor], [0.3, 0.3 / TICK, 0], atol=1e-4)
    np.testing.assert_allclose(found.dynamics.coasting, 0, atol=1e-6)


def test_slow_residuals_are_the_bias() -> None:
    """White noise has next to no slow part; a push that lasts seconds is nearly all of it."""
    plant = Plant(0, motors=2)
    schema = pilot(plant, 0).schema
    rng = np.random.default_rng(0)
    motors = rng.uniform(-0.5, 0.5, (400, 40, 2))
    white, push = 0.01 * rng.standard_normal((2, 400, 40, 2))
    for t in range(1, 400):
        push[t] = 0.98 * push[t - 1] + np.sqrt(1 - 0.98**2) * push[t]
    slow = []
    for disturbance in (white, push):
        senses = np.zeros((401, 40, 4))
        for t in range(400):
            q, step = senses[t][:, schema.posture], 0.3 * (schema.efference(motors[t]) - senses[t][:, schema.posture])
            senses[t + 1][:, schema.posture] = q + step + disturbance[t]
            senses[t + 1][:, schema.rate] = step / TICK
        slow.append(fit_dynamics(schema, motors, senses).bias_variance / 0.01**2)
    assert slow[0].max() < 0.05
    assert 0.5 < slow[1].min() and slow[1].max() < 1.1


# ------------------------------------------------------------------ motors that move in turn


def test_bits_of_changes_are_those_of_correlated_gaussians() -> None:
    """-1/2 log2(1 - r^2) between changes over 0.8 s, however a thing is measured, whatever stands or drifts beside."""
    rng = np.random.default_rng(0)
    x, e = np.cumsum(rng.standard_normal((2, 20000, 2, 2)), axis=1)
    told = one_by_one(x, np.concatenate([0.6 * x + 0.8 * e, -5 * x + 3], -1))[0]
    np.testing.assert_allclose(np.diag(told), -0.5 * np.log2(1 - 0.36), rtol=0.3)
    assert np.diag(told[:, 2:]).min() > 10 and told[[0, 1], [1, 0]].max() < 0.1
    still = one_by_one(x, np.zeros((20000, 2, 3)))[0]
    assert still.shape == (2, 3) and not still.any()


def waves(seed: int = 0) -> tuple[FloatArray, FloatArray]:
    """(T, B, 2) commands, and (T, B, 4) senses: postures that follow them, then their rates."""
    rng = np.random.default_rng(seed)
    one = np.ones(2)
    stream = smooth(MotorRange(-one, one, 0 * one, 2 * one, 0 * one), 6, TICK, rng)
    motors = np.array([next(stream) for _ in range(400)])
    rates = np.diff(motors, axis=0, prepend=motors[:1]) / TICK
    return motors, np.concatenate([0.8 * motors, 0.8 * rates], -1)


@pytest.mark.parametrize("mistaken", [(), (0,), (1,), (0, 1)])
def test_a_posture_mistaken_for_a_rate_is_put_right(mistaken: tuple[int, ...]) -> None:
    """Whatever bits say: a sense that is another's change is that one's rate."""
    motors, senses = waves()

    def told(m: FloatArray, s: FloatArray) -> tuple[FloatArray, float]:
        bits = np.array([[3.0, 0, 1, 0], [0, 3, 0, 1]])
        for f in mistaken:
            bits[f, 2 + f] = 5
        return bits, 0.1

    found = find_schema(motors, senses, senses[:1], np.full(4, -2.0), np.full(4, 2.0), TICK, told)
    assert found.posture.tolist() == [0, 1] and found.rate.tolist() == [2, 3]
    np.testing.assert_allclose(found.slope, 0.8, rtol=1e-6)


def test_a_posture_that_is_taken_is_no_other_motors(monkeypatch: pytest.MonkeyPatch) -> None:
    """Motor 1 moves a rate of motor 0's posture and nothing else: it gets no posture that is motor 0's."""
    motors, senses = waves()

    def told(m: FloatArray, s: FloatArray) -> tuple[FloatArray, float]:
        return np.array([[3.0, 0, 1, 0], [0, 0, 2, 0]]), 0.1

    wide = np.full(4, 9.0)
    with pytest.raises(BabblingError, match="motor 1 asks for no posture"):
        find_schema(motors, senses, senses[:1], -wide, wide, TICK, told)
    monkeypatch.setattr(babbling.schema, "HELD", -np.inf)
    assert find_schema(motors, senses, senses[:1], -wide, wide, TICK, told).posture.tolist() == [0, 2]


def test_what_is_pushed_about_asks_for_no_posture() -> None:
    """A pendulum on a torque motor is moved by it and told apart; a servo that lags by a fifth of a second is none."""

    class Pushed(Plant):
        def act(self, motors: FloatArray) -> FloatArray:
            wanted = self.gain * motors[:, self.drives]
            torque = np.where(np.arange(len(self.drives)) == servo, 30 * wanted - self.q, 0)
            self.v = self.v + TICK * (torque - 0.5 * self.v)
            pushed = self.q + TICK * self.v
            followed = self.q + 0.1 * (wanted - self.q)
            here = np.arange(len(self.drives)) == servo
            self.v = np.where(here, self.v, (followed - self.q) / TICK)
            self.q = np.where(here, pushed, followed)
            return self.feel()

    for seed, copies in ((0, 8), (1, 1)):
        plant = Pushed(seed, motors=3, copies=copies)
        servo = seed
        plant.sense_low, plant.sense_high = plant.sense_low - 9, plant.sense_high + 9
        with pytest.raises(BabblingError, match=f"motor {plant.drives[servo]} asks for no posture: .*at least 70%"):
            pilot(plant, 0)
        servo = -1
        assert len(pilot(plant, 0).schema.posture) == 3


def test_one_copy_alone_finds_by_chance_what_its_own_commands_of_another_time_tell() -> None:
    rng = np.random.default_rng(0)
    motors = rng.standard_normal((2000, 1, 2))
    senses = motors[..., ::-1] + 0.1 * rng.standard_normal((2000, 1, 2))
    bits, chance = together(motors, senses)
    assert (bits[[0, 1], [1, 0]] > 2).all() and (bits[[0, 1], [0, 1]] < chance).all() and chance == LEAST_BITS
    again = np.concatenate([motors[:1000], motors[:1000]])  # what was done then is what is done now
    assert together(again, again)[1] > 2


def test_a_sense_that_never_leaves_its_ends_is_no_posture() -> None:
    motors = np.random.default_rng(0).uniform(-1, 1, (900, 2, 1))
    stuck = np.where(motors > 0, 1.0, -1.0)
    with pytest.raises(BabblingError, match="motor 0: its posture sense never leaves the ends of its range"):
        find_schema(motors, stuck, np.ones((20, 2, 1)), -np.ones(1), np.ones(1), TICK)
