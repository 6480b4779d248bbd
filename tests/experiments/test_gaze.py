"""Gaze following as an experiment: cloths, stages and toys, how it is judged, refusals."""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import binom, multivariate_normal

from babbling.errors import BabblingError
from experiments.errors import ExperimentError
from experiments.gaze import crowds
from experiments.gaze.covered import own_experience
from experiments.gaze.crowds import BEAD, HEAD_SHARE, Simple, jerky, with_eyes
from experiments.gaze.infer import infer
from experiments.gaze.run import Config, run
from experiments.gaze.trials import TOYS, WATCH_TILT, Trials, Watcher, straight, tilt_of, view
from experiments.shared.eyes import retina_of
from experiments.shared.judging import calibration_error, calibration_of_chance, calibrations, interval_95
from imitation.gaze.reader import EyeLore, facing
from imitation.inference.bayes import goal_posterior
from imitation.seeing.stereo import Geometry
from models.biclops.gaze import TABLE_X, TABLE_Y, lay_out, look_at, possible, separation
from models.errors import BodyError
from models.heads import camera_facts, squint, stage
from models.onlooker import onlook
from models.renderers import open_eye
from models.robots import EYE_HEIGHT
from tests.babbling.test_looking import crossed_mind
from tests.imitation.test_reader import HEAD, reader


def test_the_tilt_that_is_felt_is_the_motors_that_carries_things_up_and_down() -> None:
    senses = np.arange(3.0)  # this head's first motor tilts, and its posture stands on the first line
    assert tilt_of(crossed_mind(), senses) == 0.0


def test_whether_a_cloth_lets_one_see_is_seen() -> None:
    rng = np.random.default_rng(0)
    image = np.full((60, 80, 3), 150, np.uint8)
    for column, rgb in ((20, (255, 115, 0)), (60, (0, 230, 230))):
        image[25:35, column - 5 : column + 5] = rgb
    belief = {}
    for kind in ("opaque", "see_through"):
        lore = EyeLore()
        own_experience(lore, None, [image], 0.02, rng)
        own_experience(lore, kind, [image], 0.02, rng)
        belief[kind] = lore.sees(True)[0]
    assert belief["opaque"] < 0.15 and belief["see_through"] > 0.85


def test_calibration_error_of_known_tables() -> None:
    rng = np.random.default_rng(3)
    sure = rng.uniform(0.3, 1.0, 20_000)
    assert calibration_error(sure, rng.random(20_000) < sure)[0] < 0.02
    error, bins = calibration_error(np.full(100, 0.95), np.arange(100) < 50)
    assert error == pytest.approx(0.45)
    assert bins[:, 2].sum() == 100


@pytest.mark.parametrize("count", [60, 800])
def test_what_a_belief_that_is_right_shows_by_chance(count: int) -> None:
    rng = np.random.default_rng(5)
    sure = rng.beta(4, 2, count)
    shown = [calibration_error(sure, rng.random(count) < sure)[0] for _ in range(400)]
    assert calibration_of_chance(sure) == pytest.approx(np.mean(shown), rel=0.06)
    learners = [(sure, rng.random(count) < sure) for _ in range(9)]
    told = calibrations("a", learners)
    assert told["a_calibration_of_chance"] == pytest.approx(calibration_of_chance(sure) / 3)
    assert told["a_calibration_error"] < np.mean(told["a_calibration_error_by_play"])
    assert calibration_of_chance(np.ones(5)) == 0


@pytest.mark.parametrize(("hits", "count"), [(0, 7), (3, 20), (20, 20)])
def test_an_exact_interval_leaves_a_fortieth_on_either_side(hits: int, count: int) -> None:
    low, high = interval_95(hits, count)
    assert low == 0.0 if hits == 0 else binom.sf(hits - 1, count, low) == pytest.approx(0.025)
    assert high == 1.0 if hits == count else binom.cdf(hits, count, high) == pytest.approx(0.025)


def test_a_teacher_that_looks_at_a_toy_has_it_in_the_middle_of_its_view() -> None:
    model = stage("biclops", teacher=True, distance=0.95).compile()
    targets = np.array([[0.4, 0.2, 0.022], [0.6, -0.15, 0.022]])
    seen = onlook(model, "biclops", np.zeros((2, 2)), look_at(targets, 0.95), {})
    assert seen.teacher_gaze is not None
    start, way = seen.teacher_gaze
    off = np.linalg.norm(np.cross(targets - start, way), axis=-1)
    np.testing.assert_allclose(off, 0.0, atol=1e-6)


def test_a_head_that_squints_looks_midway_between_where_its_eyes_look() -> None:
    model = stage("biclops").compile()
    squint(model, "biclops", 3)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    left, right = (-data.camera(eye).xmat.reshape(3, 3)[:, 2] for eye in ("left_eye", "right_eye"))
    [way] = onlook(model, "biclops", np.zeros((1, 2)), None, {}).gaze[1]
    np.testing.assert_allclose([way @ (left - right), way @ np.cross(left, right)], 0.0, atol=1e-12)
    assert way @ left > 0.99


