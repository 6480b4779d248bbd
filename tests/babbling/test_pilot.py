"""The pilot of few bodies: it finds every wire, however many there are, in the time it says."""

from pathlib import Path

import numpy as np
import pytest

from babbling.axes import FloatArray
from babbling.errors import BabblingError
from babbling.pilot import JITTER, JITTER_SHARE, begin, pilot, pilot_minutes
from models.loading import load_body
from tests.babbling.plant import TICK, Plant


@pytest.mark.parametrize("copies", [1, 2])
@pytest.mark.parametrize("seed", range(5))
def test_few_bodies_of_a_robot_find_their_wires(arm: Path, copies: int, seed: int) -> None:
    body = load_body(arm, copies=copies, scramble=seed, seed=seed, noise=float(np.deg2rad(0.1)), threads=1)
    schema = pilot(body, seed).schema
    assert [body.sense_labels[line] for line in schema.posture] == list(body.motor_labels)
    assert [body.sense_labels[line].removesuffix(" speed") for line in schema.rate] == list(body.motor_labels)
    asked = np.eye(3)[:, None] * [[-0.01], [0.01]]  # every motor line alone, both ways
    joints = [body.joints.index(name) for name in body.motor_labels]
    told = np.diff(body.commands(asked)[..., joints], axis=1)[:, 0].diagonal()
    np.testing.assert_allclose(schema.slope * 0.02, told, rtol=0.15)


@pytest.mark.parametrize(
    ("copies", "motors", "seed"),
    [(1, 43, 0), (3, 60, 0), *((*few, seed) for few in ((1, 5), (2, 5), (1, 20)) for seed in range(5))],
)
def test_few_bodies_behind_any_wires_find_them_however_many_they_are(copies: int, motors: int, seed: int) -> None:
    plant = Plant(seed, motors=motors, copies=copies)
    schema = pilot(plant, seed).schema
    servo = np.argsort(plant.drives)
    np.testing.assert_array_equal(schema.posture, plant.sense_of(servo))
    np.testing.assert_array_equal(schema.rate, plant.sense_of(servo + motors))
    np.testing.assert_allclose(schema.slope, plant.gain[servo], rtol=1e-6)


def test_a_dead_motor_of_one_body_is_named() -> None:
    for seed, dead in ((0, 3), (1, 0)):
        with pytest.raises(BabblingError, match=f"motor {dead} moves nothing that is felt"):
            pilot(Plant(seed, copies=1, dead=dead), 0)


class Cut(Plant):
    """Its drives accept a third of the commands; the others are cut, where its senses end."""

    def __init__(self, seed: int, copies: int) -> None:
        super().__init__(seed, copies=copies)
        middle, reach = np.append(self.offset, np.zeros(5)), np.append(np.abs(self.gain), np.full(5, 5.0))
        self.sense_low, self.sense_high = (middle - reach)[self.lines], (middle + reach)[self.lines]

    def act(self, motors: FloatArray) -> FloatArray:
        return super().act(np.clip(3 * motors, -1, 1))


class Trembling(Plant):
    """Its senses do."""

    def feel(self) -> FloatArray:
        self.rng = getattr(self, "rng", None) or np.random.default_rng(0)
        sigma = np.repeat([0.01, np.sqrt(2) * 0.01 / TICK], len(self.drives))[self.lines]
        return super().feel() + sigma * self.rng.standard_normal(len(sigma))


@pytest.mark.parametrize("copies", [1, 8])
def test_servos_whose_drives_cut_most_commands_are_servos(copies: int) -> None:
    """What the least and the greatest command ask for is where they stand; only between them is it asked who holds."""
    for seed in range(3):
        plant = Cut(seed, copies=copies)
        schema, servo = pilot(plant, seed).schema, np.argsort(plant.drives)
        np.testing.assert_array_equal(schema.posture, plant.sense_of(servo))
        np.testing.assert_allclose(schema.slope, 3 * plant.gain[servo], rtol=0.02)


def test_servos_whose_senses_tremble_more_than_they_move_in_turn_are_servos() -> None:
    """A motor of twenty moves by a fiftieth of its range or two; what is noise at rest is noise then too."""
    for seed in range(2):
        plant = Trembling(seed, motors=20, copies=1)
        schema, servo = pilot(plant, seed).schema, np.argsort(plant.drives)
        np.testing.assert_array_equal(schema.posture, plant.sense_of(servo))


class Watched(Plant):
    """It keeps what it was told."""

    def act(self, motors: FloatArray) -> FloatArray:
        self.told = [*getattr(self, "told", []), motors.copy()]
        return super().act(motors)


@pytest.mark.parametrize("copies", [1, 6, 7])
def test_it_takes_the_time_it_says_and_few_bodies_move_in_turn(copies: int) -> None:
    """Below 50 s of body time for wiring; from there on all motors move at once."""
    plant = Watched(0, copies=copies)
    found, _ = begin(plant, 0)
    assert len(plant.told) * TICK * copies / 60 == pytest.approx(pilot_minutes(copies)) == found.minutes
    wiring = np.array(plant.told)[100:500]
    at_once = (np.diff(wiring, axis=0) != 0).sum(-1).max()
    assert at_once == (5 if copies * 8 >= 50 else 1)


def test_small_joints_are_jittered_by_a_share_of_their_range() -> None:
    """Fingers of a few centimetres as well as arms: 0.6 degrees, or an eightieth of the range where that is less."""
    for size in (1.0, 0.02):
        plant = Plant(0, motors=3, size=size)
        found = pilot(plant, 0)
        span = (plant.sense_high - plant.sense_low)[found.schema.posture]
        jitter = found.motors.jitter * np.abs(found.schema.slope)
        np.testing.assert_allclose(jitter, np.minimum(JITTER, JITTER_SHARE * span))
        assert (jitter < JITTER).all() == (size < 1)
