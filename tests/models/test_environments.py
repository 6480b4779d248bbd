"""Bodies that others made, behind the `Body` protocol: they babble and imitate, and what cannot be one says so."""

from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from dm_control import mujoco, suite
from dm_control.rl import control
from gymnasium.spaces import Box, Dict, Discrete

from babbling.body import Body
from babbling.mind import learn
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement
from models.environments import EnvironmentBody
from models.errors import BodyError
from tests import test_conformance
from tests.models.serial_arm import SerialArm

ARM = """<mujoco><compiler angle="radian"/><option timestep="0.005" gravity="0 0 0"/><default><joint axis="0 1 0"
 damping=".05" armature="0.01"/><position kp="20" kv="1.5" inheritrange="1"/></default><worldbody>
 <body><joint name="a" range="-1.5 1.5"/><geom type="capsule" size=".02 .1" mass=".2"/><body pos="0 0 .2">
 <joint name="b" range="-1 1"/><geom type="capsule" size=".02 .1" mass=".1"/></body></body></worldbody>
 <actuator><position joint="a"/><position joint="b"/></actuator></mujoco>"""
FREE = {"time_limit": float("inf")}


class Springs:
    """Two servos that follow their command like damped springs; a little noise is felt."""

    def __init__(self) -> None:
        self.state, self.told, self.rng = np.zeros((2, 2)), np.zeros(2), np.random.default_rng(0)

    def write(self, angles: np.ndarray) -> None:
        self.told = np.array(angles)

    def read(self) -> np.ndarray:
        return self.state.ravel() + 1e-4 * self.rng.standard_normal(4)

    def wait(self, seconds: float) -> None:
        for _ in range(20):
            push = 900 * (self.told - self.state[0]) - 45 * self.state[1]
            self.state[1] += push * seconds / 20
            self.state[0] += self.state[1] * seconds / 20


class Servos(gymnasium.Env[Any, Any]):
    """The same as an environment."""

    dt = 0.02
    action_space = Box(np.float32([-1.5, -1]), np.float32([1.5, 1]))
    observation_space = Box(np.float64([-1.6, -1.1, -60, -60]), np.float64([1.6, 1.1, 60, 60]), dtype=np.float64)

    def __init__(self, ends: int | None = None) -> None:
        self.ends = ends

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[np.ndarray, dict[str, Any]]:
        self.springs, self.left = Springs(), self.ends
        self.springs.rng = np.random.default_rng(seed)
        return self.springs.read(), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        self.springs.write(action)
        self.springs.wait(self.dt)
        self.left = self.left and self.left - 1
        return self.springs.read(), 0.0, self.left == 0, False, {}


class Still(control.Task):
    """Nothing to be done with an arm."""

    def initialize_episode(self, physics: Any) -> None:
        pass

    def before_step(self, action: Any, physics: Any) -> None:
        physics.set_control(action)

    def after_step(self, physics: Any) -> None:
        pass

    def action_spec(self, physics: Any) -> Any:
        return mujoco.action_spec(physics)

    def get_observation(self, physics: Any) -> Any:
        return OrderedDict(posture=physics.data.qpos.copy(), rate=physics.data.qvel.copy(), at=physics.data.xpos[2, :1])

    def get_reward(self, physics: Any) -> float:
        return 0.0


def arm(xml: str = ARM, **how: Any) -> control.Environment:
    return control.Environment(mujoco.Physics.from_xml_string(xml), Still(), control_timestep=0.02, **how)


BODIES: dict[str, Callable[[], Body]] = {
    "gymnasium": lambda: EnvironmentBody([Servos() for _ in range(2)]),
    "dm_control": lambda: EnvironmentBody([arm() for _ in range(2)], feel=["posture", "rate"]),
    "time limit": lambda: EnvironmentBody([gymnasium.make("Pendulum-v1", max_episode_steps=9) for _ in range(2)]),
    "suite": lambda: EnvironmentBody([suite.load("reacher", "easy", FREE | {"random": i}) for i in range(2)]),
}


