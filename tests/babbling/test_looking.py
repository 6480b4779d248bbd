"""Oculomotor babbling on a head of pure geometry: no physics, no pixels, an exact oracle."""

from functools import cache

import numpy as np
import pytest

from babbling.errors import BabblingError
from babbling.files import load, save
from babbling.looking import LookingMind, Reach, copy_terms, pilot_looking, saccades
from babbling.loop import babble, explore, flat
from imitation.gaze.fixation import Fixation
from imitation.gaze.reader import GazeReader
from imitation.seeing.stereo import Geometry

FOCAL, HALF = 138.6, np.array([79.5, 59.5])
REACH = Reach(np.array([-0.6, -0.4]), np.array([0.6, 0.4]), np.array([0.5, 0.4]))


class GeometricHead:
    """Pan about the vertical, tilt about the carried lateral axis, two parallel eyes in the axes' crossing point."""

    tick_s, fingerprint = 1.0, "geometric"
    motor_low, motor_high = -np.ones(2), np.ones(2)

    def __init__(self, copies: int = 24, toys: int = 12, seed: int = 0, noise: float = 0.03) -> None:
        self.copies, self.noise = copies, noise
        self.rng = np.random.default_rng(seed)
        bearing, elevation = self.rng.uniform(-0.8, 0.8, (copies, toys)), self.rng.uniform(-0.6, 0.6, (copies, toys))
        self.ways = np.stack(
            [np.cos(elevation) * np.cos(bearing), np.cos(elevation) * np.sin(bearing), np.sin(elevation)], -1
        )
        self.sense_low = np.concatenate([[-1.0, -1.0], np.zeros(4 * toys)])
        self.sense_high = np.concatenate([[1.0, 1.0], np.tile(2 * HALF, 2 * toys)])
        self.posture = np.zeros((copies, 2))

    def reset(self) -> np.ndarray:
        self.posture = np.zeros((self.copies, 2))
        return self._see()

    def act(self, motors: np.ndarray) -> np.ndarray:
        self.posture = 0.9 * motors + 0.01
        return self._see()

    def _see(self) -> np.ndarray:
        pan, tilt = self.posture.T[:, :, None]
        x = self.ways[..., 0] * np.cos(pan) + self.ways[..., 1] * np.sin(pan)
        y = -self.ways[..., 0] * np.sin(pan) + self.ways[..., 1] * np.cos(pan)
        forward = x * np.cos(tilt) - self.ways[..., 2] * np.sin(tilt)
        up = x * np.sin(tilt) + self.ways[..., 2] * np.cos(tilt)
        u, v = -FOCAL * y / forward, -FOCAL * up / forward
        place = np.stack([u, v, u - 8.0, v], -1)
        place += self.noise * self.rng.standard_normal(place.shape)
        half = np.tile(HALF, 2)
        seen = (np.abs(place) < half) & (forward > 0)[..., None]
        seen = np.repeat(seen[..., 0::2] & seen[..., 1::2], 2, axis=-1)
        senses = np.where(seen, place + half, np.nan)
        return np.concatenate([self.posture, senses.reshape(self.copies, -1)], axis=1)


@pytest.fixture(scope="module")
def mind() -> LookingMind:
    body = GeometricHead()
    found = pilot_looking(body, REACH, 0)
    model = babble(body, found, (20,) * 6, 0)
    return LookingMind(found, model, 2.0)


def test_predicts_unseen_saccades_of_both_motors_better_than_least_squares(mind: LookingMind) -> None:
    body = GeometricHead(seed=9, noise=0.0)
    stream = saccades(REACH, mind.pilot.schema, body.copies, np.random.default_rng(5), together=True)
    before, motors, after = flat(*explore(body, stream, 20))
    retina = mind.pilot.retina
    was, now = retina.things(before), retina.things(after)
    posture = np.repeat(before[:, None, :2], was.shape[1], 1)
    change = np.repeat(mind.pilot.schema.efference(motors)[:, None], was.shape[1], 1) - posture
    error = {}
    for table in (True, False):
        away = np.hypot(*np.moveaxis(mind.expect(was, posture, change, table=table) - now, -1, 0)[:2])
        error[table] = away[np.isfinite(away)].mean()
    assert error[True] <= 0.3
    assert error[True] <= error[False]


