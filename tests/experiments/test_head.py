"""Head imitation: poses from appearance against a known truth, memories as files, ends that are no crashes."""

from pathlib import Path

import numpy as np
import pytest

import experiments.shared.caregiver
from babbling.errors import BabblingError
from babbling.files import load, save
from babbling.mind import learn
from experiments.errors import ExperimentError
from experiments.head.recall import reproduce
from experiments.head.run import Config, run, within_reach
from experiments.shared.caregiver import lesson
from experiments.shared.judging import rmse_deg
from experiments.shared.options import EyeOptions
from imitation.deferred import HeadMemory
from imitation.errors import ImitationError
from imitation.seeing.pose import Appearance, frame_pose, watch
from models.biclops.facts import MAX_ACCELERATION_DEG_S2, MAX_SPEED_DEG_S
from models.biclops.movements import MOVEMENTS, movement
from models.errors import BodyError
from models.seeing_body import watching_body

FEATURES = np.array(
    [(0.10, 0.0, 0.0), (0.07, 0.03, 0.04), (0.07, -0.03, 0.04), (0.01, 0.09, 0.01), (0.01, -0.09, 0.01)]
)
GROUP = np.repeat(np.arange(5), 2)


def looks(posture: np.ndarray) -> np.ndarray:
    """(N, 2) postures to (N, 10) numbers: an exact pinhole view of five points on a head 0.7 m away."""
    pan, tilt = posture[..., 0, None], posture[..., 1, None]
    x, y, z = FEATURES.T
    ahead = x * np.cos(tilt) + z * np.sin(tilt)
    up = -x * np.sin(tilt) + z * np.cos(tilt)
    front, side = ahead * np.cos(pan) - y * np.sin(pan), ahead * np.sin(pan) + y * np.cos(pan)
    depth = 0.7 - front
    return np.stack([138.6 * side / depth, -138.6 * up / depth], -1).reshape(*posture.shape[:-1], 10)


@pytest.fixture(scope="module")
def appearance() -> Appearance:
    rng = np.random.default_rng(0)
    postures = rng.uniform((-0.6, -0.4), (0.6, 0.4), (300, 2))
    return Appearance.learned(postures, looks(postures) + 0.1 * rng.standard_normal((300, 10)), GROUP)


def test_appearance_is_learned_with_its_noise(appearance: Appearance) -> None:
    grid = np.random.default_rng(1).uniform((-0.5, -0.35), (0.5, 0.35), (50, 2))
    assert np.abs(appearance.expect(grid) - looks(grid)).max() < 0.25
    assert (np.abs(appearance.noise - 0.1) < 0.03).all()
    step = 1e-5
    slope = (looks(np.array([0.2 + step, 0.1])) - looks(np.array([0.2 - step, 0.1]))) / (2 * step)
    np.testing.assert_allclose(appearance.slope(np.array([0.2, 0.1]))[:, 0], slope, atol=2.0)


def test_filtering_beats_each_frame_alone_through_noise_hiding_and_half_hidden_features(appearance: Appearance) -> None:
    rng = np.random.default_rng(2)
    time = np.arange(200) * 0.02
    truth = np.stack([0.3 * np.sin(2 * time), 0.15 * np.cos(1.5 * time)], -1)
    numbers = looks(truth) + 0.1 * rng.standard_normal((200, 10))
    numbers[1::2] = np.nan  # an image on every second tick
    numbers[80:95] = np.nan  # hidden
    numbers[96:100, :2] += 6.0  # half hidden: the nose's centroid is off
    seen = watch(appearance, numbers, 0.02)
    assert rmse_deg(seen.pose, truth) < 0.25
    assert rmse_deg(seen.pose, truth) < 0.7 * rmse_deg(seen.raw, truth)
    assert seen.used[97] == 0 and 0 < seen.used[98] <= 8  # ticks without an image use nothing; the nose is left out
    assert (seen.deviation[86] > 2 * seen.deviation[40]).all()  # it knows that it did not see