@pytest.mark.parametrize("name", BODIES)
def test_an_environment_keeps_the_protocol(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(test_conformance.BODIES, name, BODIES[name])
    test_conformance.test_a_body_is_numbers_and_ranges(name)
    test_conformance.test_the_channels_of_a_body_cover_its_sense_vector_exactly_once(name)


@pytest.mark.parametrize("name", ["gymnasium", "dm_control", "hardware"])
def test_it_babbles_and_imitates_like_any_other(name: str) -> None:
    """Better than replay, which lags behind; the second time better still."""
    make: Callable[[int], Body] = {
        "gymnasium": lambda copies: EnvironmentBody([Servos() for _ in range(copies)]),
        "dm_control": lambda copies: EnvironmentBody([arm() for _ in range(copies)], feel=["posture", "rate"]),
        "hardware": lambda copies: SerialArm(Springs()),  # there is one
    }[name]
    mind, body = learn(make(6), minutes=0.4, seed=1), make(1)
    np.testing.assert_array_equal(mind.pilot.schema.posture, [0, 1])
    np.testing.assert_array_equal(mind.pilot.schema.rate, [2, 3])
    np.testing.assert_allclose(mind.pilot.schema.slope, 1, atol=0.03)
    wanted = np.sin(2 * np.pi * np.arange(100)[:, None] / 100) * [0.6, -0.4]
    seen = Movement("sway", body.tick_s, np.concatenate([wanted, np.full((100, 2), np.nan)], 1))
    one, two = imitate(body, seen, mind, attempts=2, rng=np.random.default_rng(0))
    body.reset()
    felt = np.array([body.act(np.tile(angles, (body.copies, 1)))[0, :2] for angles in wanted])
    replay, first, second = (float(np.sqrt(np.mean((x - wanted) ** 2))) for x in (felt, one.senses[:, 0, :2], two.senses[:, 0, :2]))  # noqa: E501  # fmt: skip
    assert first < 0.3 * replay and second < 1.2 * first


def test_copies_start_from_seeds_of_their_own_and_the_same_each_time() -> None:
    for make in (
        lambda seed: EnvironmentBody([gymnasium.make("Pendulum-v1") for _ in range(3)], seed=seed),
        lambda seed: EnvironmentBody([suite.load("reacher", "easy", dict(FREE)) for _ in range(3)], seed=seed),
    ):
        body = make(0)
        felt = body.reset()
        assert len(np.unique(felt[:, 0])) == 3
        body.act(np.zeros((3, len(body.motor_low))))
        np.testing.assert_array_equal(body.reset(), felt)
        np.testing.assert_array_equal(make(0).reset(), felt)
        assert (make(1).reset() != felt).any()
        body.reseed(1)
        assert (body.reset() != felt).any()
        assert body.fingerprint == make(1).fingerprint


def test_ranges_that_nobody_says_are_found_or_given() -> None:
    body = EnvironmentBody([arm()])
    for met, end in ((-body.sense_low, [1.5, 1]), (body.sense_high, [1.5, 1])):
        assert (np.abs(met[:2] - end) < 0.6).all()
    assert (body.sense_high[2:4] > 1).all() and (body.sense_high[2:4] < 100).all()
    given = EnvironmentBody([arm()], sense_low=-5, sense_high=[1, 2, 3, 4, 5])
    np.testing.assert_array_equal(given.sense_high, [1, 2, 3, 4, 5])
    np.testing.assert_array_equal(given.sense_low, -5)
    np.testing.assert_allclose(EnvironmentBody([Servos()]).sense_low, [-1.6, -1.1, -60, -60])
    assert EnvironmentBody([arm()]).fingerprint == body.fingerprint
    assert EnvironmentBody([arm(ARM.replace('.2"/>', '.3"/>'))]).fingerprint != body.fingerprint


def test_actions_are_cut_to_their_bounds() -> None:
    one, two = EnvironmentBody([Servos()]), EnvironmentBody([Servos()])
    one.reset(), two.reset()
    np.testing.assert_array_equal(one.act(np.full((1, 2), 9.0)), two.act(two.motor_high[None]))


class Strange(Servos):
    def __init__(self, **spaces: Any) -> None:
        super().__init__()
        vars(self).update(spaces)


class Broken(Servos):
    def step(self, action: np.ndarray) -> Any:
        return (super().step(action)[0] * np.nan, 0.0, False, False, {})


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (list, "0 environments: at least one is needed"),
        (lambda: [Servos()] * 2, "2 environments: .* each copy needs its own"),
        (lambda: [Servos(), gymnasium.make("Pendulum-v1")], "Servos beside Pendulum-v1: all copies must"),
        (lambda: [gymnasium.make("CartPole-v1")], r"CartPole-v1: its action space is Discrete\(2\); a Box of one row"),
        (lambda: [Strange(observation_space=Dict(a=Box(0, 1)))], "observation space is Dict.*FlattenObservation"),
        (lambda: [Strange(observation_space=Box(0, 255, (9, 9, 3), np.uint8))], "observation space is Box.*image"),
        (lambda: [Strange(observation_space=Discrete(4))], "observation space is Discrete"),
        (lambda: [Strange(action_space=Box(0, 9, (2,), np.int64))], "action space is Box.* continuous actions"),
        (lambda: [Strange(action_space=Box(-np.inf, np.inf, (2,)))], "Strange: its actions have no finite bounds"),
        (lambda: [Strange(dt=None)], "Strange: a step of None s; say how long one takes: tick_s="),
        (lambda: [Strange(dt=-1.0)], "a step of -1.0 s"),
        (lambda: [arm(time_limit=1.0)], r"Still: its episode ended after 0.98 s; .*time_limit=float\('inf'\)"),
    ],
)  # fmt: skip
def test_what_cannot_be_a_body_says_why_in_a_line(make: Callable[[], list[Any]], told: str) -> None:
    with pytest.raises(BodyError, match=told) as caught:
        EnvironmentBody(make())
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 400


def test_what_goes_wrong_later_is_a_line_too() -> None:
    body = EnvironmentBody([Servos(ends=3), Servos(ends=4)])
    body.reset()
    body.act(np.zeros((2, 2)))
    with pytest.raises(BodyError, match=r"a motor command is not a number at 0\.02 s"):
        body.act(np.full((2, 2), np.nan))
    body.act(np.zeros((2, 2)))
    with pytest.raises(BodyError, match=r"Servos: its episode ended after 0.06 s; a body lives on: make it with"):
        body.act(np.zeros((2, 2)))
    with pytest.raises(BodyError, match=r"a sensation is not a number at 0\.02 s"):
        broken = EnvironmentBody([Broken()])
        broken.reset()
        broken.act(np.zeros((1, 2)))
    with pytest.raises(BodyError, match="unknown observation of Still 'pose'; there are at, posture, rate"):
        EnvironmentBody([arm()], feel=["pose"])