def test_toys_lie_as_far_apart_as_asked_and_in_view() -> None:
    seen = view(Config())
    rng = np.random.default_rng(0)
    four = lay_out(rng, 4, 0.95, seen, (15.0, 180.0))
    first, second = np.triu_indices(4, 1)
    assert np.rad2deg(separation(four[first], four[second], 0.95)).min() >= 15.0
    pair = lay_out(rng, 2, 0.95, seen, (5.7, 6.3))
    assert np.rad2deg(separation(pair[0], pair[1], 0.95)) == pytest.approx(6.0, abs=0.3)
    assert not possible(np.array([[0.2, 0.6, 0.022]]), 0.95, seen, (0.0, 180.0))


@pytest.mark.parametrize("seed", range(5))
def test_what_eyes_are_said_to_see_they_see_though_they_squint(seed: int) -> None:
    """By any arrangement: places at the rim of what both eyes are said to see stand on both images."""
    rng, config = np.random.default_rng(seed), Config(squint=seed)
    model, (_, half_baseline) = stage("biclops").compile(), camera_facts("biclops")
    true = [model.camera(eye).quat.copy() for eye in ("left_eye", "right_eye")]
    squint(model, "biclops", seed)
    now = [model.camera(eye).quat for eye in ("left_eye", "right_eye")]
    axes = Rotation.from_quat(true, scalar_first=True)
    turned = (Rotation.from_quat(now, scalar_first=True) * axes.inv()).as_rotvec()
    retina = retina_of(config)
    focal = open_eye(model, "left_eye", retina).focal_px
    places = rng.uniform((0.3, -0.5, -0.3), (0.9, 0.5, 0.5), (4000, 3))
    shown = places[view(config).shows(places)]
    assert len(shown) > 200
    level = (shown - (0.0, 0.0, EYE_HEIGHT)) / (2 * half_baseline)
    things = Geometry(focal, turned).appear(level, WATCH_TILT)
    assert (np.abs(things) < np.tile([retina.width / 2, retina.height / 2], 2)).all()


@pytest.mark.parametrize("spacing", [1.0, 5.0])
def test_every_bead_of_a_crowd_has_its_neighbour_as_near_as_asked(spacing: float) -> None:
    beads = lay_out(np.random.default_rng(1), 4, 0.95, view(Config()), (spacing, 1.25 * spacing), BEAD)
    apart = np.rad2deg(separation(beads[:, None], beads[None], 0.95)) + 360 * np.eye(4)
    assert (apart.min(1) >= spacing).all() and (apart.min(1) <= 1.25 * spacing).all()
    (low, high), side = TABLE_X, TABLE_Y  # or heads would have to bend further than lessons show
    assert (beads[:, 0] >= low).all() and (beads[:, 0] <= high).all() and (abs(beads[:, 1]) <= side).all()


def test_a_fitted_line_undoes_how_a_head_turns_and_then_takes_the_nearest() -> None:
    rng = np.random.default_rng(2)
    looks, target = rng.uniform(-0.6, 0.6, (60, 4, 2)), rng.integers(4, size=60)
    pose = looks[np.arange(60), target] * (HEAD_SHARE, 1.0) + (0.05, -0.1)
    simple = Simple.learned(looks, pose, target)
    assert simple.spread < 1e-9
    np.testing.assert_allclose(simple.slope, [[0.05, -0.1], [HEAD_SHARE, 0], [0, 1]], atol=1e-9)
    np.testing.assert_array_equal(simple.counts, np.bincount(target, minlength=4) + 1)
    seen = simple._replace(spread=0.1).read(looks, pose)
    np.testing.assert_allclose(seen.sum(1), 1)
    even = simple._replace(spread=0.1, counts=np.ones(4)).read(looks, pose)
    np.testing.assert_array_equal(even.argmax(1), target)
    odds = (seen / seen[:, :1]) / (even / even[:, :1])
    np.testing.assert_allclose(odds, np.tile(simple.counts / simple.counts[0], (60, 1)))


def test_the_fitted_line_is_equation_two_where_heads_turn_as_the_reader_takes_it() -> None:
    """Same spread on both axes and no lapse: nothing is left that a posterior could add."""
    rng = np.random.default_rng(3)
    looks, pose, prior = rng.uniform(-0.3, 0.3, (50, 4, 2)), rng.uniform(-0.3, 0.3, (50, 2)), rng.dirichlet(np.ones(4))
    simple = Simple(np.array([[0.0, 0], [1, 0], [0, 1]]), 0.2, prior)
    density = multivariate_normal(np.zeros(2), 0.2**2 * np.eye(2)).pdf(pose[:, None] - looks)
    by_hand = goal_posterior(np.ones(1), density, np.tile(prior, (50, 1))).probability
    np.testing.assert_allclose(simple.read(looks, pose), by_hand, rtol=1e-9)