def test_a_neck_with_unknown_wires_is_taught_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Postures are found among the senses; by joint, as people name them, the lesson is the same."""
    taught: list[tuple[np.ndarray, ...]] = []
    monkeypatch.setattr(Appearance, "learned", lambda *lesson: taught.append(lesson))
    monkeypatch.setattr(experiments.shared.caregiver, "LESSON_COPIES", 8)
    for wires in (None, 2):
        lesson(EyeOptions(width=16, height=12, noise=0, scramble=wires), 8, 0, 0.5)
    (felt, seen, _), (same, again, _) = taught
    assert len(felt) == 8 and np.ptp(felt, axis=0).min() > 0.2
    np.testing.assert_allclose(same, felt, atol=1e-9)
    np.testing.assert_allclose(again, seen, atol=1e-6)


def test_one_frame_gives_the_likeliest_pose_or_says_nothing(appearance: Appearance) -> None:
    truth = np.array([0.25, -0.12])
    pose = frame_pose(appearance, looks(truth))
    np.testing.assert_allclose(pose, truth, atol=0.01)
    few = looks(truth)
    few[3:] = np.nan
    assert np.isnan(frame_pose(appearance, few)).all()
    with pytest.raises(ImitationError, match="no frame shows enough of a face"):
        watch(appearance, np.full((5, 10), np.nan), 0.02)


def test_a_caregiver_who_is_never_seen_teaches_nothing() -> None:
    with pytest.raises(ImitationError, match="too few showed a feature"):
        Appearance.learned(np.zeros((200, 2)), np.full((200, 10), np.nan), GROUP)


@pytest.mark.parametrize("name", MOVEMENTS)
def test_teachers_keep_within_the_run_profile(name: str) -> None:
    path = np.rad2deg(movement(name, np.random.default_rng(4)))
    speed = np.abs(np.diff(path, axis=0)).max(0) / 0.02
    pull = np.abs(np.diff(path, 2, axis=0)).max(0) / 0.02**2
    assert (speed <= MAX_SPEED_DEG_S).all() and (pull <= 1.02 * np.array(MAX_ACCELERATION_DEG_S2)).all()
    np.testing.assert_allclose(path[[0, -1]], 0.0, atol=1e-9)
    assert within_reach(np.deg2rad(path), "hoap2")[:, 1].min() >= -0.24


def test_unknown_movement_names_those_there_are() -> None:
    with pytest.raises(BodyError, match=r"unknown head movement 'nodd'.*did you mean 'nod'"):
        movement("nodd", np.random.default_rng(0))


def test_memory_survives_its_file_and_belongs_to_one_body(tmp_path: Path) -> None:
    memory = HeadMemory("abc", 0.02, "nod", np.linspace(0, 0.3, 20).reshape(10, 2), np.full((10, 2), 0.01))
    save(memory, tmp_path / "memory.nc", {"axis": ("pan", "tilt")})
    again = load(tmp_path / "memory.nc", HeadMemory)
    np.testing.assert_array_equal(again.pose, memory.pose)
    assert (again.name, again.tick_s, again.body) == ("nod", 0.02, "abc")
    with pytest.raises(ImitationError, match="another body"):
        again.check("xyz")
    with pytest.raises(ImitationError, match=r"pose holds 9\.3; -3\.14\d* to 3\.14\d* is possible"):
        save(HeadMemory("abc", 0.02, "spin", 9.0 + memory.pose, memory.deviation), tmp_path / "spin.nc")
    with pytest.raises(ImitationError, match="of 2 postures; 3 to"):
        HeadMemory("abc", 0.02, "short", memory.pose[:2], memory.deviation[:2])


def test_what_is_remembered_is_done_with_unknown_wires() -> None:
    mind = learn(watching_body("biclops", copies=8, scramble=2), minutes=0.5, seed=0)
    time = np.arange(100)[:, None] * 0.02
    memory = HeadMemory(mind.fingerprint, 0.02, "sway", 0.3 * np.sin(time * (1.0, 2.0)), np.full((100, 2), 0.01))
    done = reproduce(memory, mind, "biclops", "mean", 0, 2)
    assert rmse_deg(done, memory.pose) < 0.2
    with pytest.raises(ImitationError, match="another body"):
        reproduce(memory, mind, "biclops", "mean", 0)


def test_nobody_there_is_searched_for_and_then_said() -> None:
    result = run(Config(absent=True, search_s=3.0, width=80, height=60))
    assert result.metrics["face_found"] is False
    assert result.metrics["head_reproduced_rmse_deg"] is None
    assert result.metrics["search_s_simulated"] <= 3.0
    assert "No face was seen in 2 looks" in result.summary


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"sequences": 0}, "between 1 and 64"),
        ({"width": 0}, "--width 0: it must lie between 8 and 2048 pixels"),
        ({"height": 100_000}, "--height 100000: it must lie between 8"),
        ({"robot": "biclop"}, "did you mean 'biclops'"),
        ({"movement": "shrug"}, "unknown head movement 'shrug'"),
        ({"selection": "best"}, "unknown selection 'best'"),
        ({"distance": 5.0}, "between 0.4 and 1.2 m"),
        ({"memory": Path("nowhere.nc")}, "no such file"),
    ],
)
def test_options_that_cannot_be_meant_are_refused_in_one_line(options: dict[str, object], text: str) -> None:
    with pytest.raises((ExperimentError, BabblingError, BodyError), match=text) as caught:
        run(Config(**options))  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