def test_one_saccade_of_equation_one_brings_a_thing_to_the_middle(mind: LookingMind) -> None:
    body = GeometricHead(seed=3, noise=0.0)
    senses = body.reset()
    things = mind.pilot.retina.things(senses)
    central = (np.abs(things[..., :2]) < 0.7 * HALF).all(-1)
    target = central.argmax(1)
    use = central.any(1)
    every = np.arange(body.copies)
    saccade = Fixation(mind).choose(np.nan_to_num(things[every, target]), senses[:, :2], np.random.default_rng(0))
    after = mind.pilot.retina.things(body.act(mind.pilot.schema.motors(senses[:, :2] + saccade.change)))
    away = np.hypot(*after[every, target, :2].T)[use]
    assert not saccade.uninformed[use].any()
    assert away.max() < 0.8


class CrossedHead(GeometricHead):
    """Its first motor tilts, the wrong way round and half as far; its second pans; sense lines are crossed as well."""

    def act(self, motors: np.ndarray) -> np.ndarray:
        return super().act(motors[:, ::-1] * (1.0, -0.5))

    def _see(self) -> np.ndarray:
        senses = super()._see()
        return np.concatenate([senses[:, 1::-1], senses[:, 2:]], axis=1)


@cache
def crossed_mind() -> LookingMind:
    body = CrossedHead()
    found = pilot_looking(body, Reach(REACH.low[::-1], REACH.high[::-1], REACH.largest[::-1]), 0)
    return LookingMind(found, babble(body, found, (20,) * 6, 0), 2.0)


@pytest.mark.parametrize("goal", [(0.0, 0.0), (9.0, -5.0)])
def test_a_neck_with_crossed_wires_looks_as_well(mind: LookingMind, goal: tuple[float, float]) -> None:
    """Which motor has which posture sense, and which carries things along u, is found."""
    assert mind.pilot.movers.tolist() == [0, 1]
    found = crossed_mind().pilot
    assert (found.schema.posture.tolist(), found.movers.tolist()) == ([0, 1], [1, 0])
    np.testing.assert_allclose(found.schema.slope, (-0.45, 0.9), rtol=1e-6)
    judge = CrossedHead(seed=3, noise=0.0)
    senses = judge.reset()
    things = found.retina.things(senses)
    central = (np.abs(things[..., :2]) < 0.7 * HALF).all(-1)
    target, use, every = central.argmax(1), central.any(1), np.arange(judge.copies)
    posture, rng = found.posture(senses), np.random.default_rng(0)
    saccade = Fixation(crossed_mind()).choose(np.nan_to_num(things[every, target]), posture, rng, goal)
    after = found.retina.things(judge.act(found.schema.motors(posture + saccade.change)))
    assert np.hypot(*(after[every, target, :2] - goal).T)[use].max() < 0.8


def test_how_one_would_look_there_is_the_same_with_crossed_wires(mind: LookingMind) -> None:
    places = np.random.default_rng(0).uniform((4.0, -2.0, -2.0), (6.0, 2.0, 0.0), (20, 3))
    poses = []
    for one in (mind, crossed_mind()):
        reader = GazeReader((Fixation(one), Fixation(one, eye=1)), Geometry(FOCAL), 0.14)
        poses.append(reader.imagined(places, np.array([11.0, 0.0, 0.0])))
    np.testing.assert_allclose(*poses, atol=0.02)
    assert np.ptp(poses[0], axis=0).min() > 0.1


def test_efference_copy_says_that_nothing_moves_when_nothing_is_done() -> None:
    assert not copy_terms(np.zeros(3), np.ones(3), np.ones(3), np.ones(3)).any()
    assert copy_terms(np.ones(1), *np.ones((3, 1))).shape == (1, 15)


