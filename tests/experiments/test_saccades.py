"""A seeing body and the trials around it; what babbling teaches is tested on pure geometry in test_looking.py."""

import numpy as np
import pytest

from babbling.errors import BabblingError
from babbling.looking import LookingMind, pilot_looking
from experiments.errors import ExperimentError
from experiments.saccades.run import Config, run
from experiments.saccades.trials import within_reach
from experiments.shared.eyes import APART, TOYS, learn_to_look, nursery, retina_of, toy_places
from experiments.shared.options import EyeOptions
from imitation.seeing.finding import Finder
from models.biclops import SCENE
from models.errors import BodyError
from models.heads import stage
from models.renderers import open_eye
from models.robots import EYE_HEIGHT, ROBOTS, head_of
from models.seeing_body import SeeingBody, head_fingerprint
from tests.babbling.test_looking import REACH, GeometricHead, crossed_mind


@pytest.fixture(scope="module")
def body() -> SeeingBody:
    return nursery(EyeOptions(width=80, height=60), 0, copies=2)


@pytest.mark.parametrize("robot", [name for name, one in ROBOTS.items() if one.head])
def test_eyes_stand_at_one_height_above_the_table(robot: str) -> None:
    model = stage(robot).compile()
    retina = retina_of(EyeOptions(width=16, height=12))
    body = SeeingBody(model, robot, Finder(TOYS), retina=retina, rest=(0.0, 0.0))
    body.reset()
    height = body._view(0).camera("left_eye").xpos[2] - head_of(robot).table[2]
    assert height == pytest.approx(EYE_HEIGHT, abs=0.003)


def test_the_same_seed_sees_the_same_and_what_is_unseen_is_nan(body: SeeingBody) -> None:
    first = body.reset()
    np.testing.assert_array_equal(first, body.reset())
    assert np.isnan(first).any() and np.isfinite(first[:, 2:]).any()
    assert np.isfinite(first[:, :2]).all()
    seen = first[np.isfinite(first)]
    assert seen.max() <= 80


def test_a_saccade_arrives_and_moves_the_image_the_other_way(body: SeeingBody) -> None:
    before = body.reset()
    after = body.act(body.command_angles(np.tile([0.1, 0.05], (2, 1))))
    np.testing.assert_allclose(after[:, :2], [[0.1, 0.05]] * 2, atol=0.006)
    moved = (after - before)[:, 2:].reshape(2, len(TOYS), 4)
    moved = moved[np.isfinite(moved).all(-1)]
    assert len(moved) and (moved[:, 0] > 0).all() and (moved[:, 1] < 0).all()  # left turn: things go right


def test_unknown_wires_move_the_same_neck_and_show_the_same(body: SeeingBody) -> None:
    crossed = nursery(EyeOptions(width=80, height=60, scramble=2), 0, copies=2)
    assert crossed.fingerprint != body.fingerprint
    assert crossed.wiring.motor.tolist() == crossed.wiring.sense.tolist() == [1, 0]
    shown = []
    for one in (body, crossed):
        one.reset()
        felt = one.act(one.command_angles(np.array([[0.2, 0.1], [-0.3, 0.05]])))
        shown.append((one.senses.read(felt, "angle"), one.senses.read(felt, "place"), felt[:, :2]))
    (angles, places, straight), (same, again, lines) = shown
    np.testing.assert_allclose(same, angles, atol=1e-9)
    np.testing.assert_allclose(again, places, atol=0.05)
    np.testing.assert_allclose(lines, straight[:, ::-1], atol=1e-9)


def test_what_is_within_reach_does_not_depend_on_wires() -> None:
    straight = GeometricHead()
    found = pilot_looking(straight, REACH, 0)
    plain = LookingMind(found, found.forward_model(), 1.0)
    rng = np.random.default_rng(0)
    things, postures = rng.uniform(-60, 60, (200, 4)), rng.uniform(REACH.low, REACH.high, (10, 2))
    one = np.array([within_reach(plain, things, posture) for posture in postures])
    other = np.array([within_reach(crossed_mind(), things, posture[::-1]) for posture in postures])
    assert 0.2 < one.mean() < 0.8 and (one == other).mean() > 0.99


def test_motor_commands_must_be_numbers_of_the_right_shape(body: SeeingBody) -> None:
    with pytest.raises(BodyError, match="finite numbers are needed"):
        body.act(np.full((2, 2), np.nan))
    with pytest.raises(BodyError, match="shape"):
        body.act(np.zeros((1, 2)))


def test_toys_hang_apart() -> None:
    ways = toy_places(2, 0) - (0, 0, EYE_HEIGHT)
    ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    cosine = np.einsum("ibk,jbk->bij", ways, ways)[:, ~np.eye(len(TOYS), dtype=bool)]
    assert cosine.max() < np.cos(APART)


def test_every_robot_has_a_fingerprint_of_its_own() -> None:
    assert head_fingerprint("biclops") != head_fingerprint("hoap2")


def test_a_scene_without_cameras_is_refused() -> None:
    import mujoco

    blind = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    with pytest.raises(BodyError, match="this scene has no cameras at all"):
        open_eye(blind, "left_eye")
    open_eye(mujoco.MjModel.from_xml_path(str(SCENE)), "left_eye")


def test_no_time_to_babble_is_refused(body: SeeingBody) -> None:
    with pytest.raises(BabblingError, match="0 minutes of babbling"):
        learn_to_look(body, 0.0, 0)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"width": 0}, "--width 0: it must lie between 8 and 2048 pixels"),
        ({"robot": "hoap"}, "did you mean 'hoap2'"),
        ({"seed": -1}, "it must lie between 0 and 4000000000"),
        ({"renderer": "crayon"}, "unknown renderer 'crayon'"),
        ({"noise": 2.0}, "--noise 2: it must lie between 0 and 1 of full scale"),
        ({"fovy_deg": 200.0}, "--fovy-deg 200"),
        ({"blur": float("nan")}, "--blur nan"),
    ],
)
def test_options_that_cannot_be_meant_are_refused_in_one_line(options: dict[str, object], text: str) -> None:
    with pytest.raises((ExperimentError, BabblingError, BodyError), match=text) as caught:
        run(Config(**options))  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