def sharp_trials(
    body: None, who: Watcher, count: int, rng: np.random.Generator, *, apart_deg: tuple[float, float],
    turn: Callable[..., np.ndarray], preference: tuple[float, ...] | None, radius: float,
) -> Trials:  # fmt: skip
    """Four beads in a row, so far apart, and a head without noise; one bead is now and then lost."""
    side = rng.uniform(-0.2, 0.2, (count, 1)) + np.deg2rad(apart_deg[0]) * np.arange(4)
    ahead = rng.uniform(4.0, 6.0, (count, 4))
    mine = np.stack([ahead * np.cos(side), ahead * np.sin(side), np.full((count, 4), -2.0)], -1)
    target = rng.choice(4, count, p=preference)
    looks = who.gaze.imagined(facing(mine, HEAD), HEAD)
    things = who.gaze.geometry.appear(facing(mine, HEAD), 0.1)
    things[::10, 3] = np.nan
    pose = turn(looks[np.arange(count), target], 1e-6, rng)
    nothing = np.zeros(count)
    return Trials(target, things, np.ones((count, 4)), pose, nothing > 0, nothing + 0.1, looks[:, 0])


def test_many_beliefs_about_eyes_are_those_of_each_alone_and_of_nothing_seen_there_is_none() -> None:
    who, rng = Watcher(Config(), None, None, HEAD, reader()), np.random.default_rng(0)  # type: ignore[arg-type]
    turn = lambda aim, spread, rng: aim + 0.1  # noqa: E731
    seen = sharp_trials(None, who, 12, rng, apart_deg=(15.0, 180.0), turn=turn, preference=None, radius=0.02)
    sees = np.stack([np.zeros(12), np.full(12, 0.6), np.ones(12)])
    found = infer(who, seen, TOYS, sees=sees)
    for one, belief in zip(sees, found, strict=True):
        np.testing.assert_array_equal(infer(who, seen, TOYS, sees=one), belief)
    np.testing.assert_allclose(found.sum(-1), 1)
    np.testing.assert_array_equal(found[2], infer(who, seen, TOYS))
    assert (found[1].max(-1) < found[2].max(-1)).any()
    assert not infer(who, seen._replace(things=np.full_like(seen.things, np.nan)), TOYS, sees=sees).any()


def test_without_noise_all_rules_are_right_but_where_heads_turn_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crowds, "run_trials", sharp_trials)
    monkeypatch.setattr(crowds, "table_body", lambda *rest: None)
    monkeypatch.setattr(crowds, "shown", lambda who, lessons: who)
    pupils = [Watcher(Config(seed=seed), None, None, HEAD, reader()) for seed in (0, 1)]  # type: ignore[arg-type]
    found = crowds.crowds(pupils, 40, lambda done: None)
    assert found.seen == pytest.approx(0.9)
    for name, sweep in found.sweeps.items():
        fitted, nearest = sweep.right[:, 1], sweep.right[:, 2]
        if "unbeknown" in name:
            assert fitted[:, 0].max() < 0.9 and nearest[:, 0].max() < 0.9
        elif "eyes" in name:
            assert fitted.min() == 1 and nearest[:, 0].max() < 0.9
        else:
            assert fitted.min() > 0.97 and nearest.min() == 1
    numbers = found.numbers()
    np.testing.assert_allclose(numbers["gaze_crowds_scores"]["with preferences"]["constant confidence"]
                               ["calibration_error"], 0, atol=1e-12)  # fmt: skip


@pytest.mark.parametrize("turn", [straight, jerky, with_eyes])
def test_heads_turn_as_said(turn: Callable[..., np.ndarray]) -> None:
    aim = np.tile([0.5, 0.3], (20_001, 1))
    turned = turn(aim, 0.05, np.random.default_rng(4))
    wanted = np.array([0.5 * HEAD_SHARE if turn is with_eyes else 0.5, 0.3])
    np.testing.assert_allclose(np.median(turned, 0), wanted, atol=0.003)
    far = np.mean(np.abs(turned - wanted) > 4 * 0.05)
    assert far == pytest.approx(0.0572 if turn is jerky else 6e-5, abs=0.004)  # both tails beyond 4, closed form


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"objects": "0.5,0.1;0.5,0.9"}, "object 2 at 0.5,0.9 m is outside every direction"),
        ({"objects": "here"}, "give x,y;x,y in metres"),
        ({"objects": "0.5,0.1"}, "2 to 4 within 10 m"),
        ({"objects": "0.5,0.1;0.5,-0.1", "target": 3}, "there are 2 objects"),
        ({"aim_deg": 0.0}, "at most 20 degrees"),
        ({"distance": 3.0}, "between 0.7 and 1.2 m"),
        ({"width": 0}, "--width 0: it must lie between 8 and 2048 pixels"),
        ({"robot": "maze"}, "unknown robot with eyes 'maze'"),
    ],
)
def test_options_that_cannot_be_meant_are_refused_in_one_line(options: dict[str, object], text: str) -> None:
    with pytest.raises((ExperimentError, BabblingError, BodyError), match=text) as caught:
        run(Config(**options))  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