def test_a_mind_survives_its_file(mind: LookingMind, tmp_path) -> None:  # type: ignore[no-untyped-def]
    save(mind, tmp_path / "eyes.nc")
    again = load(tmp_path / "eyes.nc", LookingMind)
    np.testing.assert_array_equal(again.forward_model.counts, mind.forward_model.counts)
    things, posture, change = np.array([[10.0, -5.0, 2.0, -5.0]]), np.zeros((1, 2)), np.array([[0.2, -0.1]])
    np.testing.assert_array_equal(again.expect(things, posture, change), mind.expect(things, posture, change))


def test_eyes_of_another_body_are_refused(mind: LookingMind) -> None:
    stranger = GeometricHead(copies=1)
    stranger.fingerprint = "other"  # type: ignore[misc]
    with pytest.raises(BabblingError, match="another body"):
        mind.check(stranger)


class CarriedHead(GeometricHead):
    """Its neck stands on a waist that turns too: three motors, on crossed sense lines."""

    motor_low, motor_high = -np.ones(3), np.ones(3)

    def __init__(self, **more: object) -> None:
        super().__init__(**more)  # type: ignore[arg-type]
        self.sense_low, self.sense_high = np.append(-1.0, self.sense_low), np.append(1.0, self.sense_high)
        self.angles = np.zeros((self.copies, 3))

    def reset(self) -> np.ndarray:
        return self.act(np.zeros((self.copies, 3)))

    def act(self, motors: np.ndarray) -> np.ndarray:
        self.angles = motors * (0.9, 0.8, 0.7)
        self.posture = np.stack([self.angles[:, 0] + self.angles[:, 1], self.angles[:, 2]], axis=1)
        return np.concatenate([self.angles[:, [2, 0, 1]], self._see()[:, 2:]], axis=1)


def test_three_motors_are_found_and_chained(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("babbling.looking.GRID", (5, 5, 3, 7, 21))
    told = Reach(np.full(3, -0.25), np.full(3, 0.25), np.array([0.25, 0.24, 0.23]))  # by sense line
    body = CarriedHead()
    found = pilot_looking(body, told, 0)
    assert found.schema.posture.tolist() == [1, 2, 0]
    reach = found.reach
    assert reach.largest.tolist() == [0.24, 0.23, 0.25]
    np.testing.assert_allclose(found.schema.slope, (0.9, 0.8, 0.7), rtol=1e-6)
    mind = LookingMind(found, babble(body, found, (20,) * 4, 0), 1.0)
    assert [axis.name for axis in mind.forward_model.contexts] == ["u", "v", "other", "other1"]
    judge = CarriedHead(seed=9, noise=0.0)
    stream = saccades(reach, found.schema, judge.copies, np.random.default_rng(5), together=True)
    before, motors, after = flat(*explore(judge, stream, 10))
    was, now = found.retina.things(before), found.retina.things(after)
    posture = np.repeat(before[:, None, found.schema.posture], was.shape[1], 1)
    change = np.repeat(found.schema.efference(motors)[:, None], was.shape[1], 1) - posture
    away = np.hypot(*np.moveaxis(mind.expect(was, posture, change) - now, -1, 0)[:2])
    assert np.nanmedian(away) < 0.4
    moved = np.hypot(*np.moveaxis(was - now, -1, 0)[:2])
    assert np.nanmedian(moved) > 15


def test_nothing_to_look_at_is_said(tmp_path) -> None:  # type: ignore[no-untyped-def]
    body = GeometricHead(copies=4)
    body.ways[:] = [-1.0, 0.0, 0.0]
    with pytest.raises(BabblingError, match="little to look at"):
        pilot_looking(body, REACH, 0)


def test_eyes_of_another_size_are_refused(mind: LookingMind) -> None:
    other = GeometricHead(copies=1)
    other.sense_high = np.where(np.arange(len(other.sense_high)) < 2, other.sense_high, 2 * other.sense_high + 1)
    with pytest.raises(BabblingError, match=r"learned with retinas of .* pixels, this body has others"):
        mind.check(other)
